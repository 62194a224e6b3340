"""The events that a campaign can have, and the state that follows from all of them.

Events are facts and never change; the state is always folded from them anew. Units are metres, radians and seconds.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass

from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading
from axiscal.record.accepted import Accepted, put_right


@dataclass(frozen=True, slots=True)
class Created:
    """The campaign begins; it carries its own inputs, so that the record needs no other file.

    machine_text, campaign_text : the two descriptions, word for word
    machine_source, campaign_source : where they were read
    versions : of axiscal and of what it computes with
    prior_text : the campaign whose result is its prior, as `heritage` writes it; empty for none
    usual_doubts : what nothing is stated of is doubted as is usual; records of before could not say it
    fine_knots : knots of which nothing is said are as close as is cheap; records of before could not say it
    """

    machine_text: str
    campaign_text: str
    machine_source: str
    campaign_source: str
    versions: Mapping[str, str]
    prior_text: str = ""
    usual_doubts: bool = False
    fine_knots: bool = False


@dataclass(frozen=True, slots=True)
class Planned:
    """The readings to come, in their order; they replace what was planned before.

    basis : what the plan rests on besides the places of the readings before it, in words
    """

    places: tuple[Place, ...]
    basis: str = ""


@dataclass(frozen=True, slots=True)
class Asked:
    """A reading is wanted: its number from 1, and its place."""

    reading: int
    place: Place


@dataclass(frozen=True, slots=True)
class Recorded:
    """A reading was taken; folding gives it its own number, else that under which one was asked for, else the next."""

    reading: Reading


@dataclass(frozen=True, slots=True)
class Skipped:
    """The reading asked for cannot be taken; rest : nor any other that its set-up still has to give."""

    reason: str
    rest: bool = False


@dataclass(frozen=True, slots=True)
class Noted:
    """Something that a person wants to be read later; it changes nothing, and may come after the end."""

    text: str


@dataclass(frozen=True, slots=True)
class Mounted:
    """A set-up was mounted anew for a branch whose readings are taken over: its own unknowns are others.

    setup : its name in the description; name : what it is called as it stood there
    branch : the chain behind the first event of the branch, its first digits; "" as it stood before its zero jumped
    """

    setup: str
    name: str
    branch: str


@dataclass(frozen=True, slots=True)
class Undone:
    """An earlier event, named by its number, is taken back."""

    event: int


@dataclass(frozen=True, slots=True)
class Finished:
    """The campaign ends, and why."""

    because: str


@dataclass(frozen=True, slots=True)
class Signed:
    """A person answers for all events before it: public key and Ed25519 signature in hex, as `signing` has them."""

    key: str
    signature: str


@dataclass(frozen=True, slots=True)
class Newer:
    """An entry that a newer version wrote: of an unknown kind, or with a field that this version does not know.

    kind, text : as they stand in the record, the text in JSON
    of_readings : the readings cannot be known without it
    """

    kind: str
    text: str
    of_readings: bool = False


Event = Created | Planned | Asked | Recorded | Skipped | Noted | Mounted | Accepted | Undone | Finished | Signed | Newer


@dataclass(frozen=True, slots=True)
class Stored:
    """An event in the record: its number from 1 and the UTC time it was written, ISO 8601."""

    number: int
    at: str
    event: Event


@dataclass(frozen=True, slots=True)
class Gap:
    """A reading that was asked for and could not be taken; whole : nor any other of its set-up."""

    asked: Asked
    reason: str
    whole: bool = False

    def holds(self, place: Place) -> bool:
        """Whether a planned place cannot be read."""
        return place.setup == self.place.setup and (self.whole or place.pose == self.place.pose)

    @property
    def place(self) -> Place:
        """Where it was to be taken."""
        return self.asked.place


@dataclass(frozen=True, slots=True)
class Note:
    """A note, its time (UTC, ISO 8601), and the number of the reading before it, 0 before the first."""

    text: str
    at: str
    after: int


@dataclass(frozen=True, slots=True)
class Undoable:
    """Something that can be taken back: the event, its number, and the question that was open before it.

    readings : before a mistake was accepted
    """

    number: int
    event: Recorded | Skipped | Accepted | Finished
    pending: Asked | None
    readings: tuple[Reading, ...] = ()


@dataclass(frozen=True, slots=True)
class State:
    """Where the campaign stands.

    readings : in the order they were taken, without those taken back; each has its number; accepted mistakes put right
    written : the same as they were recorded
    skipped : what could not be measured
    pending : what has been asked and not been answered
    finished : why the campaign ended, if it has
    plan : places that have been planned and not been asked for yet; plan_basis : what they were planned on
    renew : whether something happened that was not planned: a skip, a reading elsewhere, something taken back
    undo : what can be taken back, the latest last
    notes : what was noted on the way
    mounted : set-ups that were mounted anew for a branch, or whose zero jumped later
    newer : entries of a newer version, which say nothing of readings
    last : number of the last event
    name : the hash chained over the contents of all events, 64 hex digits; "" where they are in no record
    """

    created: Created | None = None
    readings: tuple[Reading, ...] = ()
    skipped: tuple[Gap, ...] = ()
    pending: Asked | None = None
    finished: str | None = None
    plan: tuple[Place, ...] = ()
    plan_basis: str = ""
    renew: bool = False
    undo: tuple[Undoable, ...] = ()
    notes: tuple[Note, ...] = ()
    mounted: tuple[Mounted, ...] = ()
    last: int = 0
    name: str = ""
    written: tuple[Reading, ...] = ()
    newer: tuple[Newer, ...] = ()

    @property
    def free(self) -> int:
        """The number of the next reading: readings and skips have one each, and keep it while they stand."""
        return _free(self.written, self.skipped)

    @property
    def coming(self) -> tuple[Place, ...]:
        """The places of the readings to come, the one asked for first."""
        return self.plan if self.pending is None else (self.pending.place, *self.plan)

    @property
    def clocked(self) -> float | None:
        """The time from the beginning to the last reading by the clock, s; None where it was not kept."""
        return max((reading.time for reading in self.readings if reading.time is not None), default=None)

    @property
    def accepted(self) -> tuple[Accepted, ...]:
        """The mistakes that were accepted and not taken back."""
        return tuple(each.event for each in self.undo if isinstance(each.event, Accepted))


class EventOrderError(ValueError):
    """Events that cannot have happened in this order; the record has been written by something else."""


def _free(readings: Sequence[Reading], skipped: Sequence[Gap]) -> int:
    taken = (*(reading.number or 0 for reading in readings), *(gap.asked.reading for gap in skipped))
    return max(taken, default=0) + 1


def fold(events: Iterable[Stored]) -> State:
    """Return the state after `events`; raise EventOrderError if they contradict each other."""
    folding = Folding()
    for stored in events:
        folding.add(stored)
    return folding.state()


class Folding:
    """The state while events are added to it, in time proportional to their number.

    `add` raises EventOrderError; what it was added to is then of no more use.
    """

    def __init__(self) -> None:
        self._created: Created | None = None
        self._readings: list[Reading] = []
        self._written: list[Reading] = []
        self._skipped: list[Gap] = []
        self._pending: Asked | None = None
        self._finished: str | None = None
        self._plan: list[Place] = []
        self._plan_basis = ""
        self._renew = False
        self._undo: list[Undoable] = []
        self._notes: list[Note] = []
        self._mounted: list[Mounted] = []
        self._newer: list[Newer] = []
        self._highest: list[int] = []
        self._last = 0

    def copied(self) -> Folding:
        """Return another that goes on from here."""
        other = copy(self)
        for name in ("_readings", "_written", "_skipped", "_plan", "_undo", "_notes", "_mounted", "_newer", "_highest"):
            setattr(other, name, list(getattr(self, name)))
        return other

    def state(self) -> State:
        """Return the state so far."""
        return State(
            self._created,
            tuple(self._readings),
            tuple(self._skipped),
            self._pending,
            self._finished,
            tuple(self._plan),
            self._plan_basis,
            self._renew,
            tuple(self._undo),
            tuple(self._notes),
            tuple(self._mounted),
            self._last,
            written=tuple(self._written),
            newer=tuple(self._newer),
        )

    def add(self, stored: Stored) -> None:
        """Let one more event happen."""
        event = stored.event
        self._refuse_disorder(stored)
        if isinstance(event, Created):
            self._created = event
        elif isinstance(event, Planned):
            self._plan, self._plan_basis, self._renew = list(event.places), event.basis, False
        elif isinstance(event, Asked):
            self._ask(event)
        elif isinstance(event, Undone):
            self._take_back(event)
        elif isinstance(event, Noted):
            after = self._readings[-1].number or len(self._readings) if self._readings else 0
            self._notes.append(Note(event.text, stored.at, after))
        elif isinstance(event, Mounted):
            self._mounted.append(event)
        elif isinstance(event, Newer):
            self._newer.append(event)
        elif isinstance(event, Accepted):
            self._undo.append(Undoable(stored.number, event, self._pending, tuple(self._readings)))
            self._accept(event)
        elif not isinstance(event, Signed):
            self._undo.append(Undoable(stored.number, event, self._pending))
            self._take(event)
        self._last = stored.number

    def _ask(self, event: Asked) -> None:
        self._pending = event
        if self._plan and self._plan[0] == event.place:
            del self._plan[0]

    def _refuse_disorder(self, stored: Stored) -> None:
        first = isinstance(stored.event, Created)
        if first and self._created is not None:
            raise EventOrderError("the campaign was created twice")
        if not first and self._created is None:
            raise EventOrderError("the first event is not the creation of the campaign")
        if self._finished is not None and not isinstance(stored.event, Undone | Noted | Signed | Newer):
            raise EventOrderError("it comes after the end of the campaign")

    def _take(self, event: Recorded | Skipped | Finished) -> None:
        if isinstance(event, Recorded):
            self._written.append(event.reading.under(self._counted(self._number(event))))
            self._readings.append(self._written[-1])
            planned = self._pending is not None and event.reading.place == self._pending.place
            self._renew = self._renew or not planned
        elif isinstance(event, Finished):
            self._finished = event.because
        elif self._pending is None:
            raise EventOrderError("a reading was skipped that nobody had asked for")
        else:
            gap = Gap(self._pending, event.reason, event.rest)
            self._skipped.append(gap)
            self._counted(gap.asked.reading)
            self._plan, self._renew = [place for place in self._plan if not gap.holds(place)], True
        self._pending = None

    def _accept(self, event: Accepted) -> None:
        """Put readings right; what is asked stays asked."""
        try:
            self._readings = put_right(self._readings, event)
        except ValueError as fault:
            raise EventOrderError(str(fault)) from None
        if event.name:
            if event.name in {each.name for each in self._mounted}:
                raise EventOrderError(f"there is a set-up {event.name!r} already")
            self._mounted.append(Mounted(event.setups[0], event.name, ""))
        self._renew = True

    def _number(self, event: Recorded) -> int:
        asked = self._pending.reading if self._pending else (self._highest[-1] if self._highest else 0) + 1
        return asked if event.reading.number is None else event.reading.number

    def _counted(self, number: int) -> int:
        """Remember the highest number so far, for the next free one, and return the number."""
        self._highest.append(max(number, self._highest[-1] if self._highest else 0))
        return number

    def _take_back(self, event: Undone) -> None:
        if not self._undo or self._undo[-1].number != event.event:
            raise EventOrderError(f"event {event.event} was taken back, but it was not the last one that can be")
        step = self._undo.pop()
        if self._pending is not None and self._pending != step.pending:
            self._plan.insert(0, self._pending.place)  # it was asked for and never taken
        if isinstance(step.event, Recorded):
            self._readings.pop()
            self._written.pop()
            self._highest.pop()
        elif isinstance(step.event, Accepted):
            self._readings = list(step.readings)
            self._mounted = [each for each in self._mounted if each.branch or each.name != step.event.name]
        elif isinstance(step.event, Skipped):
            gap = self._skipped.pop()
            self._highest.pop()
            self._plan = [] if gap.whole else self._plan  # a plan without the set-up is none to go on from
        else:
            self._finished = None
        self._pending, self._renew = step.pending, True
