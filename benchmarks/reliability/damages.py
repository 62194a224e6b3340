"""Records damaged by kind, and what opening and `axiscal data repair` make of them: rows of `make reliability`.

The lines are written by `tests.generators.plain_records`, which shares nothing with the reader. A reading stands whole
where its line is in the file. Two campaigns are begun from one unchanged file; a third one is a branch of the first.
"""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from axiscal.campaign.repairing import repaired
from axiscal.exceptions import RecordError
from axiscal.record.store import Record
from benchmarks.reliability.record_faults import CREATED
from benchmarks.reliability.trial import Trial, scratch
from tests.generators.plain_records import HEAD, PlainLine, dumped, front, story, written_lines

OWN, OTHER = "a" * 32, "b" * 32
READINGS, SHARED = 60, 70
"""Readings of each record, and lines that a branch shares with it."""


class Originals(NamedTuple):
    """Lines of a record, of another campaign from the same file, of a branch of the first, and a first page."""

    own: Sequence[bytes]
    other: Sequence[bytes]
    branch: Sequence[bytes]
    page: bytes

    def file(self, lines: Sequence[bytes], least: int | None = None) -> bytes:
        """Return a file of lines under a head of so many."""
        return front(self.page, len(lines) if least is None else least) + b"".join(lines)


def _with_undone(lines: Sequence[PlainLine]) -> list[PlainLine]:
    """Take every tenth reading back, once, and read it anew."""
    found = list[PlainLine]()
    for line in lines:
        found.append(line)
        if line.kind == "recorded" and json.loads(line.said)["reading"] % 10 == 0:
            again = dumped(json.loads(line.said) | {"value": json.loads(line.said)["value"] + 1e-6})
            found += [PlainLine(line.at, "undone", f'{{"event":{len(found)}}}'), line._replace(said=again)]
    return found


@cache
def originals() -> Originals:
    """Return what is damaged."""
    with scratch() as top:
        Record.create(top / "page.axiscal", CREATED).close()
        page = (top / "page.axiscal").read_bytes()[:HEAD]
    own, other, third = (_with_undone(story(seed, later=seed / 10, count=READINGS)) for seed in range(3))
    lines = written_lines(own, OWN)
    branch = [*lines[:SHARED], *written_lines(third[SHARED:], OWN, lines[:SHARED], "cd")]
    return Originals(lines, written_lines(other, OTHER), branch, page)


def first_record() -> bytes:
    """Return a record that has begun."""
    return originals().file(originals().own[:1])


Damage = Callable[[Originals, random.Random], bytes]


