"""The log of one campaign's events."""

from __future__ import annotations

import contextlib
from abc import abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

from axiscal.document.durable import Closing
from axiscal.document.quoting import shown
from axiscal.exceptions import NewerError, OvertakenError, RecordError
from axiscal.record.events import Event, EventOrderError, Folding, Newer, Signed, State, Stored, fold
from axiscal.record.line_form import DamageError, EventText, chained
from axiscal.record.payload import PayloadError, decode, encode, hand_of
from axiscal.record.signing import Hand, Signature, holds, key_file, own_hand, signature, step_now, what_is_signed

EMPTY = 64 * "0"
"""The chain before the first event."""


class ChainedText(NamedTuple):
    """One event as it was written, and the chain behind it: the name of all that the log held then."""

    row: EventText
    chain: str


class EventLog(Closing):
    """The events of one campaign, oldest first; events are only ever added. Every failure is a RecordError.

    path : as people name it
    """

    def __init__(self, path: Path) -> None:
        self.path, self._story = path, Story()

    @property
    @abstractmethod
    def name(self) -> str:
        """The name of what it holds: a hash chained over the contents of its events, 64 hex digits."""

    @abstractmethod
    def extend(self, rows: Sequence[EventText], after: int | None = None) -> int:
        """Keep events as they were written elsewhere, all or none; else as `append`."""

    @abstractmethod
    def last(self) -> int:
        """Take in what others have written since, and return the number of the last event, 0 if there is none."""

    @abstractmethod
    def texts(self) -> tuple[ChainedText, ...]:
        """Return all events as they were written."""

    def append(self, *events: Event, after: int | None = None) -> int:
        """Keep `events`, all or none, and return the number of the last one.

        after : number of the last event the caller knows of; OvertakenError if another one has written since
        Raises ValueError for an event that cannot be kept, NewerError where a newer version has written.
        """
        self._story.refuse_to_add(self.path)
        return self.extend(rows_of(events), after)

    def sign(self) -> bool:
        """Let this person answer for all events so far, and return whether; not without a key, nor twice.

        Raises NewerError as `append`, OvertakenError if another process writes meanwhile.
        """
        self._story.refuse_to_add(self.path)
        if not key_file().exists():
            return False
        texts, at = self.texts(), _now()
        by, last = signature(_signable(at, texts)), texts[-1].row
        if by is None or (last.kind == "signed" and by.key in last.payload):
            return False
        row = EventText(at, *encode(Signed(by.key, by.signature), Hand(by.person, by.computer)))
        self.extend([row], after=len(texts))
        return True

    def holds(self, step: str) -> bool:
        """Return whether a step wrote more than a plan.  step : its id, hex digits; "" for none"""
        mark = f'"step":"{step}"'  # in what a person wrote it would stand with backslashes
        rows = [text.row for text in self.texts()] if step else []
        return any(mark in row.payload and row.kind not in ("planned", "continued", "asked") for row in rows)

    def events(self) -> tuple[Stored, ...]:
        """Return all events, oldest first."""
        self.last()
        return tuple(self._story.events)

    def state(self) -> State:
        """Return the state folded from all events."""
        self.last()
        return replace(self._story.state(self.path), name=self.name)


class SignedUntil(NamedTuple):
    """How far a log is signed: the number of the event, whose it is, whether every signature is of what was before.

    reading : the number of the last reading that stood then
    """

    number: int
    by: Signature
    holds: bool
    reading: int


def signed_until(log: EventLog) -> SignedUntil | None:
    """Return the last signature of a log, or the first that does not hold; None where nobody has signed."""
    events, found = log.events(), None
    texts = log.texts() if any(isinstance(each.event, Signed) for each in events) else ()
    for number, event in ((each.number, each.event) for each in events if isinstance(each.event, Signed)):
        by, holds = signed_by(texts[number - 1].row, event, texts[: number - 1])
        found = SignedUntil(number, by, holds, 0)
        if not holds:
            break
    if found is None:
        return None
    readings = fold(events[: found.number]).readings
    return found._replace(reading=readings[-1].numbered(len(readings) - 1) if readings else 0)


def signed_by(row: EventText, event: Signed, before: Sequence[ChainedText]) -> tuple[Signature, bool]:
    """Return whose signature one is, and whether it is of the events before it."""
    by = Signature(*(hand_of(row.payload) or Hand("", "")), event.key, event.signature)
    return by, holds(_signable(row.at, before), by)


