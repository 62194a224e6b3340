"""The whole lines of a damaged file in their order: a merge of all runs, wherever in the file they stand.

Each line names the chain behind it, so that SHA-256 shows which line it follows. Lines that follow one another are a
strand. The chain from zero proves the strand of the beginning; a mark of the end proves the strand that it names.
Another strand is of this record where the clock of its readings names the same beginning. Without clocks it has to fit
by time where lines are missing, or to stand beside whole lines with nothing torn between them. All else may be of
another file: it is named and left out.
"""

from __future__ import annotations

import json
import math
import re
from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from itertools import islice, pairwise, product
from statistics import median
from typing import NamedTuple

from axiscal.record.line_form import EventText, Mark, WholeLine, chained, damaged_row, marks_in, whole_lines
from axiscal.record.log import EMPTY

_NEAR = 1000
"""Lines before it in time among which the one that a line follows is looked for: bounds the cost, not the result."""
_LATE = 10.0
"""Seconds from the clock of a reading to its line on the disk: twice what a writer waits for another one."""
SECTOR = 512
"""Bytes; blocks that are moved begin at a multiple of it."""
_PAIRS = 20_000
"""So many pieces are tried; bounds the cost."""
_HEAD = re.compile(rb"[0-9a-f]{1,64}|[0-9a-f]{64} .*", re.DOTALL)
_FEW = 3
"""Clocks that are believed where they agree; any other small number would do."""
_BROKEN = re.compile("[0-9a-f]{8}")
"""So begins a line; the rest of one that something else was written over does not."""
_READING = re.compile(r'"reading":(\d{1,18})\b')
_WIPED = 16 * " "
"""No line of text has so many blanks; any number of some would do, for a sector has 512 bytes."""


@dataclass(eq=False)
class Strand:
    """Lines of which each follows from the one before, by number; one that is missing between two has its number, too.

    certain : the numbers are those of events; else they count from the first line
    aside : it went on from an event of another strand, which went on as well
    """

    lines: dict[int, WholeLine]
    certain: bool = False
    aside: bool = False

    @property
    def numbers(self) -> list[int]:
        """The numbers in order."""
        return list(self.lines)

    @property
    def first(self) -> WholeLine:
        """The first line."""
        return next(iter(self.lines.values()))

    @property
    def last(self) -> WholeLine:
        """The last line."""
        return next(reversed(self.lines.values()))

    @property
    def order(self) -> tuple[str, int, int]:
        """By time, then by reading number, then by place in the file."""
        found = _READING.search(self.first.row.payload)
        return self.first.row.at, int(found[1]) if found else 0, self.first.begin


class Merged(NamedTuple):
    """What is of one record: strands in order; asides : what parted from them; apart : what may be of another record.

    newest : the mark of its end, if any can be read
    unborne : marks that no line bears out, but for one before the newest; twice : lines that stood there twice
    """

    strands: list[Strand]
    asides: list[Strand]
    apart: list[Strand]
    newest: Mark | None
    unborne: list[Mark]
    twice: int


class ForeignError(Exception):
    """Whole lines from zero on contradict the marks: one or the other is of another record."""

    def __init__(self, mark: Mark, zero: Strand) -> None:
        super().__init__(mark, zero)
        self.mark, self.zero = mark, zero


def merged(content: bytes, beginning: EventText | None = None) -> Merged:
    """Return the whole lines of a file in order.

    beginning : the first event, from a copy, where it is lost or where it decides whose lines these are
    Raises ForeignError where lines and marks are of two records and nothing decides between them.
    """
    marks, whole = marks_in(content), list(whole_lines(content))
    lines = list({line.chain: line for line in reversed([*whole, *_put_together(content, whole)])}.values())[::-1]
    twice = len(whole) - len({line.chain for line in whole})
    if beginning is not None and all(line.row.kind != beginning.kind for line in lines):
        lines.insert(0, WholeLine(0, 0, beginning, chained(EMPTY, beginning)))
    strands = [each for tree in _trees(content, lines) for each in _strands(tree, lines, marks)]
    strands.sort(key=lambda strand: strand.order)
    chains = {line.chain for line in lines}
    borne = [mark for mark in marks if mark.chain in chains]
    zero = next((each for each in strands if _begins(each.first) and not each.aside), None)
    foreign = [mark for mark in marks if zero is not None and not borne and mark.last in zero.lines]
    if zero is not None and foreign and zero.first.row != beginning:
        if beginning is None:
            raise ForeignError(foreign[-1], zero)
        return Merged([], [], strands, None, marks, twice)
    marked = [each for each in strands if each.certain and not each.aside and each is not zero]
    named = zero is not None and (not marked or (zero.first.end > 0 and zero.first.row == beginning))
    proven = [*marked, *(each for each in strands if each is zero and named)]
    evidence = _Evidence(content, strands, proven)
    ours = sorted(proven, key=lambda each: (not _begins(each.first), each.order))
    asides, apart = list[Strand](), list[Strand]()
    for strand in (each for each in strands if each not in proven):
        place = evidence.place(strand, ours, not marks or marks[-1] not in borne)
        if place is None:
            apart.append(strand)
        elif strand.aside:
            asides.append(strand)
        else:
            ours.insert(place, strand)
    numbers = {number for strand in ours if strand.certain for number in strand.lines}
    own = [mark for mark in marks if mark in borne or mark.last not in numbers]
    if any(one.turn + 1 < other.turn for one, other in pairwise(own)):
        own = [mark for mark in own if mark in borne] or own
    unborne = [mark for mark in marks if mark not in borne and (mark in own[-1:] or mark not in own)]
    return Merged(ours, asides, apart, own[-1] if own else None, unborne, twice)


