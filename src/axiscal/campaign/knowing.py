"""What the readings of a campaign make known, found from the record alone, once for the same readings.

knowing = Knowing(description)
known = knowing.known(readings)
rivals = knowing.contest(readings, skipped)
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from functools import cached_property
from typing import TypeVar, cast

from axiscal.campaign.ending import Attained, standing
from axiscal.campaign.milestones import Milestone
from axiscal.description.campaign import CampaignDescription
from axiscal.estimation.case import Case
from axiscal.estimation.deciding import FEWEST, Contest, contest
from axiscal.estimation.estimate import concluded, estimated
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.ruled import ruled
from axiscal.estimation.timed import Timed, timed
from axiscal.estimation.watching import watched_so_far
from axiscal.exceptions import AmbiguityError
from axiscal.inference.contradiction import Watched
from axiscal.language.spoken import put, said, spoken_now
from axiscal.measurement.reading import Reading
from axiscal.planning.plan_basis import plan_basis
from axiscal.planning.vouched import vouched_words
from axiscal.record.events import Gap

Readings = tuple[Reading, ...]
Found = TypeVar("Found")


class Knowing:
    """What readings make known of the machine that a campaign describes."""

    def __init__(self, description: CampaignDescription) -> None:
        self._description = description
        self._known: Estimation | None = None
        self._readings: Readings = ()
        self._found: dict[Hashable, object] = {}

    @cached_property
    def case(self) -> Case:
        """What the description makes of the mathematics."""
        return case_of(self._description)

    def known(self, readings: Readings) -> Estimation:
        """Return what the readings make known while others are to follow."""
        self._known = estimated(self.case, readings, self._known)
        return self._known

    def concluded(self, readings: Readings) -> Estimation:
        """Return what the readings make known if they are all."""
        return self._once("concluded", readings, lambda: concluded(self.case, readings))

    def ruled(self, readings: Readings) -> Estimation:
        """Return the same with the verdict: what a report says."""
        return self._once("ruled", readings, lambda: ruled(self.concluded(readings)))

    def contest(self, readings: Readings, skipped: tuple[Gap, ...]) -> Contest | None:
        """Return which causes compete for what contradicts the model, and which reading decides; None where none do."""
        if len(readings) < FEWEST:
            return None
        return self._once(("contest", skipped), readings, lambda: contest_of(self.known(readings), skipped))

    def plan_basis(self, readings: Readings, skipped: tuple[Gap, ...]) -> str:
        """Return what a plan made now rests on, in words: what is known, and causes between which a reading decides."""
        return basis_words(self.known(readings), self.contest(readings, skipped))

    def standing(self, readings: Readings, ended: bool = False) -> Attained:
        """Return whether an accuracy is reached, by the verdict on the readings.  ended : no others are to follow"""
        target = self._description.target
        return self._once(("standing", ended), readings, lambda: standing(target, self.so_far(readings, ended)))

    def unvouched(self, readings: Readings) -> str:
        """Return in the words of a report what readings that promise an accuracy could not show, "" of others."""
        found = self.standing(readings).found
        if found is None:
            return ""
        return self._once(("unvouched", spoken_now()), readings, lambda: str(vouched_words(self.case, found)))

    def verdict(self, readings: Readings) -> tuple[str, str]:
        """Return the verdict of a report on all readings as its word in `result.json`, and as a sentence.

        The sentence, in the language that is spoken, has what readings could not show where it is that.
        """
        known = self.so_far(readings, ended=True)
        if known.ruling is None:
            return "", ""
        word = known.ruling.verdict
        if word != "unchecked":
            return word, said(word)
        why = vouched_words(known.case, known.ruling.defence)
        return word, put("{verdict}. {why}", verdict=said(word), why=why)

    def watched(self, readings: Readings, ended: bool = False) -> Watched:
        """Return the e-value after the readings, and what explains them best.  ended : no others are to follow"""
        return self._once(("watched", ended), readings, lambda: watched_so_far(self.so_far(readings, ended)))

    def so_far(self, readings: Readings, ended: bool) -> Estimation:
        """Return what the readings make known.  ended : no others are to follow, and it is what a report says

        Where a station may as well stand elsewhere, a report says nothing, and what stood before the end is returned.
        """
        if not ended:
            return self.known(readings)
        try:
            return self._once("in the end", readings, lambda: self.ruled(readings))
        except AmbiguityError:
            return self._once("in the end", readings, lambda: self.known(readings))

    def _once(self, what: Hashable, readings: Readings, find: Callable[[], Found]) -> Found:
        """Return what follows from exactly these readings, found when it is first asked for."""
        if self._readings != readings:
            self._readings, self._found = readings, {}
        if what not in self._found:
            self._found[what] = find()
        return cast(Found, self._found[what])

    def timed(self, readings: Readings) -> Timed:
        """Return the readings with their times."""
        return timed(self.case, readings, Timed() if self._known is None else self._known.stages.timed)

    def milestone(self, readings: Readings) -> Milestone:
        """Return where a campaign stands after its last reading."""
        last = readings[-1] if readings else None
        return Milestone(len(readings), last, self.known(readings).accuracy, self.timed(readings).seconds)

    def history(self, readings: Readings) -> tuple[Milestone, ...]:
        """Return how well the machine was known after each reading, from the first one on."""
        known = estimated(self.case, ())
        milestones = [Milestone(0, None, known.accuracy, 0.0)]
        for taken, reading in enumerate(readings, start=1):
            known = estimated(self.case, readings[:taken], known)
            milestones.append(Milestone(taken, reading, known.accuracy, known.seconds))
        return tuple(milestones)


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
