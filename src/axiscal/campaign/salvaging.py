"""A new record of what stands whole in a damaged one. Nothing is guessed: what cannot be known is named.

An entry is whole if its own sum is right and its place is certain. A chain of SHA-256 must lead to it from the
beginning of the record, or from it to a mark of the end. Its number follows. Whole lines between two damages whose
place no chain shows may be those of another file, so they are named and left out.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from axiscal.campaign.possible import Possible, created_description
from axiscal.description.campaign import CampaignDescription
from axiscal.exceptions import NewerError, RecordError
from axiscal.record.accepted import Accepted
from axiscal.record.events import Created, Event, EventOrderError, Folding, Newer, Noted, Signed, State, Stored, Undone
from axiscal.record.line_form import (
    BLOCK,
    FORM,
    MARKS,
    START,
    EventText,
    Mark,
    WholeLine,
    chained,
    damaged_row,
    form_of,
    read_mark,
    whole_lines,
)
from axiscal.record.log import EMPTY, rows_of
from axiscal.record.payload import PayloadError, decode, encode, hand_of
from axiscal.record.store import Record, refuse_existing

_BEGINNING = WholeLine(START, START, EventText("", "", ""), EMPTY)
"""What the first event follows."""
_WIPED = 16 * " "
"""No line of text has so many blanks; any number of some would do, for a sector has 512 bytes."""


class Missing(NamedTuple):
    """Entries that do not stand whole: the first and the last number, and from which byte to which they stood."""

    first: int
    last: int
    begin: int
    end: int


class Standing(NamedTuple):
    """What stands whole.

    entries : by number; missing : in order
    apart : bytes from, to, and number of lines that are whole and may be of another file
    ends : whether a mark of this record says where it ends
    """

    entries: dict[int, EventText]
    missing: list[Missing]
    apart: list[tuple[int, int, int]]
    ends: bool


_Run = dict[int, WholeLine]
"""Lines of which each follows from those before it by its chain, numbered from the first of them."""


def standing(path: Path) -> Standing:
    """Return what stands whole in the file of a record; raises RecordError where nothing does, OSError."""
    content = path.read_bytes()
    form = form_of(content[:BLOCK])
    if form is not None and form > FORM:
        raise NewerError("A newer axiscal wrote this record (form {form})", "Install that version", path, form=form)
    marks = [mark for at in MARKS if isinstance(mark := read_mark(content[at:]), Mark)]
    runs = _runs(content)
    found = _placed(content, runs, marks)
    if not found:
        remedy = "Name a record that `axiscal step start` or `axiscal step run` has made, or restore it from a copy"
        raise RecordError("No entry of a record stands whole here", remedy, path)
    placed = {EMPTY, *(line.chain for line in found.values())}
    own = [mark for mark in marks if mark.last not in found or mark.chain == found[mark.last].chain]
    ordered = sorted(own)
    if len(ordered) == len(MARKS) and ordered[1].turn != ordered[0].turn + 1:
        ordered = [mark for mark in ordered if mark.chain in placed] or ordered
    newest = ordered[-1] if ordered else Mark()
    last = max((n for n, line in found.items() if line.row.closes or n <= newest.last), default=0)
    kept = {number: line for number, line in found.items() if number <= last}
    others = [[line for line in run.values() if line.chain not in placed] for run in runs]
    apart = [(lines[0].begin, lines[-1].end, len(lines)) for lines in others if lines]
    missing = _missing(kept, newest, len(content))
    return Standing({number: line.row for number, line in kept.items()}, missing, apart, bool(own))


def _runs(content: bytes) -> list[_Run]:
    """Return the whole lines of a file in runs; the first one is that of the beginning."""
    latest = {0: _BEGINNING}
    runs, seen = [latest], set[str]()
    for line in whole_lines(content):
        if line.chain in seen:  # a block that stands here twice
            continue
        seen.add(line.chain)
        before = next((run for run in reversed(runs) if chained(_last(run).chain, line.row) == line.chain), None)
        if before is not None:
            before[next(reversed(before)) + 1] = line
        elif _one_between(content, _last(latest), line):
            before = latest
            before[next(reversed(before)) + 2] = line
        else:
            before = {0: line}
            runs.append(before)
        latest = before
    return runs


def _last(run: _Run) -> WholeLine:
    return run[next(reversed(run))]


def _one_between(content: bytes, before: WholeLine, behind: WholeLine) -> bool:
    """Return whether one damaged line links two: by the chain that it names, or by the one that its text gives."""
    stretch = content[before.end : behind.begin]
    if chained(stretch[:64].decode(errors="replace"), behind.row) == behind.chain:
        return True
    row = damaged_row(stretch)
    return row is not None and chained(chained(before.chain, row), behind.row) == behind.chain


def _placed(content: bytes, runs: Sequence[_Run], marks: Sequence[Mark]) -> dict[int, WholeLine]:
    """Return the lines whose numbers are certain: from a mark, and from the beginning."""
    found = dict[int, WholeLine]()
    for run in runs:
        numbers = {line.chain: n for n, line in run.items()}
        named = next((mark for mark in marks if mark.chain in numbers), None)
        if named is not None:
            found |= {named.last - numbers[named.chain] + n: line for n, line in run.items()}
    if runs[0][0] not in found.values() and (not found or _may_begin(content, runs[0], found)):
        found |= runs[0]
    return {number: found[number] for number in sorted(found) if found[number] is not _BEGINNING}


def _may_begin(content: bytes, head: _Run, found: _Run) -> bool:
    """Return whether lines may be the beginning of a record whose later ones a mark names.

    A single line of text between them would link them, were it of the same record.
    """
    last, first = next(reversed(head)), min(found)
    stretch = content[head[last].end : found[first].begin]
    return last + 1 < first and not _is_line(stretch)


def _is_line(stretch: bytes) -> bool:
    try:
        text = stretch.decode()
    except UnicodeDecodeError:
        return False
    return text.removesuffix("\n").isprintable() and _WIPED not in text


def _missing(kept: dict[int, WholeLine], newest: Mark, size: int) -> list[Missing]:
    found, number, end = list[Missing](), 0, START
    for following, line in kept.items():
        if following > number + 1:
            found.append(Missing(number + 1, following - 1, end, line.begin))
        number, end = following, line.end
    if newest.last > number:
        found.append(Missing(number + 1, newest.last, end, max(size, newest.end)))
    return found


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
    said = [*missing, *left]
    more = [f"and {len(said) - _MOST} more"] if len(said) > _MOST else []
    listed = "; ".join([*said[:_MOST], *more]) or "nothing"
    note = Noted(f"salvaged from {path.name}, {len(rows)} events, numbered anew. Missing: {listed}")
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
    folding, possible = Folding(), Possible.at_start(description)
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
