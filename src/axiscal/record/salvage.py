"""The whole entries of a damaged record, and the missing ones.

An entry is whole if its own sum is right and its place is certain. A chain of SHA-256 must lead to it from the
beginning of the record, or from it to a mark of the end. Its number follows. Whole lines between two damages whose
place no chain shows may be those of another file, so they are named and left out.
"""

from __future__ import annotations

from collections.abc import Container, Sequence
from pathlib import Path
from typing import NamedTuple

from axiscal.exceptions import NewerError, RecordError
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
from axiscal.record.log import EMPTY

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
    newest = _newest(own, placed)
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
        before = next((run for run in reversed(runs) if _follows(_last(run), line)), None)
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


def _follows(before: WholeLine, line: WholeLine) -> bool:
    return chained(before.chain, line.row) == line.chain


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


def _newest(marks: Sequence[Mark], chains: Container[str]) -> Mark:
    """Return the newest mark; of two that do not follow each other one is foreign, and one that names a line is not."""
    ordered = sorted(marks)
    if len(ordered) == len(MARKS) and ordered[1].turn != ordered[0].turn + 1:
        ordered = [mark for mark in ordered if mark.chain in chains] or ordered
    return ordered[-1] if ordered else Mark()


def _missing(kept: dict[int, WholeLine], newest: Mark, size: int) -> list[Missing]:
    found, number, end = list[Missing](), 0, START
    for following, line in kept.items():
        if following > number + 1:
            found.append(Missing(number + 1, following - 1, end, line.begin))
        number, end = following, line.end
    if newest.last > number:
        found.append(Missing(number + 1, newest.last, end, max(size, newest.end)))
    return found
