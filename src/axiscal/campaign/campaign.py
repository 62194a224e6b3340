"""The campaign: the one stateful thing. It asks, records, takes back, stops, and forgets nothing.

Its state is folded from the record at every step; the belief follows the readings.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any, Self

from axiscal.campaign.agreement_words import named
from axiscal.campaign.basis import plan_basis
from axiscal.campaign.ending import (
    BUDGET,
    FUTILE,
    Ended,
    Milestone,
    because_text,
    out_of_reach,
    refuse_endless,
    refuse_implausible,
    result_of,
    standing,
)
from axiscal.campaign.possible import beginning_of, described, jump_told, kept_text, note_told, refuse_unreadable
from axiscal.campaign.sources import Request, Skip, Source, answered
from axiscal.description.campaign import CampaignDescription
from axiscal.estimation.case import Case, Knowledge, Timed, elapsed, timed
from axiscal.estimation.detail import in_detail
from axiscal.estimation.estimate import estimated
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.judged import Doubt
from axiscal.exceptions import AmbiguityError, ReadingError, RecordError
from axiscal.measurement.reading import Place, Reading, seconds_since
from axiscal.numerics.remembered import Memo
from axiscal.record.accepted import Accepted, Bumped
from axiscal.record.events import (
    Asked,
    Continued,
    Event,
    Finished,
    Gap,
    Mounted,
    Noted,
    Planned,
    Recorded,
    Skipped,
    State,
    Stored,
    Undone,
    Warmed,
)
from axiscal.record.store import Record
from axiscal_core.refusals import one

Planner = Callable[
    [Case, Knowledge, Sequence[Reading], Sequence[Doubt], Sequence[Gap], Sequence[Place]], tuple[Place, ...]
]
"""From what is known to the readings to come, as `next_places`."""


def _next_places(*known: Any) -> tuple[Place, ...]:
    from axiscal.planning.next_readings import next_places  # commands that do not plan need not load it

    return next_places(*known)


_ANSWERS = 6
"""Kept of the same readings: case, times, estimates while others follow and at the end, and their end."""

_DESCRIBING = Accepted, Bumped, Mounted, Warmed  # events that make another description


class Campaign(AbstractContextManager["Campaign"]):
    """An open campaign record with its description and what is known; a context manager.

    log : its record; planner : says where to read next
    """

    def __init__(self, record: Record, description: CampaignDescription, planner: Planner = _next_places) -> None:
        self.log, self.description, self._planner = record, description, planner
        self.state = record.state()
        self._memo = Memo(_ANSWERS)

    @classmethod
    def create(cls, path: str | Path, description: CampaignDescription, planner: Planner = _next_places) -> Self:
        """Return a new campaign, recorded at `path`; raises RecordError if something is there already."""
        one("Campaign.create", "path", path, (str, Path), '"mill.axiscal"')
        return cls(Record.create(path, beginning_of(description)), description, planner)

    @classmethod
    def open(
        cls, path: str | Path, planner: Planner = _next_places, *, write: bool = True, changed: bool = False
    ) -> Self:
        """Return the campaign recorded at `path`, `changed` since it was signed or not; raises RecordError."""
        one("Campaign.open", "path", path, (str, Path), '"mill.axiscal"')
        record = Record.open(path, write=write, changed=changed)
        return cls(record, described(record), planner)

    @property
    def path(self) -> Path:
        """The file of the record."""
        return self.log.path

    @property
    def begun(self) -> str:
        """When the record was begun: ISO 8601, UTC."""
        return self.log.lines[0].row.at

    def case(self) -> Case:
        """Return what the description makes of the mathematics."""
        described = self.description
        return self._memo.answer("case", case_of if described.prior_text else Case, described)

    def estimate(self, ended: bool = False) -> Estimation:
        """Return what the readings make known, found once for the same readings.  ended : no others are to follow

        Raises AmbiguityError at the end where a station may as well stand elsewhere.
        """
        readings = self.state.readings
        if ended:
            return self._memo.answer(("ended", readings), in_detail, self.case(), readings, self.estimate())
        return self._memo.answer(readings, estimated, self.case(), readings)

    def next(self, *, beyond: bool = False) -> Asked | Ended:
        """Return the reading to take; the same one until it is answered.

        beyond : ask although a target is reached
        """
        self._refuse_finished()
        if self.state.pending is not None:
            return self.state.pending
        because = None if beyond else self.reached()
        if because is not None:
            return Ended(because)
        if not self.prepared():
            return Ended("nothing is left to measure")
        asked = Asked(self.state.free, self.state.plan[0])
        if not beyond and self._over_budget([asked.place]):
            return Ended(BUDGET)
        self._append(asked)
        return asked

    def prepared(self) -> tuple[Place, ...]:
        """Return the readings to come. Their plan is kept; it is renewed where it no longer stands on what is known.

        A reading taken where it was planned, and believed, leaves the plan as it is: how sharp a belief becomes does
        not depend on values.
        """
        stands = bool(self.state.plan) and not self.state.renew and self._plan_basis() == self.state.plan_basis
        if not stands:
            known, left = self.estimate(), self.state.plan
            gone = [self.description.setup(each.name) for each in self.state.mounted]
            parked = [Place(setup.name, setup.park, (0,) * len(setup.park)) for setup in gone]
            closed = (*self.state.skipped, *(Gap(Asked(0, place), "it has gone", True) for place in parked))
            places = self._planner(known.case, known.knowledge, known.readings, known.outliers, closed, left)
            if places or left:
                self._append(Planned(places, self._plan_basis()))
        return self.state.plan

    def _plan_basis(self) -> str:
        if self.state.continued is not None or not self.state.readings:
            return self.state.continued or ""  # without readings no size was learnt, nothing rejected
        known = self.estimate()
        return plan_basis(known.case, known.readings, known.outliers)

    def go_on(self) -> None:
        """Keep in the record that no limit is reached, where that is so: the next command then estimates nothing."""
        if self.state.continued is None and self.reached() is None:
            self._append(Continued(self._plan_basis()))

    def open_question(self) -> Asked:
        """Return what has been asked and not been answered; raises RecordError if that is nothing."""
        self._refuse_finished()
        if self.state.pending is None:
            remedy = "Ask for one with `axiscal step next`, or say where a reading was taken with --setup and --at"
            raise RecordError("No reading has been asked for", remedy, self.path)
        return self.state.pending

    def record(
        self,
        value: float,
        std: float | None = None,
        at: Place | None = None,
        *,
        accepted: bool = False,
        others: tuple[float, ...] = (),
        live: bool = True,
    ) -> Reading:
        """Keep a reading, of what was asked or of another place, and return it.

        value, std : m or rad; at : the place
        accepted : it is believed however much it surprises
        others : the values along y and z where an instrument reads three directions
        live : it was taken just now: the clock is kept with it
        Raises RecordError if nothing was asked, ReadingError for a number that is none.
        """
        self._refuse_finished()
        place = at or self.open_question().place
        if gone := next((each for each in self.state.mounted if each.name == place.setup), None):
            what = '"{setup}" has gone: its zero jumped'
            raise ReadingError(what, 'Read "{instead}"', setup=gone.name, instead=gone.setup)
        refuse_unreadable(self.description.setup(place.setup), (value, *others), std)
        time = seconds_since(self.begun, self.state.readings) if live else None
        where = place.setup, place.pose, place.approach
        self._append(Recorded(Reading(*where, value, std, None, accepted, others, time, check=place.check)))
        return self.state.readings[-1]

    def skip(self, reason: str, *, rest: bool = False) -> Asked:
        """Keep in mind that the reading asked for cannot be taken, and return it; it is not asked for again.

        rest : neither can any other of its set-up, which is left
        """
        asked = self.open_question()
        self._append(Skipped(kept_text(reason, "reason", "Say why the reading cannot be taken"), rest))
        return asked

    def note(self, text: str) -> None:
        """Keep a sentence in the record, also after the end; or the temperature of a scale, which counts."""
        told = note_told(self.description, self.state, text)
        if isinstance(told, Warmed):
            self._refuse_finished()
        self._append(told)

    def bump(self, controller: str, moved: float) -> None:
        """Keep by how much the bump in the tables of a control moved the tool today, m, also after the end."""
        self._append(Bumped(controller, moved, datetime.now(UTC).date().isoformat()))

    def undo(self) -> Stored:
        """Take back the last reading, skip, accepted mistake, temperature or finish; its question is open again."""
        if not self.state.undo:
            raise RecordError("There is nothing to take back", "Go on with `axiscal step next`", self.path)
        step = self.state.undo[-1]
        self._append(Undone(step.number))
        return step

    def accept(self, cause: str, setup: str | None = None, before: int | None = None) -> Accepted:
        """Accept a mistake that the readings name now, and return it; what follows sees readings without it.

        cause : as of `Accepted`; setup : whose readings, where several are named
        before : number of a reading before which a person knows of a jump. Raises RecordError where none can be.
        """
        self._refuse_finished()
        told = None if before is None else jump_told(self.state, setup, before, self.path)
        event = told or named(self.estimate(), cause, setup, self.path)
        self._append(event)
        return event

    def finish(self, because: str | None = None) -> str:
        """End the campaign and return why: the target that is reached, by what a report says, unless said otherwise."""
        if self.state.finished is None:
            why = because or self.reached(ended=True) or "ended by the operator"
            self._append(Finished(why, result_of(self._said(ended=True))))
        return self.state.finished or ""

    def reached(self, ended: bool = False) -> str | None:
        """Return the target that is reached, in words; None if there is none.  ended : no other readings follow"""
        target, readings = self.description.target, self.state.readings
        said = target.taken(len(readings))
        if said is None and target.accurate and readings and (ended or self.state.continued is None):
            said = self._memo.answer(("standing", ended, readings), standing, target, self._said(ended))
        return said or (BUDGET if self._over_budget() else None)

    def looked_at_again(self) -> State:
        """Return the state as the file has it now."""
        self._take_in(self.log.state())
        return self.state

    def so_far(self) -> Estimation:
        """Return what the readings make known; of a campaign that has ended, what its report says."""
        return self._said(self.state.finished is not None)

    def _said(self, ended: bool) -> Estimation:
        """Return what a report says, or what stood before the end where that says nothing: a station is ambiguous."""
        try:
            return self.estimate(ended)
        except AmbiguityError:
            return self.estimate()

    def seconds(self, places: Sequence[Place] = ()) -> float:
        """Return the machine time that the readings took, and places would take after them, s."""
        return elapsed(self.case(), self._times(), places)

    def adopt(self, readings: tuple[Reading, ...], note: str = "") -> None:
        """Keep readings that were taken without being asked for, in one transaction, set-up by set-up.

        Nobody has said how often a set-up was mounted for them: it counts once, whatever the order of a file's rows.
        note : where they are from, "" for nothing to note; they then get numbers of this campaign
        """
        self._refuse_finished()
        setups = dict.fromkeys(reading.setup for reading in readings)
        drawn = [place for place in self.state.coming if place.check]
        taken = [replace(r, check=r.check or r.place in drawn) for each in setups for r in readings if r.setup == each]
        if note:
            taken = [replace(reading, number=self.state.free + n) for n, reading in enumerate(taken)]
        self._append(*map(Recorded, taken), *([Noted(note)] if note else []))

    def run(self, source: Source, watch: Callable[[Milestone], None]) -> str:
        """Ask and record until a target is reached, and return why it stopped.

        watch : called with the beginning and with every reading that is kept
        Raises SourceError, or KeyboardInterrupt at any time; what was kept is kept.
        """
        path, in_a_row = [self._milestone()], 0
        watch(path[0])
        while True:
            before = partial(estimated, self.case(), self.state.readings[:-FUTILE])
            hopeless = out_of_reach(self.description.target, [each.accuracy for each in path], before, self.estimate())
            asked = Ended(hopeless) if hopeless and not self.reached() else self.next()
            if isinstance(asked, Ended):
                return self.finish(asked.because)
            answer = answered(source, self.request(asked))
            if isinstance(answer, Skip):
                self.skip(answer.reason)
                in_a_row += 1
                refuse_endless(in_a_row, answer)
            else:
                self.record(answer.value, answer.std, others=answer.others, live=answer.live)
                in_a_row = 0
                path.append(self._milestone())
                watch(path[-1])
                refuse_implausible(self.estimate())

    def request(self, asked: Asked) -> Request:
        """Return the question as a source is asked it."""
        place, setup = asked.place, self.description.setup(asked.place.setup)
        seconds = self.seconds([place]) if setup.drift > 0 else 0.0
        return Request(asked.reading, setup, self.description.machine.axes, place.pose, place.approach, seconds)

    def _refuse_finished(self) -> None:
        if self.state.finished is not None:
            remedy = "Take the end back with `axiscal step undo`, or start a new campaign"
            what = "The campaign is finished: {finished}"
            raise RecordError(what, remedy, self.path, finished=because_text(self.state.finished))

    def close(self) -> None:
        """Close the record."""
        self.log.close()

    def __exit__(self, *_: object) -> None:
        self.close()

    def _append(self, *events: Event) -> None:
        self.log.append(*events, after=self.state.last)
        self._take_in(self.log.state())

    def _take_in(self, state: State) -> None:
        """Go on from a state; with set-ups mounted anew or warm, and bumps, from another description, too."""
        before, self.state = self.state, state
        if state.told(*_DESCRIBING) != before.told(*_DESCRIBING):
            self.description = described(self.log)
            self._memo = Memo(_ANSWERS)

    def _times(self) -> Timed:
        readings = self.state.readings
        return self._memo.answer(("timed", readings), timed, self.case(), readings)

    def _over_budget(self, places: Sequence[Place] = ()) -> bool:
        budget = self.description.target.budget
        return budget is not None and self.seconds(places) > budget

    def _milestone(self) -> Milestone:
        readings = self.state.readings
        accuracy, last = self.estimate().accuracy, readings[-1] if readings else None
        return Milestone(len(readings), last, accuracy, self._times().seconds)
