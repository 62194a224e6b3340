"""What the readings of a campaign make known, each answer found once for the same readings.

knowing = Knowing(description, Kept(path, first_event))
known = knowing.known(readings)
rivals = knowing.contest(readings, skipped)
knowing.close()
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from pathlib import Path

from axiscal.accuracy.yardstick import Accuracy
from axiscal.campaign.ending import standing
from axiscal.campaign.kept import DAMAGE, Kept
from axiscal.campaign.milestones import Milestone
from axiscal.description.campaign import CampaignDescription
from axiscal.estimation.case import Case
from axiscal.estimation.deciding import FEWEST, Contest, contest
from axiscal.estimation.estimate import concluded, estimated
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.ruled import ruled
from axiscal.estimation.timed import Timed, timed
from axiscal.exceptions import AmbiguityError, AxiscalError
from axiscal.inference.contradiction import Watched
from axiscal.language.spoken import said
from axiscal.measurement.reading import Reading
from axiscal.planning.plan_basis import plan_basis
from axiscal.record.events import Gap

Readings = tuple[Reading, ...]


class Knowing:
    """What readings make known of the machine that a campaign describes.  kept : what earlier commands left"""

    def __init__(self, description: CampaignDescription, kept: Kept) -> None:
        self._description, self._kept = description, kept
        self._case: Case | None = None
        self._known: Estimation | None = None
        self._concluded: Estimation | None = None
        self._ruled: Estimation | None = None
        self._contest: tuple[object, Contest | None] = (None, None)

    @cached_property
    def _stated(self) -> Case:
        """What the description makes of the mathematics."""
        return case_of(self._description)

    def case(self, readings: Readings) -> Case:
        """Return what the description makes of the mathematics.  readings : what was kept must belong to them"""
        if self._case is None:
            self._known = self._kept.recalled(readings)
            self._case = self._stated if self._known is None else self._known.stated
        return self._case

    def known(self, readings: Readings) -> Estimation:
        """Return what the readings make known while others are to follow."""
        case, before = self.case(readings), self._known  # first the case: it recalls what is known
        try:
            self._known = estimated(case, readings, before)
        except (*DAMAGE, AxiscalError):
            if before is None or case is self._stated:
                raise
            self._case, self._known = self._stated, None  # it was kept, and nothing follows from it
            self._kept.forget()
            self._known = estimated(self._stated, readings)
        self._kept.keep(self._known)
        return self._known

    def concluded(self, readings: Readings) -> Estimation:
        """Return what the readings make known if they are all: found from them alone, and nothing that was kept."""
        if self._concluded is None or self._concluded.stages.timed.given != readings:
            self._concluded = concluded(self._stated, readings)
        return self._concluded

    def ruled(self, readings: Readings) -> Estimation:
        """Return the same with the verdict: what a report says."""
        concluded = self.concluded(readings)
        if self._ruled is None or self._ruled.stages is not concluded.stages:
            self._ruled = ruled(concluded)
        return self._ruled

    def _in_the_end(self, readings: Readings) -> Estimation:
        """Return what a report says; where a station may as well stand elsewhere, what stood before the end."""
        try:
            return self.ruled(readings)
        except AmbiguityError:
            return self.known(readings)

    def contest(self, readings: Readings, skipped: Sequence[Gap]) -> Contest | None:
        """Return which causes compete for what contradicts the model, and which reading decides; None where none do."""
        now = readings, skipped
        if self._contest[0] != now:
            enough = len(readings) >= FEWEST
            self._contest = now, contest_of(self.known(readings), skipped) if enough else None
        return self._contest[1]

    def plan_basis(self, readings: Readings, skipped: Sequence[Gap]) -> str:
        """Return what a plan made now rests on, in words: what is known, and causes between which a reading decides."""
        return basis_words(self.known(readings), self.contest(readings, skipped))

    def standing(self, readings: Readings, ended: bool = False) -> str | None:
        """Return why an accuracy asks for no more readings, by the verdict.  ended : no others are to follow"""
        find = self._in_the_end if ended else self.known
        return self._kept.standing(readings, lambda: standing(self._description.target, find(readings)), ended)

    def verdict(self, readings: Readings) -> tuple[str, str]:
        """Return the verdict of a report on all readings as its word in `result.json`, and in the language spoken."""

        def word() -> str:
            ruling = self._in_the_end(readings).ruling
            return "" if ruling is None else ruling.verdict

        def words() -> str:
            return said(found) if (found := word()) else ""

        kept = self._kept.sentence
        return kept("verdict as a word", readings, word), kept("verdict in words", readings, words)

    def watched(self, readings: Readings, ended: bool = False) -> Watched:
        """Return the e-value after the readings, and what explains them best.  ended : no others are to follow"""
        find = self._in_the_end if ended else self.known
        return self._kept.watched(readings, lambda: find(readings), ended)

    def accuracy(self, readings: Readings, ended: bool = False) -> Accuracy:
        """Return how well the machine is known after the readings.  ended : no others are to follow"""
        find = self._in_the_end if ended else self.known
        return self._kept.accuracy(readings, lambda: find(readings), ended)

    def seconds(self, readings: Readings) -> float:
        """Return the machine time that the readings took, s."""
        return self._kept.seconds(readings, lambda: self.timed(readings).seconds)

    def leave(self, readings: Readings, copy: Path) -> None:
        """Leave beside a copy of a record that has ended what the first look at it asks for."""
        self.accuracy(readings, True)
        self.watched(readings, True)
        self.verdict(readings)
        self.seconds(readings)
        self._kept.leave(copy)

    def timed(self, readings: Readings) -> Timed:
        """Return the readings with their times."""
        case = self.case(readings)  # first: it recalls what is known
        before = Timed() if self._known is None else self._known.stages.timed
        return timed(case, readings, before)

    def milestone(self, readings: Readings) -> Milestone:
        """Return where a campaign stands after its last reading."""
        last = readings[-1] if readings else None
        return Milestone(len(readings), last, self.known(readings).accuracy, self.timed(readings).seconds)

    def history(self, readings: Readings) -> tuple[Milestone, ...]:
        """Return how well the machine was known after each reading, from the first one on."""
        case = self.case(readings)
        known = estimated(case, ())
        milestones = [Milestone(0, None, known.accuracy, 0.0)]
        for taken, reading in enumerate(readings, start=1):
            known = estimated(case, readings[:taken], known)
            milestones.append(Milestone(taken, reading, known.accuracy, known.seconds))
        return tuple(milestones)

    def close(self) -> None:
        """Leave for the next command what was found."""
        self._kept.close()


def contest_of(known: Estimation, skipped: Sequence[Gap] = ()) -> Contest | None:
    """Return which causes compete by what readings make known; None where none do, or too few were taken."""
    return contest(known, skipped) if len(known.readings) >= FEWEST else None


def basis_words(known: Estimation, found: Contest | None) -> str:
    """Return what a plan made now rests on, in words.  found : the causes between which a reading decides"""
    basis = plan_basis(known.case, known.readings, known.outliers, known.learnt_from)
    if found is None:
        return basis
    rivals = (f"{each.family} of {each.owner}" for each in (found.first, found.second))
    return f"{basis}{', ' if basis else ''}to decide between {' and '.join(rivals)} after {len(known.readings)}"
