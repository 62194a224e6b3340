"""The story that events tell: the state that follows, how they are written now, and who answers for them."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import NamedTuple

from axiscal.record.events import Event, EventOrderError, Folding, Newer, Signed, Stored, fold
from axiscal.record.lines import EMPTY, EventText, chained
from axiscal.record.payload import encode, hand_of
from axiscal.record.signing import Hand, Signature, holds, own_hand, step_now


@dataclass(eq=False, slots=True)
class Story(Folding):
    """The state as far as this version can know it, while events are added.

    first_newer : the first entry of a newer version; stopped : it, or what follows it, may say something of readings
    """

    first_newer: Stored | None = None
    stopped: bool = False

    def add(self, stored: Stored) -> None:
        """Let one more event happen, as in `Folding`."""
        if isinstance(stored.event, Newer):
            self.first_newer = self.first_newer or stored
            self.stopped |= stored.event.of_readings
        if self.stopped:
            return
        try:
            Folding.add(self, stored)
        except EventOrderError:
            if self.first_newer is None:
                raise
            self.stopped = True  # it may follow from the newer entry


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
        found = number, *signed_by(rows[number - 1], event, rows[: number - 1])
        if not found[2]:
            break
    if found is None:
        return None
    readings = fold(events[: found[0]]).readings
    return SignedUntil(*found, readings[-1].numbered(len(readings) - 1) if readings else 0)


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


def rows_of(events: Sequence[Event]) -> list[EventText]:
    """Return events as they are written now; raises ValueError for one that cannot be kept."""
    at, hand, step = now(), own_hand(), step_now()
    return [EventText(at, *encode(event, hand, step)) for event in events]


def now() -> str:
    """Return the time as a record has it: ISO 8601, UTC."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")