def _put_together(content: bytes, whole: Sequence[WholeLine]) -> Iterator[WholeLine]:
    """Yield lines of which the two pieces stand apart, since blocks of the file were moved."""
    ends = [0, *(line.end for line in whole)], [*(line.begin for line in whole), len(content)]
    torn = [(begin, end) for begin, end in zip(*ends, strict=True) if content[begin:end].strip()]
    cuts = [(begin, at, end) for begin, end in torn for at in range(begin, end + 1) if at % SECTOR == 0 or at == end]
    before = ((at, content[begin:at].rpartition(b"\n")[2]) for begin, at, _ in cuts)
    heads = {(at - len(text), text) for at, text in before if _HEAD.fullmatch(text)}
    tails = {text for _, at, end in cuts if (text := content[at:end].partition(b"\n")[0])}
    for (begin, head), tail in islice(product(heads, tails), _PAIRS):
        for line in whole_lines(head + tail):
            yield line._replace(begin=begin, end=begin + len(head))


def _begins(line: WholeLine) -> bool:
    return chained(EMPTY, line.row) == line.chain


_Tree = dict[int, list[tuple[int, int]]]
"""Lines that follow a line, by index, each with 1, or 2 where a torn one stood between; the first key is the root."""


def _trees(content: bytes, lines: Sequence[WholeLine]) -> list[_Tree]:
    """Return which lines follow which."""
    before = dict[int, tuple[int, int]]()
    times = sorted((line.row.at, index) for index, line in enumerate(lines))
    for index, line in enumerate(lines):
        if index and chained(lines[index - 1].chain, line.row) == line.chain:
            before[index] = index - 1, 1
        elif _begins(line):
            continue
        elif (found := _followed(lines, times, index)) is not None:
            before[index] = found, 1
        elif index and _one_between(content, lines[index - 1], line):
            before[index] = index - 1, 2
    after = defaultdict[int, list[tuple[int, int]]](list)
    for index, (parent, step) in before.items():
        after[parent].append((index, step))
    trees = list[_Tree]()
    for root in range(len(lines)):
        if root not in before:
            tree, open_ = _Tree(), [root]
            while open_:
                tree[open_[-1]] = following = after[open_[-1]]
                open_[-1:] = [index for index, _ in following]
            trees.append(tree)
    return trees


def _followed(lines: Sequence[WholeLine], times: Sequence[tuple[str, int]], index: int) -> int | None:
    """Return the line that a line follows, wherever it stands; None where that is not whole."""
    line = lines[index]
    end = bisect_right(times, (line.row.at, len(lines)))
    near = (each for _, each in reversed(times[max(0, end - _NEAR) : end]))
    return next((each for each in near if chained(lines[each].chain, line.row) == line.chain), None)


def _one_between(content: bytes, before: WholeLine, behind: WholeLine) -> bool:
    """Return whether one damaged line links two: by the chain that it names, or by the one that its text gives."""
    stretch = content[before.end : behind.begin]
    if chained(stretch[:64].decode(errors="replace"), behind.row) == behind.chain:
        return True
    row = damaged_row(stretch)
    return row is not None and chained(chained(before.chain, row), behind.row) == behind.chain


