"""A new record of what stands whole in a damaged one. Nothing is guessed: what cannot be known is named.

An entry is whole if its own sum is right. Which entries are of the record, and their order: `record.merging`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

from axiscal.campaign.possible import Possible
from axiscal.document.consent import asking
from axiscal.document.quoting import shown
from axiscal.estimation.inheritance import created_description
from axiscal.exceptions import CodeError, NewerError, RecordError
from axiscal.record import events
from axiscal.record.accepted import Accepted
from axiscal.record.line_form import FORM, START, EventText, form_of, taken_for_text
from axiscal.record.log import chained_texts, rows_of, signed_by
from axiscal.record.merging import ForeignError, Merged, Strand, merged
from axiscal.record.payload import PayloadError, decode, encode, hand_of
from axiscal.record.store import Record, refuse_existing


class _Entry(NamedTuple):
    """An event of a strand: its number there, None behind what parted; from which byte on it stood."""

    strand: int
    number: int
    row: EventText
    begin: int
    certain: bool

    def __str__(self) -> str:
        where = f"event {self.number}" if self.certain else f"the line at byte {self.begin}"
        return f"{where} ({self.row.kind})"


_MOST = 20
"""So many stretches and entries are listed in the note; all are printed."""
_BEHIND_THE_END = {"finished", "noted", "bumped", "signed"}
"""Kinds of events that a campaign ends with."""


@dataclass(frozen=True, slots=True)
class Salvaged:
    """What came back.

    state : of the new record; entries : of the old one that it has
    missing, left : sentences on entries that do not stand whole, and on those that do and cannot be used
    seams : sentences on what was put back in order
    """

    state: events.State
    entries: int
    missing: tuple[str, ...]
    left: tuple[str, ...]
    seams: tuple[str, ...]


class _UnfitError(Exception):
    """A whole entry that cannot stand where others are missing: its index, and why."""

    def __init__(self, index: int, why: object) -> None:
        super().__init__(index, why)
        self.index, self.why = index, why


def salvaged(path: Path, new: Path, beginning: EventText | None = None) -> Salvaged:
    """Write a new record of what stands whole in another one, in its order; that one stays as it is.

    beginning : the first entry, in the place of one that is lost, or to say whose lines these are
    Raises RecordError, also where there is something at `new`.
    """
    refuse_existing(new)
    content = path.read_bytes()
    form = form_of(content)
    if form is not None and form > FORM:
        raise NewerError("A newer axiscal wrote this record (form {form})", "Install that version", path, form=form)
    try:
        found = merged(content, beginning)
    except ForeignError as foreign:
        raise _two_records(foreign, path) from None
    entries = _entries(found)
    if not entries:
        remedy = "Name a record that `axiscal step start` or `axiscal step run` has made, or restore it from a copy"
        raise RecordError("No entry of a record stands whole here", remedy, path)
    replaced = beginning is not None and entries[0].begin < START and entries[0].row == beginning
    if beginning is not None and (entries[0].number, entries[0].certain) != (1, True):
        entries.insert(0, _Entry(-1, 1, beginning, 0, True))
        replaced = True
    created = _created(entries, path)
    possible = None
    with suppress(CodeError), asking(None):
        possible = Possible.at_start(created_description(created))
    rows, left = _fitting(entries, possible, path)
    missing, seams = _missing_words(found, len(content), replaced), tuple(_seam_words(found, content))
    said = [*missing, *left, *seams]
    more = [f"and {len(said) - _MOST} more"] if len(said) > _MOST else []
    listed = "; ".join([*said[:_MOST], *more]) or "nothing"
    note = events.Noted(f"salvaged from {path.name}, {len(rows)} events, numbered anew. Missing: {listed}")
    with Record.made(new, [*rows, *rows_of([note])]) as record:
        return Salvaged(record.state(), len(rows), missing, left, seams)


def _two_records(foreign: ForeignError, path: Path) -> RecordError:
    """Return the refusal of marks and lines of two records, with the names of both."""
    created, number = foreign.zero.first.row, foreign.mark.last
    what = (
        "Its marks and its lines are of two records: event {number} is {mark} by the marks and {other} by the lines, "
        "which are of a campaign begun {at} with {source}"
    )
    remedy = "If the lines are wanted, name a copy of their record, however old: --beginning FILE"
    event = decode(created.kind, created.payload)
    source = event.campaign_source if isinstance(event, events.Created) else created.kind
    mark, line = foreign.mark.chain[:12], foreign.zero.lines[number].chain[:12]
    at, named = created.at[:19], shown(source)
    return RecordError(what, remedy, path, number=number, mark=mark, other=line, at=at, source=named)


def _entries(found: Merged) -> list[_Entry]:
    """Return what stands whole in order; of what parted only readings that stand, before the end."""
    entries = [
        _Entry(n, number, line.row, line.begin, strand.certain)
        for n, strand in enumerate(found.strands)
        for number, line in strand.lines.items()
    ]
    acknowledged = found.newest.last if found.newest else 0
    while entries and not entries[-1].row.closes and entries[-1].number > acknowledged:
        entries.pop()
    end = len(entries)
    while end and entries[end - 1].row.kind in _BEHIND_THE_END:
        end -= 1
    aside = [each for n, strand in enumerate(found.asides, len(found.strands)) for each in _readings(strand, n)]
    return [*entries[:end], *aside, *entries[end:]]


def _readings(strand: Strand, index: int) -> list[_Entry]:
    """Return the readings that a strand leaves standing, without numbers: others may have been given the same."""
    standing = dict[int, _Entry]()
    for number, line in strand.lines.items():
        event = decode(line.row.kind, line.row.payload)
        if isinstance(event, events.Recorded):
            free = events.Recorded(replace(event.reading, number=None))
            row = line.row._replace(payload=encode(free, hand_of(line.row.payload))[1])
            standing[number] = _Entry(index, number, row, line.begin, False)
        elif isinstance(event, events.Undone):
            standing.pop(event.event, None)
    return list(standing.values())


def _created(entries: Sequence[_Entry], path: Path) -> events.Created:
    """Return the beginning of the campaign; raises RecordError."""
    created = decode(entries[0].row.kind, entries[0].row.payload)
    if isinstance(created, events.Created):
        return created
    kept = sum(each.row.kind == "recorded" for each in entries)
    what = "Event 1, with the descriptions, does not stand whole, or may be of another file; {kept} readings stand"
    remedy = "Name a copy of the record, however old, or its campaign.toml: --beginning FILE"
    raise RecordError(what, remedy, path, kept=kept)


def _fitting(
    entries: Sequence[_Entry], possible: Possible | None, path: Path
) -> tuple[list[EventText], tuple[str, ...]]:
    """Return the entries that can follow each other, and why others cannot.

    possible : on its machine, None where only code of somebody's could tell
    """
    left = dict[int, str]()
    while True:
        try:
            rows = _following([(n, each) for n, each in enumerate(entries) if n not in left], possible, path)
        except _UnfitError as unfit:
            left[unfit.index] = f"{entries[unfit.index]}: {unfit.why}"
        else:
            return rows, tuple(left[index] for index in sorted(left))


def _following(entries: Sequence[tuple[int, _Entry]], possible: Possible | None, path: Path) -> list[EventText]:
    """Return entries with the numbers that they have now; raises _UnfitError."""
    folding = events.Folding()
    rows, places, numbers = list[EventText](), list[int](), dict[tuple[int, int], int]()
    began = {entry.strand: 0 for _, entry in entries if entry.certain}
    for index, entry in entries:
        row, event = entry.row, _event(index, entry)
        if isinstance(event, events.Newer) and event.of_readings:
            what = "Event {number} is an entry of a newer version: {kind}"
            raise NewerError(what, "Salvage it with that one", path, number=entry.number, kind=event.kind)
        if isinstance(event, events.Undone):
            last = folding.undo[-1].number if folding.undo else 0
            event = events.Undone(_number_now(entry, event.event, last, numbers, began))
            if not event.event:
                raise _UnfitError(index, "what it takes back is missing")
            row = row._replace(payload=encode(event, hand_of(row.payload))[1])
        unmoved = entry.certain and entry.number == len(rows) + 1
        if isinstance(event, Accepted) and not unmoved:
            raise _UnfitError(index, "what it puts right may be missing; accept it anew")
        if isinstance(event, events.Signed) and not (unmoved and signed_by(row, event, chained_texts(rows))[1]):
            raise _UnfitError(index, "it answers for what is missing, or was changed; sign anew")
        if possible is not None and (fault := possible.fault(event)):
            raise _UnfitError(index, fault)
        try:
            folding.add(events.Stored(len(rows) + 1, row.at, event))
        except events.EventOrderError as fault:
            raise _taken_back(event, folding.state(), places) or _UnfitError(index, fault) from None
        possible = None if possible is None else possible.after(event)
        rows.append(row)
        places.append(index)
        numbers[entry.strand, entry.number] = len(rows)
    return rows


def _number_now(entry: _Entry, named: int, last: int, now: Mapping[tuple[int, int], int], began: dict[int, int]) -> int:
    """Return the number that an entry has now which another one takes back, 0 where it is missing.

    named : what it is called there; last : what can be taken back now
    now : numbers by strand and by number in it; began : by strand, what numbers of events there are larger by
    Where that is not known, the first entry that takes something back of its strand shows it: it names what came last.
    """
    mine = {new: number for (strand, number), new in now.items() if strand == entry.strand}
    if last in mine:
        began.setdefault(entry.strand, named - mine[last])
    strands = sorted(began, key=lambda strand: strand != entry.strand)
    return next((n for s in strands if (n := now.get((s, named - began[s]), 0))), 0)


def _event(index: int, entry: _Entry) -> events.Event:
    try:
        return decode(entry.row.kind, entry.row.payload)
    except PayloadError as error:
        raise _UnfitError(index, error) from None


def _taken_back(event: events.Event, state: events.State, places: Sequence[int]) -> _UnfitError | None:
    """Return the entry that must have been taken back for this one to follow, by an entry that is missing."""
    step = state.undo[-1].number if state.undo else 0
    if not step or (state.finished is None and not (isinstance(event, events.Undone) and event.event < step)):
        return None
    return _UnfitError(places[step - 1], "what follows shows that it was taken back")


def _missing_words(found: Merged, size: int, replaced: bool) -> tuple[str, ...]:
    words, number, end, between = list[str](), 0, START, list[Strand]()

    def gap(following: int, begin: int) -> str:
        which = f"event {number + 1}" if following == number + 2 else f"events {number + 1} to {following - 1}"
        where = f" (bytes {end} to {begin})" if begin >= end else ""
        here = sum(len(strand.lines) for strand in between)
        return f"{which}{where}" + (f", but for {here} whole lines that belong there by their times" if here else "")

    for strand in found.strands:
        if not strand.certain:
            between.append(strand)
            continue
        for following, line in strand.lines.items():
            if following > number + 1:
                words.append(gap(following, line.begin))
                between = []
            number, end = following, line.end
    newest = found.newest
    if newest is not None and newest.last > number:
        words.append(gap(newest.last + 1, max(size, newest.end)))
    elif between:
        words.append(f"unknown events behind event {number}, before whole lines that belong there by their times")
    if replaced:
        words.append("event 1, which is that of another file")
    for strand in found.apart:
        reach = f"{len(strand.lines)} whole lines (bytes {strand.first.begin} to {strand.last.end})"
        words.append(f"{reach} may be of another file: no chain leads to them")
    unborne = ((mark.last, mark.chain[:12]) for mark in found.unborne)
    words += [f"event {last} as a mark names it, {chain}: no line bears that out" for last, chain in unborne]
    if newest is None:
        words.append("both marks of its end: events behind the last one may be missing, too")
    return tuple(words)


def _seam_words(found: Merged, content: bytes) -> Iterator[str]:
    """Yield what was put back in order."""
    lines = [line for strand in found.strands for line in strand.lines.values()]
    moved = [other.begin for one, other in pairwise(lines) if other.begin < one.begin]
    if moved:
        yield f"lines stood in another order, first at byte {moved[0]}"
    if found.twice:
        yield f"{found.twice} lines stood there twice"
    if taken_for_text(content):
        yield "line ends or blanks were changed, as where a program takes a file for text"
    for strand in found.asides:
        where, count = min(strand.lines), len(strand.lines)
        yield f"two went on from event {where - 1}: the readings of {count} lines (byte {strand.first.begin}) come last"
