"""Damaged records, and what `axiscal salvage` makes of them: rows of `make reliability`.

The oracle knows the original: a reading stands whole where none of the bytes of its line has changed.
"""

from __future__ import annotations

import json
import random
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import cache
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
from axiscal.record.line_form import BLOCK, MARK, MARKS, START, EventText
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
    """A record and another one of the same machine."""

    content: bytes
    other: bytes
    lines: tuple[Line, ...]


class Outcome(NamedTuple):
    """What one damage came to, in readings; unreadable, beginning : whether it needed salvage, and its first event.

    whole : readings that stand whole; back : those that came back
    wrong : readings that are not the original's; nor, where none of its lines is left, all the other file's
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
    """Return records of a short and of a long description, of few and of many readings."""
    with scratch() as top:
        small, large = campaign_from_texts(CAMPAIGN, "", MACHINE, ""), description()
        return tuple(
            Original(first, _made(top / f"other{n}.axiscal", description, count, n + 100), lines_of(first))
            for n, (description, count) in enumerate(((small, 12), (small, 150), (large, 40)))
            for first in [_made(top / f"{n}.axiscal", description, count, n)]
        )


def _made(path: Path, description: CampaignDescription, readings: int, seed: int) -> bytes:
    """Return a record with all that a campaign has: plans, questions, skips, undos, notes, a batch, ends."""
    chance = random.Random(seed)

    def place() -> Place:
        setup = description.setups[0]
        pose = [chance.uniform(*axis.travel) for axis in description.machine.axes]
        return Place(setup.name, tuple(pose), tuple(chance.choice((-1, 1)) for _ in pose))

    def reading(at: Place) -> Recorded:
        value, *others = (chance.gauss(0, 1e-5) for _ in range(values_of(description.setups[0])))
        seconds = chance.uniform(0, 1e5)
        return Recorded(Reading(at.setup, at.pose, at.approach, value, others=tuple(others), time=seconds))

    with Record.create(path, beginning_of(description)) as record:
        places = [place() for _ in range(readings)]
        for number, at in enumerate(places, 1):
            if number % 10 == 1:
                record.append(Planned(tuple(places[number - 1 : number + 19])))
            record.append(Asked(number, at))
            last = record.append(Skipped("the beam is lost") if chance.random() < 0.05 else reading(at))
            if chance.random() < 0.05:
                record.append(Undone(last))
                record.append(reading(at))
            if chance.random() < 0.05:
                record.append(Noted("21 °C, the door is open"))
            if chance.random() < 0.03:
                end = record.append(Finished("enough"))
                record.append(Undone(end))
        batch: list[Event] = [reading(place()) for _ in range(5)]
        record.append(*batch, Noted("by hand"))
        record.append(Finished("the target is reached"))
    return path.read_bytes()


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


DAMAGES: dict[str, Damage] = {
    "a bit": bit,
    "a sector of 512 bytes": sector,
    "a page of 4 kB": page,
    "the tail": cut,
    "a mark": mark,
    "pieces of another file": mixed,
    "three bits": several,
}


def outcome(one: Original, damaged: bytes, folder: Path) -> Outcome:
    """Salvage a damaged record and hold what comes back against the original."""
    path, new = folder / "damaged.axiscal", folder / "new.axiscal"
    path.write_bytes(damaged)
    new.unlink(missing_ok=True)
    whole = [line for line in one.lines if damaged[line.begin : line.end] == one.content[line.begin : line.end]]
    readings = [line.payload for line in whole if line.kind == "recorded"]
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
        return Outcome(unreadable, beginning, len(readings), 0, 0, 0)
    with Record.open(new, write=False) as record:
        standing = [reading.value for reading in record.state().readings]
    kept = _readings(new.read_bytes())
    theirs = one.lines if readings or not set(kept) & set(_readings(one.other)) else lines_of(one.other)
    rest = iter(line.payload for line in theirs if line.kind == "recorded")
    wrong = sum(payload not in rest for payload in kept)  # the iterator goes on: also what is out of its order
    gone = Counter(_standing(theirs))
    again = sum((Counter(standing) - gone).values())
    return Outcome(unreadable, beginning, len(readings), len(set(kept) & set(readings)), wrong, again)


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


def tried(name: str, count: int) -> Trial:
    """Damage records in one way, and count what comes back."""
    outcomes = outcomes_of(name, count)
    whole, back = sum(each.whole for each in outcomes), sum(each.back for each in outcomes)
    wrong, again = sum(each.wrong for each in outcomes), sum(each.again for each in outcomes)
    unreadable, beginning = sum(each.unreadable for each in outcomes), sum(each.beginning for each in outcomes)
    detail = (
        f"{unreadable:,} unreadable; {back:,} of {whole:,} readings that stand whole come back ({back / whole:.2%}), "
        f"{wrong} wrong; {beginning:,} need --beginning; {again} that had been taken back stand"
    )
    return Trial(f"records salvaged: {name} damaged", count, wrong + max(0, int(0.99 * whole) - back), detail)


def outcomes_of(name: str, count: int) -> list[Outcome]:
    """Return what damages of one kind come to, drawn alike each time."""
    chance = random.Random(f"{name} {count}")
    with scratch() as top:
        return [
            outcome(one, DAMAGES[name](one, chance), top)
            for one in (originals()[number % len(originals())] for number in range(count))
        ]
