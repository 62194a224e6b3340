"""A new record of what stands whole in a damaged one. Nothing is guessed: what cannot be known is named."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from axiscal.campaign.possible import Possible, created_description
from axiscal.description.campaign import CampaignDescription
from axiscal.exceptions import NewerError, RecordError
from axiscal.record.accepted import Accepted
from axiscal.record.events import Created, Event, EventOrderError, Folding, Newer, Noted, Signed, State, Stored, Undone
from axiscal.record.line_form import EventText
from axiscal.record.log import rows_of
from axiscal.record.payload import PayloadError, decode, encode, hand_of
from axiscal.record.salvage import Standing, standing
from axiscal.record.store import Record, refuse_existing

_MOST = 20
"""So many stretches and entries are listed in the note; all are printed."""


@dataclass(frozen=True, slots=True)
class Salvaged:
    """What came back.

    state : of the new record; entries : of the old one that it has
    missing, left : sentences on entries that do not stand whole, and on those that do and cannot be used
    """

    state: State
    entries: int
    missing: tuple[str, ...]
    left: tuple[str, ...]


class _UnfitError(Exception):
    """A whole entry that cannot stand where others are missing: its number, and why."""

    def __init__(self, number: int, why: object) -> None:
        super().__init__(number, why)
        self.number, self.why = number, why


def salvaged(path: Path, new: Path, beginning: EventText | None = None) -> Salvaged:
    """Write a new record of what stands whole in another one, in its order; that one stays as it is.

    beginning : the first entry, in the place of one that is lost
    Raises RecordError, also where there is something at `new`.
    """
    refuse_existing(new)
    found = standing(path)
    entries = found.entries
    replaced = beginning is not None and 1 not in entries
    if beginning is not None and replaced:
        entries = {1: beginning, **entries}
    created = _created(entries, path)
    rows, left = _fitting(entries, created_description(created), path)
    missing = _missing_words(found, replaced)
    note = Noted(_note(path, len(rows), missing, left))
    with Record.made(new, [*rows, *rows_of([note])]) as record:
        return Salvaged(record.state(), len(rows), missing, left)


def _created(entries: Mapping[int, EventText], path: Path) -> Created:
    """Return the beginning of the campaign; raises RecordError."""
    created = decode(entries[1].kind, entries[1].payload) if 1 in entries else None
    if isinstance(created, Created):
        return created
    kept = sum(row.kind == "recorded" for row in entries.values())
    what = "Event 1, which holds the descriptions, does not stand whole; {kept} readings do"
    remedy = "Name a copy of the record, however old, or its campaign.toml: --beginning FILE"
    raise RecordError(what, remedy, path, kept=kept)


def _fitting(
    entries: Mapping[int, EventText], description: CampaignDescription, path: Path
) -> tuple[list[EventText], tuple[str, ...]]:
    """Return the entries that can follow each other, and why others cannot."""
    left = dict[int, str]()
    while True:
        try:
            rows = _following({n: row for n, row in entries.items() if n not in left}, description, path)
        except _UnfitError as unfit:
            left[unfit.number] = f"event {unfit.number} ({entries[unfit.number].kind}): {unfit.why}"
        else:
            return rows, tuple(left[number] for number in sorted(left))


def _following(entries: Mapping[int, EventText], description: CampaignDescription, path: Path) -> list[EventText]:
    """Return entries with the numbers that they have now; raises _UnfitError."""
    folding, possible = Folding(), Possible.of(description)
    numbers, rows = dict[int, int](), list[EventText]()
    for number, row in entries.items():
        event = _event(number, row)
        if isinstance(event, Newer) and event.of_readings:
            what = "Event {number} is an entry of a newer version: {kind}"
            raise NewerError(what, "Salvage it with that one", path, number=number, kind=event.kind)
        if isinstance(event, Undone):
            if event.event not in numbers:
                raise _UnfitError(number, "what it takes back is missing")
            event = Undone(numbers[event.event])
            row = row._replace(payload=encode(event, hand_of(row.payload))[1])
        if isinstance(event, Accepted) and number > len(rows) + 1:
            raise _UnfitError(number, "what it puts right may be missing; accept it anew")
        if isinstance(event, Signed) and number > len(rows) + 1:
            raise _UnfitError(number, "it answers for what is missing; sign anew")
        if fault := possible.fault(event):
            raise _UnfitError(number, fault)
        try:
            folding.add(Stored(len(rows) + 1, row.at, event))
        except EventOrderError as fault:
            raise _taken_back(event, folding.state(), list(numbers)) or _UnfitError(number, fault) from None
        possible = possible.after(event)
        rows.append(row)
        numbers[number] = len(rows)
    return rows


def _event(number: int, row: EventText) -> Event:
    try:
        return decode(row.kind, row.payload)
    except PayloadError as error:
        raise _UnfitError(number, error) from None


def _taken_back(event: Event, state: State, numbers: list[int]) -> _UnfitError | None:
    """Return the entry that must have been taken back for this one to follow, by an entry that is missing."""
    step = state.undo[-1].number if state.undo else 0
    if not step or (state.finished is None and not (isinstance(event, Undone) and event.event < step)):
        return None
    return _UnfitError(numbers[step - 1], "what follows shows that it was taken back")


def _missing_words(found: Standing, replaced: bool) -> tuple[str, ...]:
    words = list[str]()
    for each in found.missing:
        which = f"event {each.first}" if each.first == each.last else f"events {each.first} to {each.last}"
        words.append(f"{which} (bytes {each.begin} to {each.end})")
    if replaced:
        words.append("event 1, which is that of another file")
    for begin, end, lines in found.apart:
        words.append(f"{lines} whole lines (bytes {begin} to {end}) may be of another file: no chain leads to them")
    if not found.ends:
        words.append("both marks of its end: events behind the last one may be missing, too")
    return tuple(words)


def _note(path: Path, entries: int, missing: tuple[str, ...], left: tuple[str, ...]) -> str:
    said = [*missing, *left]
    more = [f"and {len(said) - _MOST} more"] if len(said) > _MOST else []
    listed = "; ".join([*said[:_MOST], *more]) or "nothing"
    return f"salvaged from {path.name}, {entries} events, numbered anew. Missing: {listed}"