def _piece(size: int, fill: Callable[[random.Random, bytes], bytes]) -> Damage:
    def damage(of: Originals, chance: random.Random) -> bytes:
        whole = of.file(of.own)
        at = chance.randrange(len(whole) // size) * size
        return whole[:at] + fill(chance, whole[at : at + size]) + whole[at + size :]

    return damage


def _bit(of: Originals, chance: random.Random) -> bytes:
    whole = bytearray(of.file(of.own))
    whole[chance.randrange(len(whole))] ^= 1 << chance.randrange(8)
    return bytes(whole)


def _swapped(of: Originals, chance: random.Random) -> bytes:
    whole, size = of.file(of.own), chance.choice((512, 4096))
    blocks = [whole[at : at + size] for at in range(0, len(whole), size)]
    one, two = chance.sample(range(len(blocks)), 2)
    blocks[one], blocks[two] = blocks[two], blocks[one]
    return b"".join(blocks)


def _twice(of: Originals, chance: random.Random) -> bytes:
    whole, size = of.file(of.own), 512
    one, two = (chance.randrange(len(whole) // size) * size for _ in range(2))
    return whole[:two] + whole[one : one + size] + whole[two + size :]


def _run_in(of: Originals, chance: random.Random) -> bytes:
    at, count, gone = chance.randrange(1, len(of.own)), chance.randrange(1, 25), chance.randrange(2)
    return of.file([*of.own[:at], *of.other[at : at + count], *of.own[at + gone * count :]], len(of.own))


def _crossed(of: Originals, chance: random.Random) -> bytes:
    files, size = (of.file(of.own), of.file(of.other)), chance.choice((512, 4096))
    return b"".join(chance.choice(files)[at : at + size] for at in range(0, max(map(len, files)), size))


def _hole(of: Originals, chance: random.Random) -> bytes:
    whole, size = of.file(of.own), chance.choice((1, 100, 4096))
    at = chance.randrange(HEAD, len(whole))
    return whole[:at] + bytes(size) + whole[at:]


def _older_head(of: Originals, chance: random.Random) -> bytes:
    return of.file(of.own, chance.randrange(1, len(of.own)))


def _older_tail(of: Originals, chance: random.Random) -> bytes:
    return of.file(of.own[: chance.randrange(1, len(of.own))], len(of.own))


def _gone(of: Originals, chance: random.Random) -> bytes:
    return of.file([line for line in of.own if chance.random() < 0.9 or line is of.own[0]], len(of.own))


def _conflict(of: Originals, _chance: random.Random) -> bytes:
    mine, theirs = of.own[SHARED:], of.branch[SHARED:]
    return of.file([*of.own[:SHARED], b"<<<<<<< HEAD\n", *mine, b"=======\n", *theirs, b">>>>>>> theirs\n"])


DAMAGES: dict[str, Damage] = {
    "a bit": _bit,
    "a sector of zeros": _piece(512, lambda chance, old: bytes(len(old))),
    "a sector of anything": _piece(512, lambda chance, old: chance.randbytes(len(old))),
    "a page of zeros": _piece(4096, lambda chance, old: bytes(len(old))),
    "cut off": lambda of, chance: of.file(of.own)[: chance.randrange(HEAD, len(of.file(of.own)))],
    "blocks swapped": _swapped,
    "a block twice": _twice,
    "lines in another order": lambda of, chance: of.file(chance.sample(of.own, len(of.own))),
    "lines twice": lambda of, chance: of.file([*of.own, *chance.choices(of.own, k=9)], len(of.own)),
    "lines gone": _gone,
    "no line ends": lambda of, chance: of.file(of.own).replace(b"\n", b""),
    "other line ends": lambda of, chance: of.file(of.own).replace(b"\n", chance.choice((b"\r\n", b"\r"))),
    "quoted": lambda of, chance: b"\n".join(b"> " + line for line in of.file(of.own).split(b"\n")),
    "an older head": _older_head,
    "an older tail": _older_tail,
    "no head": lambda of, chance: of.file(of.own)[chance.randrange(1, HEAD) :],
    "zeros behind": lambda of, chance: of.file(of.own)[: chance.randrange(HEAD, len(of.file(of.own)))] + bytes(1 << 20),
    "zeros between": _hole,
    "two that went on apart": _conflict,
    "blocks of a branch": lambda of, chance: b"".join(
        chance.choice((of.file(of.own), of.file(of.branch)))[at : at + 4096]
        for at in range(0, len(of.file(of.own)), 4096)
    ),
    "a run of another campaign": _run_in,
    "blocks of another campaign": _crossed,
    "another campaign behind": lambda of, chance: of.file(of.own) + of.file(of.other),
    "own beginning, another's lines": lambda of, chance: of.file([*of.own[: chance.randrange(1, 6)], *of.other[6:]]),
}


class Outcome(NamedTuple):
    """What damages of a kind came to, in readings: those that stood whole, those that came back, those that are wrong.

    again : that had been taken back and stand, as the line that says so does not; opened : records as they were
    """

    whole: int = 0
    back: int = 0
    wrong: int = 0
    again: int = 0
    opened: int = 0


def every(count: int) -> Trial:
    """Damage a record so many times in each way."""
    found = {name: outcome(name, count) for name in DAMAGES}
    whole, back, wrong, again, opened = map(sum, zip(*found.values(), strict=True))
    bad = [name for name, each in found.items() if each.wrong or each.back < each.whole]
    detail = f"{back:,} of {whole:,} whole readings come back, {wrong} wrong; {again} taken back stand; {opened} open"
    what = f"records damaged in {len(DAMAGES)} ways"
    return Trial(what, count * len(found), wrong + whole - back, "; ".join([detail, *bad]))


def tried(name: str, count: int, seed: int = 0) -> Trial:
    """Damage a record so many times in one way."""
    found = outcome(name, count, seed)
    return Trial(f"records damaged: {name}", count, found.wrong + found.whole - found.back, str(found))


def outcome(name: str, count: int, seed: int = 0) -> Outcome:
    """Return what came of it: all that stands whole is to come back, and nothing of another campaign."""
    chance, of, total = random.Random(f"{name} {seed}"), originals(), Outcome()
    ever = {each["p"]["value"] for each in _said([*of.own, *of.branch]) if each["k"] == "recorded"}
    with scratch() as top:
        path = top / "mill.axiscal"
        for number in range(count):
            content = DAMAGES[name](of, chance)
            path.write_bytes(content)
            standing, gone = _standing(of, content)
            found, kept = _opened(path), _repaired(path, top / f"{number}.axiscal")
            silent = found is not None and not found >= standing
            wrong = silent + len(kept - ever) + len(kept & gone)
            one = Outcome(len(standing), len(standing & kept), wrong, len(kept - standing), found is not None)
            total = Outcome(*map(sum, zip(total, one, strict=True)))
    return total


def _said(lines: Sequence[bytes]) -> list[dict[str, Any]]:
    return [json.loads(line[65:]) for line in lines]


def _standing(of: Originals, content: bytes) -> tuple[set[float], set[float]]:
    """Return the readings whose line is in a file: those that stand, and those that a line takes back."""
    stand, gone = set[float](), set[float]()
    for lines in (of.own, of.branch) if of.own[0].rstrip() in content else ():
        said = {each["n"]: each for each in _said([line for line in lines if line.rstrip() in content])}
        undone = {each["p"]["event"] for each in said.values() if each["k"] == "undone"}
        every = {each["p"]["event"] for each in _said(lines) if each["k"] == "undone"}
        readings = {n: each["p"]["value"] for n, each in said.items() if each["k"] == "recorded"}
        stand |= {value for n, value in readings.items() if n not in every}
        gone |= {value for n, value in readings.items() if n in undone}
    return stand, gone


def _opened(path: Path) -> set[float] | None:
    try:
        with Record.open(path, write=False) as record:
            return {reading.value for reading in record.state().readings}
    except RecordError:
        return None


def _repaired(path: Path, new: Path) -> set[float]:
    """Return what comes back of a record, its id named."""
    try:
        state = repaired([path], new, lambda question: True, campaign=OWN).state
    except RecordError:
        return set()
    return {reading.value for reading in state.readings}
