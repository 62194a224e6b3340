"""The events that a campaign can have, and the state that follows from all of them.

Events are facts and never change; the state is always folded from them anew. Units are metres, radians and seconds.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from axiscal.measurement.reading import Place, Reading
from axiscal.record.accepted import Accepted, Bumped, put_right

Told = TypeVar("Told")


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
_OFTEN = Recorded, Planned, Asked, Continued
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


class EventOrderError(ValueError):
    """Events that cannot have happened in this order; the record has been written by something else."""


@dataclass(frozen=True, slots=True)
class State:
    """Where the campaign stands.

    readings : in the order they were taken, without those taken back; each has its number; accepted mistakes put right
    skipped : what could not be measured; pending : what has been asked and not been answered
    finished : why the campaign ended, if it has; last : number of the last event
    plan : places that have been planned and not been asked for yet; plan_basis : what they were planned on
    renew : whether something happened that was not planned: a skip, a reading elsewhere, something taken back
    continued : what a plan made now rests on, where no limit is reached by these readings; None where nobody has looked
    notes : what was noted, the latest last
    free : the number of the next reading: readings and skips have one each, and keep it while they stand
    story : the events that stand, readings with their numbers
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
    notes: tuple[Note, ...] = ()
    last: int = 0
    name: str = ""
    continued: str | None = None
    free: int = 1
    story: tuple[Stored, ...] = ()

    def without(self, taken: Undone) -> State:
        """Return the state that the story tells without what is taken back, and what was asked since."""
        number = self.undo[-1].number if self.undo else 0
        if not number or number != taken.event:
            raise EventOrderError(f"event {taken.event} was taken back, but it was not the last one that can be")
        step, later = self.undo[-1].event, (each for each in self.story if each.number != number)
        anew = fold(each for each in later if each.number < number or not isinstance(each.event, Asked))
        left = isinstance(step, Skipped) and step.rest  # a plan without the set-up is none to go on from
        renew = self.renew or not isinstance(step, Warmed)  # places do not depend on it
        return replace(anew, plan=() if left else anew.plan, renew=renew)

    def told(self, *kinds: type[Told]) -> tuple[Told, ...]:
        """Return the events of some kinds that stand, the latest last."""
        return tuple(each.event for each in self.story if isinstance(each.event, kinds))

    @property
    def undo(self) -> tuple[Stored, ...]:
        """What can be taken back, the latest last."""
        return tuple(each for each in self.story if isinstance(each.event, Done))

    @property
    def mounted(self) -> tuple[Mounted, ...]:
        """Set-ups that were mounted anew for a branch, or whose zero jumped later."""
        told = (each.event for each in self.story if isinstance(each.event, Mounted | Accepted) and each.event.name)
        return tuple(each if isinstance(each, Mounted) else Mounted(each.setups[0], each.name, "") for each in told)

    @property
    def result(self) -> KeptResult:
        """What a campaign that has ended came to."""
        return next((each.result for each in self.told(Finished)[-1:]), KeptResult())

    @property
    def coming(self) -> tuple[Place, ...]:
        """The places of the readings to come, the one asked for first."""
        return self.plan if self.pending is None else (self.pending.place, *self.plan)

    @property
    def clocked(self) -> float | None:
        """The time from the beginning to the last reading by the clock, s; None where it was not kept."""
        return max((reading.time for reading in self.readings if reading.time is not None), default=None)


_BEGUN = State()


def fold(events: Iterable[Stored], state: State = _BEGUN) -> State:
    """Return the state after `events`; raise EventOrderError where they cannot have happened.

    Linear in readings: they and the story are lists until another event looks at them.
    """
    readings, story = [*state.readings], [*state.story]
    for stored in events:
        event = stored.event
        if isinstance(event, Created) is (state.created is not None):
            raise EventOrderError("the creation of the campaign is its first event, and no other one")
        if state.finished is not None and not isinstance(event, (Undone, *_ASIDE)):
            raise EventOrderError("it comes after the end of the campaign")
        if not isinstance(event, _OFTEN):
            state = replace(state, readings=tuple(readings), story=tuple(story))
        if isinstance(event, Recorded):
            asked = None if state.pending is None else state.pending.reading
            given = event.reading.number, asked, state.free
            event = Recorded(event.reading.under(next(number for number in given if number is not None)))
            stored = replace(stored, event=event)
            readings.append(event.reading)
        if isinstance(event, Undone):
            state = state.without(event)
            readings, story = [*state.readings], [*state.story]
        else:
            story.append(stored)
        changes = _changes(state, event, stored.at)
        if "readings" in changes:
            readings = [*changes["readings"]]
        if not isinstance(event, _SILENT):
            changes["continued"] = event.grounds if isinstance(event, Continued) else None
        state = replace(state, **changes, last=stored.number)
    return replace(state, readings=tuple(readings), story=tuple(story))


def _changes(state: State, event: Event, at: str) -> dict[str, Any]:
    """Return the fields of a state that are others after an event.  at : when it was written"""
    match event:
        case Created():
            return {"created": event}
        case Planned(places, grounds):
            return {"plan": places, "plan_basis": grounds, "renew": False}
        case Asked(place=place):
            return {"pending": event, "plan": state.plan[state.plan[:1] == (place,) :]}
        case Recorded(reading):
            renew = state.renew or state.pending is None or reading.place != state.pending.place
            return {"free": max(state.free, (reading.number or 0) + 1), "renew": renew, "pending": None}
        case Skipped(reason, rest):
            if state.pending is None:
                raise EventOrderError("a reading was skipped that nobody had asked for")
            gap = Gap(state.pending, reason, rest)
            plan = tuple(place for place in state.plan if not gap.holds(place))
            free = max(state.free, gap.asked.reading + 1)
            return {"skipped": (*state.skipped, gap), "plan": plan, "renew": True, "free": free, "pending": None}
        case Accepted():  # what is asked stays asked
            return {"readings": _put_right(state, event), "renew": True}
        case Noted(text) | Warmed(text=text):
            after = state.readings[-1].numbered(len(state.readings) - 1) if state.readings else 0
            return {"notes": (*state.notes, Note(text, at, after, event if isinstance(event, Warmed) else None))}
        case Finished(because):
            return {"finished": because, "pending": None}
    return {}


def _put_right(state: State, event: Accepted) -> tuple[Reading, ...]:
    """Return the readings without a mistake; raises EventOrderError where they cannot have it."""
    if event.mistake == "jump" and event.reading > state.free:
        raise EventOrderError(f"reading {event.reading} is not the next one")
    if event.name and event.name in {each.name for each in state.mounted}:
        raise EventOrderError(f"there is a set-up {event.name!r} already")
    try:
        return tuple(put_right(state.readings, event, state.created.machine_text if state.created else ""))
    except ValueError as fault:
        raise EventOrderError(str(fault)) from None
