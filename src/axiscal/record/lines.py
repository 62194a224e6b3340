"""The lines of a record, form 4: each proves itself and says what it belongs to, so nothing has to be inferred.

    line = SHA-256 of text, text
    text = {"a": hash of the line before, "b": id of the campaign, "e": numbers of the first and last line of its entry,
            "n": number from 1, "t": time, "w": id of the opening that wrote it, "k": kind, "p": what happened}

The head holds twice how many events there are *at least*; the copy with the lower count is renewed after each entry.
Fewer whole lines are damage, more are news. An entry is one append of whole lines, and one wait for the disk.
"""

from __future__ import annotations

import hashlib
import re
import zlib
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

FORM, HEAD = 4, 4096
"""This one; bytes before the first line: a disk that tears a write tears it inside of one such block."""
SECTOR, SLOT = 512, 64  # bytes of the smallest that a lost power may tear, and of a count
SLOTS = (0, SECTOR)
"""Where the two counts stand: in a sector each."""
_EARLIER = {
    "7b5accdb80a4adc94a0a792ee6083d19e65549ece675b4221b0f7d9665466b0d",
    "b20106745e56ca5cf5a47cfa3970f37a6ac2fe6cbf4853adb497f1fdea4b3ecf",
}
"""SHA-256 of the first block of form 2 and of form 3: what it says is the same in every record."""
EMPTY = 64 * "0"  # what the first line and the chain of contents follow
_COUNT = re.compile(rb"(axiscal record 4 of at least (\d{12}) events) ([0-9a-f]{8}) *\n")
_BEGINS, _END = re.compile(rb' \{"a":"'), re.compile(rb"[\r\n\0]")
_TEXT = re.compile(
    r'\{"a":"([0-9a-f]{64})","b":"([0-9a-f]{32})","e":\[([0-9]{1,18}),([0-9]{1,18})\],"n":([0-9]{1,18}),"t":"([^"\\]*)",'
    r'"w":"([0-9a-f]*)","k":"([^"\\]*)","p":(.*)\}'
)
_WORDS = """
The record of one calibration: what happened, event by event, oldest first; only ever added to.
One line for each event from byte 4096 on: a hash, a space, and JSON. The hash is SHA-256 of that JSON.
a: hash of the line before; b: the campaign; n: number; e: the first and the last event that were written with it;
t: time (UTC); w: the opening that wrote it; k: kind; p: what happened.
The counts at bytes 0 and 512 are lower bounds; the larger one holds.
Lengths are in metres, angles in radians, times in seconds.
"""


class DamageError(ValueError):
    """Bytes that nobody has written as they are."""


class EventText(NamedTuple):
    """One event as text: when it was written, its kind and JSON text."""

    at: str
    kind: str
    payload: str


class KeptLine(NamedTuple):
    """A line that is as it was written; first, last : numbers of those of its entry."""

    hash: str
    before: str
    campaign: str
    first: int
    last: int
    number: int
    writer: str
    row: EventText

    def follows(self, before: KeptLine | None) -> bool:
        """Return whether it is the next line behind another one, None for the first of all."""
        if before is None:
            return (self.number, self.before) == (1, EMPTY)
        return self.before == before.hash and self.number == before.number + 1 and self.campaign == before.campaign

    def written(self) -> bytes:
        """Return it as it stands in the file."""
        return line_bytes(self)[1]


def line_bytes(line: KeptLine) -> tuple[str, bytes]:
    """Return the hash and the bytes of a line, whatever hash it has."""
    at, kind, payload = line.row
    text = (
        f'{{"a":"{line.before}","b":"{line.campaign}","e":[{line.first},{line.last}],"n":{line.number},"t":"{at}",'
        f'"w":"{line.writer}","k":"{kind}","p":{payload}}}'
    ).encode()
    digest = hashlib.sha256(text).hexdigest()
    return digest, digest.encode() + b" " + text + b"\n"


def entry(
    rows: Sequence[EventText], campaign: str, writer: str, number: int = 0, before: str = EMPTY
) -> list[KeptLine]:
    """Return the lines of one entry behind the line `number` with the hash `before`."""
    found = list[KeptLine]()
    for n, row in enumerate(rows, number + 1):
        line = KeptLine("", before, campaign, number + 1, number + len(rows), n, writer, row)
        found.append(line._replace(hash=line_bytes(line)[0]))
        before = found[-1].hash
    return found


def whole_lines(content: bytes) -> Iterator[tuple[KeptLine, int]]:
    """Yield every line that is as it was written, wherever it stands, and where it ends; linear in bytes."""
    begins = [found.start() - 64 for found in _BEGINS.finditer(content, 64)]
    done, stop = 0, 0
    for begin, following in pairwise([*begins, len(content)]):
        if begin < done:
            continue
        ends = [min(following, stop)]
        if begin >= stop:  # a line of its own, whatever stands in it
            stop = found.start() if (found := _END.search(content, begin)) else len(content)
            ends = [stop, following] if following < stop else [stop]
        for last in ends:
            end = content.rfind(b"}", begin, last) + 1
            if (line := _line(content[begin:end])) is not None:
                yield line, end
                done = end
                break


def _line(text: bytes) -> KeptLine | None:
    said = text[65:]
    digest = hashlib.sha256(said).hexdigest()
    if text[:65] != digest.encode() + b" ":
        return None
    try:
        found = _TEXT.fullmatch(said.decode())
    except UnicodeDecodeError:
        return None
    if found is None:
        return None
    before, campaign, first, last, number, at, writer, kind, payload = found.groups()
    row = EventText(at, kind, payload)
    return KeptLine(digest, before, campaign, int(first), int(last), int(number), writer, row)


def chained(chain: str, row: EventText) -> str:
    """Return the name of what a record holds after one more event: of contents only, not of times of writing."""
    return hashlib.sha256(f"{chain} {row.kind} {row.payload}".encode()).hexdigest()


def count_bytes(least: int | None) -> bytes:
    """Return a count as it stands in the head; None : one that nobody can read."""
    text = b"axiscal record 4 of at least %012d events" % (least or 0)
    return (text + b" %08x" % zlib.crc32(text) if least is not None else b"").ljust(SLOT - 1) + b"\n"


def head(least: int | None) -> bytes:
    """Return the first block of a record of at least so many events."""
    return 2 * count_bytes(least).ljust(SECTOR) + (_WORDS.encode()).ljust(HEAD - 1 - 2 * SECTOR) + b"\n"


def counts(block: bytes) -> tuple[int | None, int | None]:
    """Return the two counts of a head, None for one that cannot be read; raises DamageError for another head."""
    if block[2 * SECTOR :] != head(None)[2 * SECTOR :]:
        raise DamageError("its first lines are not as they were written")
    found = (_COUNT.match(block, at) for at in SLOTS)
    one, two = (int(each[2]) if each and b"%08x" % zlib.crc32(each[1]) == each[3] else None for each in found)
    return one, two


def is_earlier(start: bytes) -> bool:
    """Return whether the first block of a file is that of an earlier form, as it was written."""
    return hashlib.sha256(start[:HEAD]).hexdigest() in _EARLIER
