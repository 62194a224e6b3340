"""The events that a campaign can have, and the state that follows from all of them.

Events are facts and never change; the state is always folded from them anew. Units are metres, radians and seconds.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from copy import copy
from dataclasses import dataclass, field, fields
from typing import Any, Self

from axiscal.measurement.reading import Place, Reading
from axiscal.record.accepted import Accepted, Bumped, put_right


@dataclass(frozen=True, slots=True)
class KeptResult:
    """What the readings of a campaign came to, as its last event keeps it.

    rms, expanded : RMS standard uncertainty over the volume and U, m, None where none is promised
    agreement : whether the readings "agree" or "contradict" each other; "" where nobody has said
    """

    rms: float | None = None
    expanded: float | None = None
    agreement: str = ""


@dataclass(frozen=True, slots=True)
class Created:
    """The campaign begins; it carries its own inputs, so that the record needs no other file.

    machine_text, campaign_text : the two descriptions, word for word
    machine_source, campaign_source : where they were read; versions : of axiscal and of what it computes with
    prior_text : the campaign whose result is its prior, as `heritage` writes it; "" for none
    usual_doubts, fine_knots, whole_lengths : what nothing is stated of is doubted as is usual, knots are as close as
        is cheap, and a length is one reading, not one at each end; records of before could not say these
    """

    machine_text: str
    campaign_text: str
    machine_source: str
    campaign_source: str
    versions: Mapping[str, str]
    prior_text: str = ""
    usual_doubts: bool = False
    fine_knots: bool = False
    whole_lengths: bool = False


@dataclass(frozen=True, slots=True)
class Planned:
    """The readings to come, in the place of those before; grounds : what they rest on besides places, in words."""

    places: tuple[Place, ...]
    grounds: str = ""


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
class Warmed:
    """The scale that a set-up reads has a temperature, K, which counts.  text : as a person wrote it"""

    setup: str
    temperature: float
    text: str


@dataclass(frozen=True, slots=True)
class Continued:
    """No limit is reached by the readings before it; grounds : what a plan made now rests on, as of `Planned`."""

    grounds: str


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
    """The campaign ends, and why; result : what it came to, which records of before could not say."""

    because: str
    result: KeptResult = KeptResult()


@dataclass(frozen=True, slots=True)
class Signed:
    """A person answers for all events before it: public key and Ed25519 signature in hex, as `signing` has them."""

    key: str
    signature: str


@dataclass(frozen=True, slots=True)
class Lost:
    """An event of this number does not stand whole any more, or cannot be, and why; repair puts it there."""

    why: str


Done = Recorded | Skipped | Accepted | Warmed | Finished
"""What can be taken back."""
_ASIDE = Noted, Bumped, Signed, Lost  # what may come after the end, and says nothing of what is known
_SILENT = Planned, Asked, *_ASIDE
Event = Created | Planned | Asked | Continued | Done | Noted | Bumped | Mounted | Undone | Signed | Lost


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
    """A note, its time (UTC, ISO 8601), the number of the reading before it, 0 for none, and the temperature it is."""

    text: str
    at: str
    after: int
    warmed: Warmed | None = None


@dataclass(frozen=True, slots=True)
class State:
    """Where the campaign stands.

    readings : in the order they were taken, without those taken back; each has its number; accepted mistakes put right
    written : the same as they were recorded
    skipped : what could not be measured; pending : what has been asked and not been answered
    finished : why the campaign ended, if it has; last : number of the last event
    plan : places that have been planned and not been asked for yet; plan_basis : what they were planned on
    renew : whether something happened that was not planned: a skip, a reading elsewhere, something taken back
    continued : what a plan made now rests on, where no limit is reached by these readings; None where nobody has looked
    undo : what can be taken back, the latest last
    mounted : set-ups that were mounted anew for a branch, or whose zero jumped later
    notes : what was noted; bumps : the latest last
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
    undo: tuple[Stored, ...] = ()
    notes: tuple[Note, ...] = ()
    mounted: tuple[Mounted, ...] = ()
    last: int = 0
    name: str = ""
    written: tuple[Reading, ...] = ()
    bumps: tuple[Bumped, ...] = ()
    continued: str | None = None

    @property
    def free(self) -> int:
        """The number of the next reading: readings and skips have one each, and keep it while they stand."""
        taken = (*(reading.number or 0 for reading in self.written), *(gap.asked.reading for gap in self.skipped))
        return max(taken, default=0) + 1

    @property
    def result(self) -> KeptResult:
        """What a campaign that has ended came to."""
        last = self.undo[-1].event if self.undo else None
        return last.result if isinstance(last, Finished) else KeptResult()

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

    @property
    def warmed(self) -> tuple[Warmed, ...]:
        """The temperatures that were said and not taken back."""
        return tuple(each.event for each in self.undo if isinstance(each.event, Warmed))


class EventOrderError(ValueError):
    """Events that cannot have happened in this order; the record has been written by something else."""


def fold(events: Iterable[Stored]) -> State:
    """Return the state after `events`; raise EventOrderError if they contradict each other."""
    folding = Folding()
    for stored in events:
        folding.add(stored)
    return folding.state()


