"""Who answers for how much of a record, whether it was changed since, and which mountings were not as they should."""

from __future__ import annotations

import re
from collections.abc import Iterable

from axiscal.language.spoken import counted, said
from axiscal.record.events import Note
from axiscal.record.signing import is_own
from axiscal.record.store import Record


def signed_text(record: Record) -> str:
    """Return who answers for how much of the record, in words behind "the record is", "" where nobody does."""
    found, last = record.signed(), record.last()
    if found is None:
        return ""
    by = said("{person} on {computer}", person=found.person, computer=found.computer)
    if not is_own(found.key):
        by = said("{by}, key {key}", by=by, key=found.key[:16])
    if not found.holds:
        return said("changed since it was signed at event {number} by {by}", number=found.number, by=by)
    signed = said("signed by {by} until reading {reading}", by=by, reading=found.reading)
    if found.number == last:
        return signed
    since = counted("{count} event", "{count} events", last - found.number)
    return said("{signed}; unsigned since: {events}", signed=signed, events=since)


def evidence_words(record: Record) -> str:
    """Return the sentence for screens, pages and reports; "" for a record that nobody has signed."""
    signed = signed_text(record)
    return said("The record is {signed}.", signed=signed) if signed else ""


OVERRULED = "taken all the same"
TESTED = re.compile(r'test of sign "(.*)": .* \((.*)\)')
"""Of a note: the set-up that was tested when it was mounted, and what came of it."""


def overruled(notes: Iterable[Note]) -> list[str]:
    """Return the set-ups that were read although the test at their last mounting failed."""
    found = {each[1]: each[2] for note in notes if (each := TESTED.fullmatch(note.text))}
    return [setup for setup, verdict in found.items() if verdict == OVERRULED]
