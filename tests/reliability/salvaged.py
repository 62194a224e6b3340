"""Damaged records, and what `axiscal salvage` makes of them: rows of `make reliability`.

The oracle knows the original: a reading stands whole where its line is in the file, wherever, with any blanks behind.
"""

from __future__ import annotations

import json
import random
import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from datetime import UTC, datetime, timedelta
from functools import cache, partial
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

from axiscal.campaign.possible import beginning_of
from axiscal.campaign.salvaging import salvaged
from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.exceptions import RecordError
from axiscal.measurement.instrument import values_of
from axiscal.measurement.reading import Place, Reading
from axiscal.present.demo import description
from axiscal.record.events import Asked, Event, Finished, Noted, Planned, Recorded, Skipped, Undone
from axiscal.record.line_form import BLOCK, MARK, MARKS, START, EventText, Mark, head, mark_bytes, transaction
from axiscal.record.payload import encode
from axiscal.record.signing import Hand
from axiscal.record.store import Record
from tests.generators.texts import campaign_text, machine_text, setup_text
from tests.reliability.trial import Trial, scratch

SECTOR = 512
MACHINE = machine_text("w-X'-b-t", {"X": (0, 300)}, {"EXX": "20 um"})
CAMPAIGN = campaign_text(
    "machine.toml",
    setup_text("along x", "interferometer", direction="x", moves=["X"]),
    target={"readings": 500},
    compensation_active=False,
)


class Line(NamedTuple):
    """A line of a record, found without its reader: from which byte to which, kind, JSON."""

    begin: int
    end: int
    kind: str
    payload: str


class Original(NamedTuple):
    """A record, another one of the same machine, and readings that a second writer adds to the first."""

    content: bytes
    other: bytes
    lines: tuple[Line, ...]
    rival: tuple[EventText, ...]


class Outcome(NamedTuple):
    """What one damage came to, in readings; unreadable, beginning : whether it needed salvage, and its first event.

    whole : readings that stand whole; back : those that came back
    wrong : readings of another record, changed ones, and those out of their order
    again : readings that had been taken back and stand
    """

    unreadable: bool
    beginning: bool
    whole: int
    back: int
    wrong: int
    again: int


def lines_of(content: bytes) -> tuple[Line, ...]:
    """Return the lines of a whole record."""
    found, at = list[Line](), START
    for text in content[START:].splitlines(keepends=True):
        _, _, kind, rest = text.decode().split(" ", 3)
        found.append(Line(at, at + len(text), kind, rest[: rest.rindex(" ")]))
        at += len(text)
    return tuple(found)


@cache
def originals() -> tuple[Original, ...]:
    """Return records of a short and of a long description, of few and of many readings.

    The other record is of a day before, of the same hours, of a day after.
    """
    found = list[Original]()
    small, large = campaign_from_texts(CAMPAIGN, "", MACHINE, ""), description()
    for n, (campaign, count, later) in enumerate(((small, 12, -86400), (small, 150, 1200), (large, 40, 86400))):
        content = _made(_story(campaign, count, n, 0))
        other = _made(_story(campaign, count, n + 100, later))
        rival = (row for row in _story(campaign, count, n + 200, 0) if row.kind == "recorded")
        found.append(Original(content, other, lines_of(content), tuple(rival)))
    return tuple(found)


def _made(rows: Iterator[EventText]) -> bytes:
    mark, lines, marks = Mark(), b"", [b"", b""]
    for closing, group in groupby(_numbered(rows), key=lambda each: each[0]):
        text, mark = transaction(mark, [row for _, row in group])
        lines, marks[closing % 2] = lines + text, mark_bytes(mark)
    return head() + b"".join(each.ljust(BLOCK - 1) + b"\n" for each in marks) + lines


def _numbered(rows: Iterator[EventText]) -> Iterator[tuple[int, EventText]]:
    turn = 0
    for row in rows:
        yield turn, row
        turn += row.closes


