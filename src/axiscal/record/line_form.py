"""The file of a record: a head that says what it is, two marks of how far it is valid, and one line for each event.

    line = chain at kind payload end crc      chain_n = SHA-256(chain_{n-1} kind payload); end "." closes a transaction
    mark = turn last end chain crc            of the transaction `turn`: its last event, where it ends, its chain

A transaction is written in two steps, each on the disk before the next. Its lines come behind the end; then the older
of the two marks is written anew. So lines before the newest mark were acknowledged and must be whole. Whole lines that
follow it count as well: the marks may be of an older copy. What is cut off there is one transaction nobody finished.
The chain is of contents only, not of times of writing: the same events have the same name. The sum `crc` guards all.
"""

from __future__ import annotations

import contextlib
import hashlib
import re
import zlib
from collections import defaultdict
from collections.abc import Iterable, Iterator
from typing import Literal, NamedTuple

BLOCK = 4096
"""Bytes; a disk that tears a write tears it inside of one block, so head and marks have one each."""
MARKS = (BLOCK, 2 * BLOCK)
"""Where they stand: a block for each behind that of the head."""
START = 3 * BLOCK
"""Where the lines begin."""
FORM = 3
"""This one. In the second the head had no guard; all else is the same, and such records go on as they are."""
MARK = 160
"""Bytes of a mark: some 130 with the largest numbers there will be."""
MOST_TORN = 1 << 26
"""Bytes that are looked at behind the marks: the largest transaction has a tenth."""
_SUM = 8
"""Hex digits of a CRC-32."""
_ENDS = re.compile(rb" (?:(?=\d{4}-)(?<=[0-9a-f]{64} )|[.,]([0-9a-f]{8})[ \t]*(?:[\r\n]+|(?=\0|\Z|[0-9a-f]{64} )))")
"""Behind the chain at the beginning of a line, or with the sum at its end."""
_CLOSED = re.compile(rb" \.[0-9a-f]{8}\s")
_BEGUN = 4
"""Beginnings that an end may belong to: a note may hold what looks like one."""
_MARK = re.compile(rb"mark \d{1,18} \d{1,18} \d{1,18} [0-9a-f]{64} [0-9a-f]{8}")
_GUARD = b"\x89\r\n\x1a\n\0\n"
"""Against text mode, as PNG has it: what changes line ends changes this, and a NUL tells editors that it is no text."""
_HEAD = re.compile(rb"(axiscal record (\d{1,9})) ([0-9a-f]{8})\r?\n")
_WORDS = """
The record of one calibration: what happened, event by event, oldest first; only ever added to.
One line for each event from byte 12288 on: chain, time (UTC), kind, what happened (JSON), "." and a sum (CRC-32).
chain: SHA-256 of the chain of the line before, kind and JSON, with a space between; the first follows sixty-four zeros.
Bytes 4096 and 8192 hold marks: turn, number of the last event, length of the valid file in bytes, its chain, a sum.
The newer mark holds. Lengths are in metres, angles in radians, times in seconds.
"""


class DamageError(ValueError):
    """Bytes that nobody has written as they are."""


class Mark(NamedTuple):
    """How far a record is valid.

    turn : number of transactions; last : number of the last event; end : bytes; chain : its name, 64 hex digits
    """

    turn: int = 0
    last: int = 0
    end: int = START
    chain: str = 64 * "0"


class EventText(NamedTuple):
    """One event as text: when it was written, its kind and JSON text; closes : it ends a transaction."""

    at: str
    kind: str
    payload: str
    closes: bool = True


def _sum(text: bytes) -> bytes:
    return b"%08x" % zlib.crc32(text)


def head(form: int = FORM) -> bytes:
    """Return the first block of a record; of an earlier form, too."""
    title = b"axiscal record %d" % form
    guard = _GUARD if form == FORM else b""
    return (title + b" " + _sum(title) + b"\n" + guard + _WORDS.encode()).ljust(BLOCK - 1) + b"\n"


HEADS = tuple(head(form) for form in (2, FORM))
"""The heads of records that can be written to."""


def form_of(start: bytes) -> int | None:
    """Return the form that the first bytes of a file name, None if they name none."""
    found = _HEAD.match(start)
    return int(found[2]) if found and _sum(found[1]) == found[3] else None


def taken_for_text(start: bytes) -> bool:
    """Return whether line ends or blanks of a head were changed, as by an editor or a transfer in text mode."""
    found = _HEAD.match(start)
    guarded = found is None or int(found[2]) < FORM or start[found.end() :].startswith(_GUARD)
    return found is not None and (found[0].endswith(b"\r\n") or not guarded or 16 * b" " not in start[:BLOCK])


def mark_bytes(mark: Mark) -> bytes:
    """Return a mark as it stands in the file."""
    text = b"mark %d %d %d %s " % (mark.turn, mark.last, mark.end, mark.chain.encode())
    return (text + _sum(text)).ljust(MARK - 1) + b"\n"


