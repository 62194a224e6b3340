"""The story that events tell: whether each can follow, the state that they make, and who answers for them."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

from axiscal.document.quoting import shown
from axiscal.exceptions import NewerError, RecordError
from axiscal.record.events import Event, EventOrderError, Folding, Newer, Signed, State, Stored, fold
from axiscal.record.lines import EMPTY, DamageError, EventText, chained
from axiscal.record.payload import PayloadError, decode, encode, hand_of
from axiscal.record.signing import Hand, Signature, holds, own_hand, step_now


class SignedUntil(NamedTuple):
    """How far a log is signed: the number of the event, whose it is, whether every signature is of what was before.

    reading : the number of the last reading that stood then
    """

    number: int
    by: Signature
    holds: bool
    reading: int


def signed_until(events: Sequence[Stored], rows: Sequence[EventText]) -> SignedUntil | None:
    """Return the last signature of a record, or the first that does not hold; None where nobody has signed."""
    found = None
    for number, event in ((each.number, each.event) for each in events if isinstance(each.event, Signed)):
        by, holds = signed_by(rows[number - 1], event, rows[: number - 1])
        found = SignedUntil(number, by, holds, 0)
        if not holds:
            break
    if found is None:
        return None
    readings = fold(events[: found.number]).readings
    return found._replace(reading=readings[-1].numbered(len(readings) - 1) if readings else 0)


def signed_by(row: EventText, event: Signed, before: Sequence[EventText]) -> tuple[Signature, bool]:
    """Return whose signature one is, and whether it is of the events before it."""
    by = Signature(*(hand_of(row.payload) or Hand("", "")), event.key, event.signature)
    return by, holds(signable(row.at, before), by)


def signable(at: str, rows: Sequence[EventText]) -> dict[str, object]:
    """Return the document that a signature is of: its time, and time and chain of all events before it."""
    digest, chain = hashlib.sha256(), EMPTY
    for row in rows:
        chain = chained(chain, row)
        digest.update(f"{row.at} {chain}\n".encode())
    return {"at": at, "before": digest.hexdigest()}


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

    def refuse_unfit(self, rows: Sequence[EventText], path: Path) -> None:
        """Raise RecordError for events that are to be written behind and cannot follow."""
        after = Story()
        after._folding, after._newer, after._stopped = self._folding.copied(), self._newer, self._stopped
        try:
            for number, row in enumerate(rows, len(self.events) + 1):
                after._fold(Stored(number, row.at, decode(row.kind, row.payload)))
        except EventOrderError as error:
            remedy = "Look at it with `axiscal step status`; nothing was written"
            raise RecordError("This cannot follow what the record holds: {error}", remedy, path, error=error) from error

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
    try:
        timeless = datetime.fromisoformat(stored.at).tzinfo is None
    except ValueError:
        timeless = True
    if timeless:
        raise DamageError(f"event {stored.number}: {stored.at[:40]!r} is no time")


def rows_of(events: Sequence[Event]) -> list[EventText]:
    """Return events as they are written now; raises ValueError for one that cannot be kept."""
    at, hand, step = now(), own_hand(), step_now()
    return [EventText(at, *encode(event, hand, step)) for event in events]


def now() -> str:
    """Return the time as a record has it: ISO 8601, UTC."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")