def _story(campaign: CampaignDescription, readings: int, seed: int, later: float) -> Iterator[EventText]:
    """Yield a record with all that a campaign has: plans, questions, skips, undos, notes, a batch, ends.

    later : s behind a beginning that is the same for all
    """
    chance, number, begun = random.Random(seed), 0, datetime(2026, 3, 2, 7, 30, tzinfo=UTC) + timedelta(seconds=later)
    now = begun

    def place() -> Place:
        setup = campaign.setups[0]
        pose = [chance.uniform(*axis.travel) for axis in campaign.machine.axes]
        return Place(setup.name, tuple(pose), tuple(chance.choice((-1, 1)) for _ in pose))

    def reading(at: Place) -> Recorded:
        value, *others = (chance.gauss(0, 1e-5) for _ in range(values_of(campaign.setups[0])))
        time = (now - begun).total_seconds()
        return Recorded(Reading(at.setup, at.pose, at.approach, value, others=tuple(others), time=time))

    def said(event: Event, *, closes: bool = True) -> EventText:
        nonlocal number, now
        row = EventText(now.isoformat(timespec="milliseconds"), *encode(event, Hand("anna", "bench")), closes)
        number, now = number + 1, now + timedelta(seconds=round(chance.uniform(0.01, 30), 3) if closes else 0)
        return row

    yield said(beginning_of(campaign))
    places = [place() for _ in range(readings)]
    for count, at in enumerate(places, 1):
        if count % 10 == 1:
            yield said(Planned(tuple(places[count - 1 : count + 19])))
        yield said(Asked(count, at))
        yield said(Skipped("the beam is lost") if chance.random() < 0.05 else reading(at))
        if chance.random() < 0.05:
            yield said(Undone(number))
            yield said(reading(at))
        if chance.random() < 0.05:
            yield said(Noted("21 °C, the door is open"))
        if chance.random() < 0.03:
            yield said(Finished("enough"))
            yield said(Undone(number))
    for _ in range(5):
        yield said(reading(place()), closes=False)
    yield said(Noted("by hand"))
    yield said(Finished("the target is reached"))


Damage = Callable[[Original, random.Random], bytes]


def _over(content: bytes, at: int, new: bytes) -> bytes:
    return content[:at] + new[: len(content) - at] + content[at + len(new) :]


def bit(one: Original, chance: random.Random) -> bytes:
    """Flip a bit of marks or lines."""
    in_lines, in_mark = chance.randrange(START, len(one.content)), chance.choice(MARKS) + chance.randrange(130)
    at = in_lines if chance.random() < 0.95 else in_mark
    return _over(one.content, at, bytes([one.content[at] ^ 1 << chance.randrange(8)]))