def refuse_changed(log: EventLog) -> None:
    """Raise RecordError for a log that was changed since it was signed."""
    signed = signed_until(log)
    if signed is not None and not signed.holds:
        what = "The record was changed since {person} signed it at event {number}"
        remedy = "Go on with a copy of before; tools/check_record.py says what was changed"
        raise RecordError(what, remedy, log.path, person=signed.by.person, number=signed.number)


def _signable(at: str, texts: Sequence[ChainedText]) -> dict[str, object]:
    return what_is_signed(at, ((text.row.at, text.chain) for text in texts))


class Story:
    """The events of a log as far as they have been read, and the state that follows from them.

    An entry of a newer version stops the state where it may say something of readings; the events go on.
    """

    def __init__(self) -> None:
        self.events, self._folding = list[Stored](), Folding()
        self._newer: Stored | None = None
        self._stopped = False

    def happened(self, number: int, row: EventText) -> None:
        """Take over an event that was read; raises DamageError."""
        try:
            stored = Stored(number, row.at, decode(row.kind, row.payload))
        except PayloadError as error:
            raise DamageError(f"event {number}: {error}") from error
        _refuse_timeless(stored)
        try:
            self._fold(stored)
        except EventOrderError as error:
            raise DamageError(f"event {number}: {error}") from error
        self.events.append(stored)

    def _fold(self, stored: Stored) -> None:
        event = stored.event
        if isinstance(event, Newer):
            self._newer = self._newer or stored
            self._stopped = self._stopped or event.of_readings
        if self._stopped:
            return
        try:
            self._folding.add(stored)
        except EventOrderError:
            if self._newer is None:
                raise
            self._stopped = True  # it may follow from the newer entry

    def then(self, rows: Sequence[EventText], path: Path) -> Story:
        """Return this with events that are to be written behind; raises RecordError where they cannot follow."""
        after = Story()
        after._folding, after._newer, after._stopped = self._folding.copied(), self._newer, self._stopped
        stored = [Stored(len(self.events) + n, row.at, decode(row.kind, row.payload)) for n, row in enumerate(rows, 1)]
        try:
            for each in stored:
                after._fold(each)
        except EventOrderError as error:
            remedy = "Look at it with `axiscal step status`; nothing was written"
            raise RecordError("This cannot follow what the record holds: {error}", remedy, path, error=error) from error
        after.events = [*self.events, *stored]
        return after

    def state(self, path: Path) -> State:
        """Return the state folded from all events; raises NewerError."""
        if self._stopped:
            raise self._of_newer("This one can copy the record, no more", path)
        return self._folding.state()

    def refuse_to_add(self, path: Path) -> None:
        """Raise NewerError where a newer version wrote here: what this one adds might not follow."""
        if self._newer is not None:
            raise self._of_newer("This one can read and copy the record; nothing was written", path)

    def _of_newer(self, still: str, path: Path) -> NewerError:
        assert self._newer is not None
        kind = shown(encode(self._newer.event)[0])
        what = "Event {number} is an entry of a newer version of axiscal: {kind}"
        remedy = "Install that version to go on with it. {still}"
        return NewerError(what, remedy, path, number=self._newer.number, kind=kind, still=still)


def _refuse_timeless(stored: Stored) -> None:
    """Raise DamageError for an event without the time at which it was written."""
    with contextlib.suppress(ValueError):
        if datetime.fromisoformat(stored.at).tzinfo is not None:
            return
    raise DamageError(f"event {stored.number}: {stored.at[:40]!r} is no time")


def rows_of(events: Sequence[Event]) -> list[EventText]:
    """Return events as they are written now, in one transaction; raises ValueError for one that cannot be kept."""
    at, hand, step = _now(), own_hand(), step_now()
    return [EventText(at, *encode(event, hand, step), n == len(events)) for n, event in enumerate(events, 1)]


def in_one(rows: Sequence[EventText]) -> list[EventText]:
    """Return events of another log as one transaction."""
    return [row._replace(closes=n == len(rows)) for n, row in enumerate(rows, 1)]


def chained_texts(rows: Iterable[EventText], chain: str = EMPTY) -> list[ChainedText]:
    """Return events with the chain behind each."""
    found = list[ChainedText]()
    for row in rows:
        chain = chained(chain, row)
        found.append(ChainedText(row, chain))
    return found


def refuse_overtaken(last: int, after: int | None, path: Path) -> None:
    """Raise OvertakenError where a log has gone on since the caller looked at it."""
    if after is not None and last != after:
        remedy = "Look at it with `axiscal step status`, then give the command again"
        raise OvertakenError("Another process has written to this record in the meantime", remedy, path)


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds")