def _strands(tree: _Tree, lines: Sequence[WholeLine], marks: Sequence[Mark]) -> Iterator[Strand]:
    """Yield the lines of a tree: the way to the newest mark or else the longest one, then what parted from it."""
    root, depth = next(iter(tree)), dict.fromkeys(tree, 0)
    for each, steps in tree.items():
        depth |= {child: depth[each] + step for child, step in steps}
    turns, ends = {mark.chain: mark.turn for mark in marks}, {mark.chain: mark.last for mark in marks}
    known = (ends[lines[each].chain] - depth[each] for each in tree if lines[each].chain in ends)
    number = 1 if _begins(lines[root]) else next(known, None)
    far = dict[int, tuple[int, int]]()
    for each in reversed(tree):
        turn = turns.get(lines[each].chain, 0)
        ways = [(max(turn, far[child][0]), far[child][1]) for child, _ in tree[each]]
        far[each] = max([(turn, depth[each]), *ways])
    starts, aside = [root], False
    while starts:
        following, found = [starts.pop()], dict[int, WholeLine]()
        while following:
            *others, index = sorted(following, key=far.__getitem__)
            starts += others
            found[depth[index] + (number or 1)] = lines[index]
            following = [child for child, _ in tree[index]]
        yield Strand(found, number is not None, aside)
        aside = True


class _Evidence:
    """What it takes for a strand to be of the record that others are proven to be of."""

    def __init__(self, content: bytes, strands: Sequence[Strand], proven: Sequence[Strand]) -> None:
        linked = {pair for strand in strands for pair in pairwise(strand.lines.values())}
        lines = sorted((line for strand in strands for line in strand.lines.values()), key=lambda line: line.begin)
        torn = (pair for pair in pairwise(lines) if pair not in linked and _is_torn(content, *pair))
        self._torn = {line.chain for pair in torn for line in pair}
        clocks = [clock for strand in proven for clock in _clocks(strand)]
        self._begun = median(clocks) if clocks else math.inf
        self._trusted = len(clocks) >= _FEW and self._agrees(clocks)

    def place(self, strand: Strand, ours: Sequence[Strand], open_end: bool) -> int | None:
        """Return before which of the strands of the record one belongs, None where it may be of another record.

        open_end : lines may be missing behind all of them
        """
        clocks, last = _clocks(strand), len(ours)
        place = next((n for n in range(last + 1) if _fits(strand, ours[n - 1 : n], ours[n : n + 1], open_end)), None)
        if self._agrees(clocks):
            later = (n for n, each in enumerate(ours) if each.order > strand.order)
            return next(later, last) if place is None else place
        if clocks and self._trusted:
            return None
        between = not strand.aside and place not in (None, 0, last)
        whole = between or all(line.chain not in self._torn for line in strand.lines.values())
        return None if not whole else last if strand.aside else place

    def _agrees(self, clocks: Sequence[float]) -> bool:
        """Return whether most clocks name the beginning of this record."""
        return sum(abs(clock - self._begun) <= _LATE for clock in clocks) > len(clocks) / 2


def _fits(strand: Strand, before: Sequence[Strand], behind: Sequence[Strand], open_end: bool) -> bool:
    """Return whether lines are missing between two strands, none or one each, and this one fits there by time."""
    if not behind and not open_end:
        return False
    if behind and behind[0].certain:
        least = 0 if strand.certain else 1 + (before[0].numbers[-1] if before and before[0].certain else 0)
        if behind[0].numbers[0] <= least + strand.numbers[-1] + 1:  # what follows at once would be linked
            return False
    times = [*(each.last.row.at for each in before), strand.first.row.at, strand.last.row.at]
    times += [each.first.row.at for each in behind]
    return times == sorted(times) and not (strand.certain and before)


def _clocks(strand: Strand) -> list[float]:
    """Return what the lines of a strand say of the beginning of their campaign, s since 1970."""
    found = list[float]()
    for line in strand.lines.values():
        with suppress(ValueError, TypeError, KeyError, OverflowError):
            at = datetime.fromisoformat(line.row.at).timestamp()
            if line.row.kind == "created":
                found.append(at)
            elif line.row.kind == "recorded":
                found.append(at - float(json.loads(line.row.payload)["time"]))
    return found


def _is_torn(content: bytes, before: WholeLine, behind: WholeLine) -> bool:
    """Return whether a single line of text stands between two, made of two pieces: a foreign one may begin there.

    Were both of one record, the line would link them; so would each of several.
    """
    try:
        text = content[before.end : behind.begin].decode().strip()
    except UnicodeDecodeError:
        return False
    return _BROKEN.match(text) is not None and text.isprintable() and _WIPED not in text
