"""The lines of a campaign wherever they stand, in damaged files and in copies that went on apart: their union.

Each line says its campaign, its number and the line before, so that nothing is inferred. What is missing has a number;
two lines of one number are a branch.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from typing import NamedTuple

from axiscal.record.earlier import told_anew
from axiscal.record.lines import HEAD, DamageError, Line, counts, whole_lines


class Union(NamedTuple):
    """What stands whole.

    trunk : lines by number, where two have one those of the longer way; branches : the others, run by run
    others : how many lines are of other campaigns, by id; least : so many events there were at least
    """

    trunk: Mapping[int, Line]
    branches: Sequence[Sequence[Line]]
    others: Mapping[str, int]
    least: int


_MOST = 10**7
"""Events: no record has a tenth of them, and a number beyond is nobody's."""


class SeveralError(Exception):
    """Lines of several campaigns, or of none, that a name fits.  lines : how many there are of each"""

    def __init__(self, lines: Mapping[str, int]) -> None:
        super().__init__(lines)
        self.lines = lines


def united(contents: Iterable[bytes], campaign: str = "") -> Union:
    """Return the union of the lines of files.  campaign : the first digits of its id, where there are several

    Raises SeveralError.
    """
    found, least = dict[str, Line](), 0
    for content in contents:
        whole = [place.line for place in whole_lines(content)]
        if not whole:
            content = told_anew(content)
            whole = [place.line for place in whole_lines(content)]
        with suppress(DamageError):
            least = max([least, *(each for each in counts(content[:HEAD]) if each and each <= _MOST)])
        found |= {line.hash: line for line in whole if line.hash not in found and line.number <= _MOST}
    lines = Counter(line.campaign for line in found.values())
    fitting = [each for each in lines if each.startswith(campaign)]
    if len(fitting) != 1:
        raise SeveralError(lines)
    mine = {digest: line for digest, line in found.items() if line.campaign == fitting[0]}
    trunk, branches, taken = dict[int, Line](), list[Sequence[Line]](), set[int]()
    for run in _runs(mine):
        before = run[0].number - 1  # which is lost, where it is not there
        stands = before in trunk and trunk[before] is mine.get(run[0].before)
        free = next((n for n, line in enumerate(run) if line.number in taken), len(run))
        kept = run[:free] if stands or before not in taken else []
        trunk |= {line.number: line for line in kept}
        taken |= {before, *(line.number for line in kept)} if kept else set()
        branches += [run[len(kept) :]] if len(kept) < len(run) else []
    last = max(trunk)
    while trunk[last].last > max(last, least) and last > 1:  # an entry that nobody finished
        del trunk[last]
        last = max(trunk)
    others = {each: count for each, count in lines.items() if each != fitting[0]}
    return Union(dict(sorted(trunk.items())), branches, others, least)


def _runs(lines: Mapping[str, Line]) -> list[list[Line]]:
    """Return lines that follow one another, longest first; where two follow one, the longer way goes on."""
    after, starts = defaultdict[str, list[Line]](list), list[Line]()
    for line in lines.values():
        before = lines.get(line.before)
        (starts if before is None or not line.follows(before) else after[line.before]).append(line)
    entries = Counter((line.writer, line.first, line.last) for line in lines.values())
    depth = dict[str, int]()  # in lines of entries that somebody finished
    for line in sorted(lines.values(), key=lambda each: each.number, reverse=True):
        whole = entries[line.writer, line.first, line.last] > line.last - line.first
        depth[line.hash] = whole + max((depth.get(each.hash, 0) for each in after[line.hash]), default=0)
    found = list[list[Line]]()
    while starts:
        run = [starts.pop()]
        while following := after[run[-1].hash]:
            longest = max(following, key=lambda each: depth[each.hash])
            starts += [each for each in following if each is not longest]
            run.append(longest)
        found.append(run)
    return sorted(found, key=lambda run: depth[run[0].hash], reverse=True)
