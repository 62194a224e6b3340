"""The whole lines of a damaged file in their order: a merge of all runs, wherever in the file they stand.

Each line names the chain behind it, so that SHA-256 shows which line it follows. Lines that follow one another are a
strand. The newest mark of the end proves the strand that it names, else the chain from zero that of the beginning.
Another strand is of this record where the clock of its readings names the same beginning, or where it parted from a
strand of this record. All else may be of another campaign, begun from the same file: it is named and left out.
"""

from __future__ import annotations

import json
import re
from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from itertools import pairwise
from statistics import median
from typing import NamedTuple

from axiscal.record.line_form import EventText, Mark, WholeLine, chained, damaged_row, marks_in, whole_lines
from axiscal.record.log import EMPTY

_NEAR = 100
"""Lines before it in time among which the one that a line follows is looked for: bounds the cost, not the result."""
_LATE = 0.05
"""Seconds from the clock of a reading to the time of its line: both are looked at in one call, and kept to 1 ms."""
_ALIKE = {"created", "planned", "asked", "continued"}
"""Kinds of events that another campaign begun from the same file may have had, too."""
_READING = re.compile(r'"reading":(\d{1,18})\b')


@dataclass(eq=False)
class Strand:
    """Lines of which each follows from the one before, by number; one that is missing between two has its number, too.

    certain : the numbers are those of events; else they count from the first line
    aside : it went on from an event of another strand, which went on as well
    parted : that strand, where no other campaign can have had that event
    """

    lines: dict[int, WholeLine]
    certain: bool = False
    aside: bool = False
    parted: Strand | None = None

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
    def silent(self) -> bool:
        """Whether it holds no reading and does not say when the campaign began."""
        return all(line.row.kind not in ("created", "recorded") for line in self.lines.values())

    def leaves_room(self, other: Strand) -> bool:
        """Return whether another one has none of its numbers, nor the next ones, which would be linked."""
        numbers = self.numbers
        return not {numbers[0] - 1, *numbers, numbers[-1] + 1} & other.lines.keys()

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
    lines = list({line.chain: line for line in reversed(whole)}.values())[::-1]
    twice = len(whole) - len(lines)
    if beginning is not None and all(line.row.kind != beginning.kind for line in lines):
        lines.insert(0, WholeLine(0, 0, beginning, chained(EMPTY, beginning)))
    strands = [each for tree in _trees(content, lines) for each in _strands(tree, lines, marks)]
    strands.sort(key=lambda strand: strand.order)
    bearing = {line.chain: strand for strand in strands for line in strand.lines.values()}
    borne = [mark for mark in marks if mark.chain in bearing]
    zero = next((each for each in strands if _begins(each.first) and not each.aside), None)
    foreign = [mark for mark in marks if zero is not None and not borne and mark.last in zero.lines]
    if zero is not None and foreign and zero.first.row != beginning:
        if beginning is None:
            raise ForeignError(foreign[-1], zero)
        return Merged([], [], strands, None, marks, twice)
    named = zero is not None and zero.first.end > 0 and zero.first.row == beginning
    marked = bearing[borne[-1].chain] if borne else None
    proven = marked
    if zero is not None and (
        marked is None or named or (zero.first.end and marked.silent and marked.leaves_room(zero))
    ):
        proven = zero
    found = _of_one(proven, strands, zero)
    asides, apart = [each for each in found if each.aside], [each for each in strands if each not in found]
    ours = sorted((each for each in found if not each.aside), key=lambda each: (not _begins(each.first), each.order))
    numbers = {number for strand in ours if strand.certain for number in strand.lines}
    own = [mark for mark in marks if mark in borne or mark.last not in numbers]
    if any(one.turn + 1 < other.turn for one, other in pairwise(own)):
        own = [mark for mark in own if mark in borne] or own
    unborne = [mark for mark in marks if mark not in borne and (mark in own[-1:] or mark not in own)]
    return Merged(ours, asides, apart, own[-1] if own else None, unborne, twice)


def _of_one(proven: Strand | None, strands: Sequence[Strand], zero: Strand | None) -> dict[Strand, None]:
    """Return the strands of the record that one is proven to be of; where nothing tells it, a strand is not.

    Campaigns that begin from one file begin with equal events. Their clocks tell them apart, or an event in common that
    only one can have. What holds no reading comes by its numbers where they leave room. Where a person names the
    beginning and nothing else is proven, the longest strand is taken to have it.
    """
    ours = dict.fromkeys(each for each in strands if each is proven)
    others = [each for each in strands if each is not proven]
    begun = _begun(*ours)
    if (
        zero is not None
        and not zero.first.end
        and not any(_is_near(each, begun) for each in others if each is not zero)
    ):
        begun = begun if any(each.numbers[1:] for each in ours) else _begun(max(strands, key=lambda x: len(x.lines)))
    for strand in sorted(others, key=lambda each: (each.aside, each is not zero)):
        fits = strand.certain and not strand.aside and strand.silent and all(map(strand.leaves_room, ours))
        if strand.parted in ours or _is_near(strand, begun) or fits:
            ours[strand] = None
    return ours


def _begun(*strands: Strand) -> float | None:
    """Return when a campaign began by the clocks of its lines, s since 1970; None where they have none."""
    clocks = [clock for strand in strands for clock in _clocks(strand)]
    return median(clocks) if clocks else None


def _is_near(strand: Strand, begun: float | None) -> bool:
    """Return whether most clocks of a strand name this beginning."""
    clocks = _clocks(strand)
    return begun is not None and sum(abs(clock - begun) <= _LATE for clock in clocks) > len(clocks) / 2


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
    ranks, ends = {mark.chain: n for n, mark in enumerate(marks, 1)}, {mark.chain: mark.last for mark in marks}
    known = (ends[lines[each].chain] - depth[each] for each in tree if lines[each].chain in ends)
    number = 1 if _begins(lines[root]) else next(known, None)
    far = dict[int, tuple[int, int]]()
    for each in reversed(tree):
        rank = ranks.get(lines[each].chain, 0)
        ways = [(max(rank, far[child][0]), far[child][1]) for child, _ in tree[each]]
        far[each] = max([(rank, depth[each]), *ways])
    starts, main = [(root, False)], None
    while starts:
        start, unlike = starts.pop()
        following, found, shared = [start], dict[int, WholeLine](), unlike
        while following:
            *others, index = sorted(following, key=far.__getitem__)
            starts += [(other, unlike) for other in others]
            found[depth[index] + (number or 1)] = lines[index]
            following, unlike = [child for child, _ in tree[index]], unlike or lines[index].row.kind not in _ALIKE
        strand = Strand(found, number is not None, main is not None, main if shared else None)
        main = main or strand
        yield strand


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
