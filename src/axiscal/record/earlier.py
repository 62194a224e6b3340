"""Records of the forms 2 and 3, told in form 4. The same file always gives the same bytes.

line = chain at kind payload end crc      chain_n = SHA-256(chain_{n-1} kind payload); end "." closes an entry
mark = turn last end chain crc            at bytes 4096 and 8192; its last event is a lower bound
"""

from __future__ import annotations

import hashlib
import re
import zlib
from collections.abc import Iterator
from typing import NamedTuple

from axiscal.record.lines import EMPTY, HEAD, EventText, KeptLine, chained, entry, head

_MARK = re.compile(rb"(mark \d{1,18} (\d{1,18}) \d{1,18} [0-9a-f]{64} )([0-9a-f]{8}) *\n")
_LINE = re.compile(
    rb"(?<![^\r\n\0])([0-9a-f]{64}) ([^\s\0]+) ([^\s\0]+) ([^\r\n\0]*) ([.,])([0-9a-f]{8})(?=[ \t]*(?:[\r\n\0]|\Z))"
)
UNPROVEN = "0"
"""Who wrote a line of which nothing shows that it is of this record."""
_NEAR = 100
"""Runs of lines among which the one that a line follows is looked for: bounds the cost."""


class _Old(NamedTuple):
    chain: str
    row: EventText
    closes: bool


def told_anew(content: bytes) -> bytes:
    """Return a record of form 2 or 3 as a file of form 4, with an id that follows from its first event.

    A line that follows none from the first one on does not say whose it is: its writer is `UNPROVEN`.
    """
    runs = list[list[_Old]]()
    for old in _whole(content):
        ends = (run for run in reversed(runs[-_NEAR:]) if chained(run[-1].chain, old.row) == old.chain)
        if (run := next(ends, None)) is not None:
            run.append(old)
        else:
            runs.append([old])
    campaign, number, found = 32 * "0", 0, list[KeptLine]()
    for run in runs:
        first = run[0]
        begins = chained(EMPTY, first.row) == first.chain
        if begins:
            campaign, number = hashlib.sha256(f"{first.row.at} {first.chain}".encode()).hexdigest()[:32], 0
            found += _told(run, campaign, "", number, EMPTY)
        else:
            found += _told(run, campaign, UNPROVEN, number + 1, first.chain)
        number = found[-1].number
    marks = (mark for at in (HEAD, 2 * HEAD) if (mark := _MARK.match(content, at)))
    lasts = [int(mark[2]) for mark in marks if b"%08x" % zlib.crc32(mark[1]) == mark[3]]
    return head(max(lasts, default=None)) + b"".join(line.written() for line in found)


def _told(run: list[_Old], campaign: str, writer: str, number: int, before: str) -> list[KeptLine]:
    found, waiting = list[KeptLine](), list[EventText]()
    for old in run:
        waiting.append(old.row)
        if old.closes:
            found += entry(waiting, campaign, writer, number, before)
            number, before, waiting = number + len(waiting), found[-1].hash, []
    cut = entry([*waiting, EventText("", "", "")], campaign, writer, number, before)[:-1] if waiting else []
    return [*found, *cut]


def _whole(content: bytes) -> Iterator[_Old]:
    seen = set[bytes]()
    for found in _LINE.finditer(content):
        if b"%08x" % zlib.crc32(content[found.start() : found.start(6)]) != found[6] or found[1] in seen:
            continue
        try:
            chain, at, kind, payload = (part.decode() for part in found.groups()[:4])
        except UnicodeDecodeError:
            continue
        seen.add(found[1])
        yield _Old(chain, EventText(at, kind, payload), found[5] == b".")