def read_mark(block: bytes) -> Mark | Literal["none yet"] | None:
    """Return the mark at the beginning of a block; None if it cannot be read."""
    text = block[:MARK]
    if not text.strip():
        return "none yet"
    try:
        word, turn, last, end, chain, _ = text.split()
        mark = Mark(int(turn), int(last), int(end), chain.decode())
    except ValueError:
        return None
    return mark if word == b"mark" and mark_bytes(mark) == text else None


def chained(chain: str, row: EventText) -> str:
    """Return the name of what a record holds after one more event."""
    return hashlib.sha256(f"{chain} {row.kind} {row.payload}".encode()).hexdigest()


def transaction(mark: Mark, rows: Iterable[EventText]) -> tuple[bytes, Mark]:
    """Return the lines of events that follow a mark, and the mark behind them."""
    lines, chain = list[bytes](), mark.chain
    for row in rows:
        chain = chained(chain, row)
        text = f"{chain} {row.at} {row.kind} {row.payload} {'.' if row.closes else ','}".encode()
        lines.append(text + _sum(text) + b"\n")
    content = b"".join(lines)
    return content, Mark(mark.turn + 1, mark.last + len(lines), mark.end + len(content), chain)


def rows_after(mark: Mark, content: bytes) -> Iterator[tuple[EventText, Mark]]:
    """Yield the events of lines that follow a mark, each with the mark behind it; raises DamageError at the first."""
    turn, last, end, chain = mark.turn, mark.last, mark.end, mark.chain
    *lines, rest = content.split(b"\n")
    for line in [line + b"\n" for line in lines] + ([rest] if rest else []):
        last, end = last + 1, end + len(line)
        row, written = _row(line, last)
        turn, chain = turn + row.closes, chained(chain, row)
        if chain != written:
            raise DamageError(f"event {last} does not follow from the events before it")
        yield row, Mark(turn, last, end, chain)


def whole_after(mark: Mark, content: bytes) -> list[tuple[EventText, Mark]]:
    """Return the events of as many transactions as follow a mark whole; what breaks off behind them is left out."""
    found, whole = list[tuple[EventText, Mark]](), 0
    try:
        for row, behind in rows_after(mark, content):
            found.append((row, behind))
            whole = len(found) if row.closes else whole
    except DamageError:
        pass
    return found[:whole]


class WholeLine(NamedTuple):
    """A line that stands whole in a damaged file: from which byte to which, its event, the chain that it names."""

    begin: int
    end: int
    row: EventText
    chain: str


def whole_lines(content: bytes) -> Iterator[WholeLine]:
    """Yield every line of a file that is as it was written, wherever it stands and whatever ends it; linear in bytes.

    Where a line seems to end, its sum decides with which of the last beginnings before it.
    """
    begun = list[list[int]]()
    for found in _ENDS.finditer(content):
        if found[1] is None:
            begun = [*begun[1 - _BEGUN :], [found.start() - 64, found.start() - 64, 0]]
            continue
        for each in reversed(begun):
            each[1:] = found.start(1), zlib.crc32(content[each[1] : found.start(1)], each[2])
            if b"%08x" % each[2] == found[1]:
                with contextlib.suppress(DamageError):
                    row, chain = _row(content[each[0] : found.end(1)] + b"\n", 0)
                    yield WholeLine(each[0], found.end(), row, chain)
                    begun = []
                    break


def is_torn(mark: Mark, content: bytes) -> bool:
    """Return whether what follows a mark is no more than one transaction that nobody has finished writing."""
    closed = _CLOSED.search(content)
    lines = list(whole_lines(content))
    follows = not lines or lines[0].begin > 0 or chained(mark.chain, lines[0].row) == lines[0].chain
    return follows and (closed is None or all(line.begin < closed.end() for line in lines))


def marks_in(content: bytes) -> list[Mark]:
    """Return every mark of a file that is as it was written, wherever it stands; the last ones stand where they are to.

    Each of these two groups is in order.
    """
    places = defaultdict[Mark, set[int]](set)
    for found in _MARK.finditer(content):
        if isinstance(mark := read_mark(found[0].ljust(MARK - 1) + b"\n"), Mark):
            places[mark].add(found.start())
    return sorted(places, key=lambda mark: (not places[mark].isdisjoint(MARKS), mark))


def damaged_row(line: bytes) -> EventText | None:
    """Return the event that a damaged line seems to hold, None where it seems to hold none."""
    try:
        at, kind, payload = line[65 : -_SUM - 3].decode().split(" ", 2)
    except ValueError:
        return None
    return EventText(at, kind, payload)


def _row(line: bytes, number: int) -> tuple[EventText, str]:
    text, check = line[: -_SUM - 1], line[-_SUM - 1 :]
    if check != _sum(text) + b"\n" or text[-2:] not in (b" .", b" ,"):
        raise DamageError(f"event {number} is not as it was written")
    try:
        chain, at, kind, payload = text[:-2].decode().split(" ", 3)
    except ValueError:
        raise DamageError(f"event {number} is not as it was written") from None
    return EventText(at, kind, payload, text[-1:] == b"."), chain