def sector(one: Original, chance: random.Random, size: int = SECTOR) -> bytes:
    """Put zeros, blanks or anything in the place of a sector."""
    at = chance.randrange(BLOCK // size, -(-len(one.content) // size)) * size
    return _over(one.content, at, chance.choice((bytes(size), b" " * size, b"\xff" * size, chance.randbytes(size))))


def page(one: Original, chance: random.Random) -> bytes:
    """The same with a page."""
    return sector(one, chance, BLOCK)


def cut(one: Original, chance: random.Random) -> bytes:
    """Cut the tail off."""
    return one.content[: chance.randrange(START, len(one.content))]


def mark(one: Original, chance: random.Random) -> bytes:
    """Put blanks over one mark or both, and in every second case change a bit as well."""
    content = one.content if chance.random() < 0.5 else bit(one, chance)
    for at in chance.sample(MARKS, chance.choice((1, 1, 2))):
        content = _over(content, at, MARK * b" ")
    return content


def mixed(one: Original, chance: random.Random) -> bytes:
    """Put a piece of another record of the same machine in its place: of sectors or pages, up to the end too."""
    size = chance.choice((SECTOR, BLOCK))
    first = chance.randrange(BLOCK // size, -(-len(one.content) // size))
    if chance.random() < 0.3:
        first = START // size
    if first * size < START:
        return _over(one.content, first * size, one.other[first * size : (first + 1) * size])
    if chance.random() < 0.2:
        return one.content[: first * size] + one.other[first * size :]
    count = chance.choice((1, 1, 2, 5, 20))
    return _over(one.content, first * size, one.other[first * size : (first + count) * size])


def several(one: Original, chance: random.Random) -> bytes:
    """Flip bits in three places."""
    content = one.content
    for _ in range(3):
        content = bit(one._replace(content=content), chance)
    return content


def _blocks(one: Original, chance: random.Random) -> tuple[list[bytes], int, int]:
    """Return the pieces of a file, of lines or of pages, the first with head and marks, and two that are not it."""
    lines = one.content[START:].splitlines(keepends=True)
    size, count = chance.choice((SECTOR, BLOCK)), chance.randrange(1, 12)
    pages = [one.content[at : at + size] for at in range(START, len(one.content), size)]
    groups = [b"".join(lines[at : at + count]) for at in range(0, len(lines), count)]
    parts = groups if chance.random() < 0.6 else pages
    first, second = (chance.randrange(1, len(parts) + 1) for _ in range(2))
    return [one.content[:START], *parts], first, second


def twice(one: Original, chance: random.Random) -> bytes:
    """Write a block a second time, somewhere."""
    parts, first, second = _blocks(one, chance)
    return b"".join([*parts[:second], parts[first], *parts[second:]])


def elsewhere(one: Original, chance: random.Random) -> bytes:
    """Write a block over another one."""
    parts, first, second = _blocks(one, chance)
    parts[second] = parts[first]
    return b"".join(parts)


def swapped(one: Original, chance: random.Random) -> bytes:
    """Let two blocks change places."""
    parts, first, second = _blocks(one, chance)
    parts[first], parts[second] = parts[second], parts[first]
    return b"".join(parts)


def gone(one: Original, chance: random.Random) -> bytes:
    """Leave lines out, here and there or in a row."""
    lines = one.content[START:].splitlines(keepends=True)
    for _ in range(chance.randrange(1, 6)):
        at = chance.randrange(len(lines))
        del lines[at : at + chance.choice((1, 1, 2, 8))]
    return one.content[:START] + b"".join(lines)


def out_of_order(one: Original, chance: random.Random) -> bytes:
    """Move some lines, or sort, reverse or shuffle all."""
    lines = one.content[START:].splitlines(keepends=True)
    how = chance.choice((lines.sort, lines.reverse, partial(chance.shuffle, lines), None, None, None))
    if how is not None:
        how()
    else:
        for _ in range(chance.randrange(1, 10)):
            lines.insert(chance.randrange(len(lines)), lines.pop(chance.randrange(len(lines))))
    return one.content[:START] + b"".join(lines)


def two_writers(one: Original, chance: random.Random) -> bytes:
    """Let two go on from one event, neither of which sees the other: each writes at what it takes for the end."""
    at = chance.randrange(1, len(one.lines))
    texts = [one.content[line.begin : line.end] for line in one.lines]
    shared = b"".join(texts[:at])
    chain, parted, _ = texts[at - 1].decode().split(" ", 2)
    rival = [row for row in one.rival if row.at > parted][: chance.randrange(1, 200)]
    mine = [
        EventText(when, kind, text) for when, kind, text in (each.decode()[65:-11].split(" ", 2) for each in texts[at:])
    ]
    content, marks = bytearray(one.content[:START] + shared), 2 * [Mark(at, at, START + len(shared), chain)]
    while mine or rival:
        who = 0 if mine and (not rival or chance.random() < 0.5) else 1
        offset = marks[who].end
        text, marks[who] = transaction(marks[who], [(mine, rival)[who].pop(0)])
        content[offset : offset + len(text)] = text
        slot = MARKS[marks[who].turn % 2]
        content[slot : slot + MARK] = mark_bytes(marks[who])
    return bytes(content)


def line_ends(one: Original, chance: random.Random) -> bytes:
    """Change the line ends, of lines alone or of head and marks, too."""
    keep = chance.choice((0, START))
    return one.content[:keep] + one.content[keep:].replace(b"\n", b"\r\n")


def blanks(one: Original, chance: random.Random) -> bytes:
    """Strip blanks at the ends of lines, or add some."""
    added = chance.choice((b"", b" ", b"\t  "))
    text = b"\n".join(line.rstrip(b" ") + added for line in one.content.split(b"\n"))
    return text.rstrip() if chance.random() < 0.5 else text


def foreign(one: Original, chance: random.Random) -> bytes:
    """Put the head and marks of one record before lines of the other, in every second case with own lines behind."""
    lines, own = (content[START:].splitlines(keepends=True) for content in (one.other, one.content))
    at = chance.randrange(1, len(own)) if chance.random() < 0.5 else len(own)
    return one.content[:START] + b"".join([*lines[:at], *own[at:]])


DAMAGES: dict[str, Damage] = {
    "a bit": bit,
    "a sector of 512 bytes": sector,
    "a page of 4 kB": page,
    "the tail": cut,
    "a mark": mark,
    "pieces of another file": mixed,
    "three bits": several,
    "a block written twice": twice,
    "a block in another's place": elsewhere,
    "blocks swapped": swapped,
    "lines gone": gone,
    "lines out of order": out_of_order,
    "two writers": two_writers,
    "line ends": line_ends,
    "trailing blanks": blanks,
    "own head and marks before another's lines": foreign,
}


def outcome(one: Original, damaged: bytes, folder: Path) -> Outcome:
    """Salvage a damaged record and hold what comes back against the original."""
    path, new = folder / "damaged.axiscal", folder / "new.axiscal"
    path.write_bytes(damaged)
    new.unlink(missing_ok=True)
    mine = [line.payload for line in one.lines if line.kind == "recorded"]
    rival = [row.payload for row in one.rival]
    whole = {
        line.payload
        for line in one.lines
        if line.kind == "recorded" and one.content[line.begin : line.end - 1] in damaged
    }
    whole |= {
        text
        for text in rival
        if re.search(b"[0-9a-f]{64} [^ ]+ recorded " + re.escape(text.encode()) + rb" [.][0-9a-f]{8}", damaged)
    }
    unreadable = not _opens(path)
    beginning = False
    try:
        salvaged(path, new)
    except RecordError:
        beginning = True
        with suppress(RecordError):
            salvaged(path, new, _first(one))
    assert path.read_bytes() == damaged
    if not new.exists():
        return Outcome(unreadable, beginning, len(whole), 0, 0, 0)
    with Record.open(new, write=False) as record:
        standing = [reading.value for reading in record.state().readings]
    kept = _readings(new.read_bytes())
    rest, rivals = iter(mine), set(rival)  # the iterator goes on: also what is out of its order is wrong
    own = [payload for payload in kept if payload not in rivals]  # what parted comes last, whenever it was read
    wrong = sum(payload not in rest for payload in own) + len(kept) - len(set(kept))
    gone = Counter([*_standing(one.lines), *(json.loads(text)["value"] for text in rival)])
    again = sum((Counter(standing) - gone).values())
    return Outcome(unreadable, beginning, len(whole), len(set(kept) & whole), wrong, again)


def _readings(content: bytes) -> list[str]:
    return [line.payload for line in lines_of(content) if line.kind == "recorded"]


def _standing(lines: Sequence[Line]) -> Iterator[float]:
    """Yield the readings that a record leaves standing, by a plain replay."""
    stack = list[tuple[int, float | None]]()
    for number, line in enumerate(lines, 1):
        fields = json.loads(line.payload)
        if line.kind in ("recorded", "skipped", "finished"):
            stack.append((number, fields.get("value")))
        elif line.kind == "undone":
            assert stack.pop()[0] == fields["event"]
    yield from (value for _, value in stack if value is not None)


def _first(one: Original) -> EventText:
    at = one.content[one.lines[0].begin :].split(b" ", 2)[1].decode()
    return EventText(at, "created", one.lines[0].payload)


def _opens(path: Path) -> bool:
    try:
        Record.open(path, write=False).close()
    except RecordError:
        return False
    return True


def tried(name: str, count: int, first: int = 0) -> Trial:
    """Damage records in one way, and count what comes back.  first : of the originals"""
    outcomes = outcomes_of(name, count, first)
    whole, back = sum(each.whole for each in outcomes), sum(each.back for each in outcomes)
    wrong, again = sum(each.wrong for each in outcomes), sum(each.again for each in outcomes)
    unreadable, beginning = sum(each.unreadable for each in outcomes), sum(each.beginning for each in outcomes)
    share = back / max(whole, 1)
    detail = (
        f"{unreadable:,} unreadable; {back:,} of {whole:,} readings that stand whole come back ({share:.2%}), "
        f"{wrong} wrong; {beginning:,} need --beginning; {again} that had been taken back stand"
    )
    return Trial(f"records salvaged: {name}", count, wrong + max(0, int(0.99 * whole) - back), detail)


def outcomes_of(name: str, count: int, first: int = 0) -> list[Outcome]:
    """Return what damages of one kind come to, drawn alike each time."""
    chance = random.Random(f"{name} {count}")
    with scratch() as top:
        return [
            outcome(one, DAMAGES[name](one, chance), top)
            for one in (originals()[number % len(originals())] for number in range(first, first + count))
        ]