@dataclass(eq=False, slots=True)
class Folding:
    """The state while events are added to it; fields as of `State`.

    highest : number of a reading or a skip so far; story : the events that stand
    `add` raises EventOrderError, and then nothing has happened
    """

    created: Created | None = None
    readings: list[Reading] = field(default_factory=list)
    written: list[Reading] = field(default_factory=list)
    skipped: list[Gap] = field(default_factory=list)
    pending: Asked | None = None
    finished: str | None = None
    plan: list[Place] = field(default_factory=list)
    plan_basis: str = ""
    renew: bool = False
    continued: str | None = None
    undo: list[Stored] = field(default_factory=list)
    notes: list[Note] = field(default_factory=list)
    mounted: list[Mounted] = field(default_factory=list)
    bumps: list[Bumped] = field(default_factory=list)
    story: list[Stored] = field(default_factory=list)
    highest: int = 0
    last: int = 0

    def copied(self) -> Self:
        """Return another that goes on from here."""
        return type(self)(**{each.name: copy(getattr(self, each.name)) for each in fields(self)})

    def state(self) -> State:
        """Return the state so far."""
        named = ((each.name, getattr(self, each.name)) for each in fields(State) if each.name != "name")
        found: dict[str, Any] = {name: tuple(one) if isinstance(one, list) else one for name, one in named}
        return State(**found)

    def add(self, stored: Stored) -> None:
        """Let one more event happen."""
        event = stored.event
        if isinstance(event, Created) is (self.created is not None):
            raise EventOrderError("the creation of the campaign is its first event, and no other one")
        if self.finished is not None and not isinstance(event, (Undone, *_ASIDE)):
            raise EventOrderError("it comes after the end of the campaign")
        if isinstance(event, Created):
            self.created = event
        elif isinstance(event, Planned):
            self.plan, self.plan_basis, self.renew = list(event.places), event.grounds, False
        elif isinstance(event, Asked):
            self.pending = event
            if self.plan and self.plan[0] == event.place:
                del self.plan[0]
        elif isinstance(event, Undone):
            self._take_back(event)
        elif isinstance(event, (Noted, Warmed)):
            after = self.readings[-1].number or len(self.readings) if self.readings else 0
            self.notes.append(Note(event.text, stored.at, after, event if isinstance(event, Warmed) else None))
        elif isinstance(event, Mounted):
            self.mounted.append(event)
        elif isinstance(event, Bumped):
            self.bumps.append(event)
        elif isinstance(event, Accepted):
            self._accept(event)
        elif isinstance(event, (Recorded, Skipped, Finished)):
            self._take(event)
        if not isinstance(event, _SILENT):
            self.continued = event.grounds if isinstance(event, Continued) else None
        if not isinstance(event, Undone):
            self.story.append(stored)
        if isinstance(event, Done):
            self.undo.append(stored)
        self.last = stored.number

    def _take(self, event: Recorded | Skipped | Finished) -> None:
        if isinstance(event, Recorded):
            asked = self.pending.reading if self.pending else self.highest + 1
            number = asked if event.reading.number is None else event.reading.number
            self.highest = max(self.highest, number)
            self.written.append(event.reading.under(number))
            self.readings.append(self.written[-1])
            self.renew |= self.pending is None or event.reading.place != self.pending.place
        elif isinstance(event, Finished):
            self.finished = event.because
        elif self.pending is None:
            raise EventOrderError("a reading was skipped that nobody had asked for")
        else:
            gap = Gap(self.pending, event.reason, event.rest)
            self.skipped.append(gap)
            self.highest = max(self.highest, gap.asked.reading)
            self.plan, self.renew = [place for place in self.plan if not gap.holds(place)], True
        self.pending = None

    def _accept(self, event: Accepted) -> None:
        """Put readings right; what is asked stays asked."""
        if event.mistake == "jump" and event.reading > self.highest + 1:
            raise EventOrderError(f"reading {event.reading} is not the next one")
        if event.name and event.name in {each.name for each in self.mounted}:
            raise EventOrderError(f"there is a set-up {event.name!r} already")
        try:
            self.readings = put_right(self.readings, event, self.created.machine_text if self.created else "")
        except ValueError as fault:
            raise EventOrderError(str(fault)) from None
        self.mounted += [Mounted(event.setups[0], event.name, "")] if event.name else []
        self.renew = True

    def _take_back(self, event: Undone) -> None:
        """Tell the story anew without what is taken back, and what was asked since."""
        if not self.undo or self.undo[-1].number != event.event:
            raise EventOrderError(f"event {event.event} was taken back, but it was not the last one that can be")
        step, renew, anew = self.undo[-1].event, self.renew, Folding()
        for each in self.story:
            if each.number < event.event or not (each.number == event.event or isinstance(each.event, Asked)):
                anew.add(each)
        for name in [each.name for each in fields(self)]:
            setattr(self, name, getattr(anew, name))
        if isinstance(step, Skipped) and step.rest:
            self.plan = []  # a plan without the set-up is none to go on from
        self.renew = renew or not isinstance(step, Warmed)  # places do not depend on it
