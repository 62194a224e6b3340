"""Two campaigns begun from one unchanged file, their lines in one damaged file: none comes back as the other's."""

from __future__ import annotations

import random
import tracemalloc
import zlib
from collections.abc import Iterator
from pathlib import Path

import pytest

from axiscal.campaign.salvaging import salvaged
from axiscal.exceptions import RecordError
from axiscal.record import line_form
from axiscal.record.merging import merged
from tests.generators.plain_records import START, front, lines_in, story, values_in, written_lines

FIRST_PAGE = line_form.head()
BLANK = 2 * 4096 * b" "


def shapes(own: list[bytes], other: list[bytes], chance: random.Random) -> Iterator[tuple[str, bytes]]:
    """Yield files that hold lines of both, by name."""
    mine, theirs = front(FIRST_PAGE, own), front(FIRST_PAGE, other)
    files = mine + b"".join(own), theirs + b"".join(other)
    at, count, block = chance.randrange(2, len(own) - 1), chance.randrange(1, 25), chance.choice((512, 4096))
    sector = chance.randrange(START // block, len(files[0]) // block) * block
    yield "a run put in", mine + b"".join([*own[:at], *other[at : at + count], *own[at:]])
    yield "a run replaced", mine + b"".join([*own[:at], *other[at : at + count], *own[at + count :]])
    yield "the beginning alone", mine + b"".join([*own[: chance.randrange(1, 6)], *other[6:]])
    yield "by turns", mine + b"".join(line for pair in zip(own, other, strict=True) for line in pair)
    yield "one behind the other", b"".join(files)
    yield "the other's end", mine + b"".join([*own[:at], *other[at:]])
    yield "the other's end and marks", theirs + b"".join([*own[:at], *other[at:]])
    yield "no marks", FIRST_PAGE + BLANK + b"".join([*own[:at], *other[at:]])
    yield "no marks, both", FIRST_PAGE + BLANK + b"".join([*own, *other])
    yield "a block", files[0][:sector] + files[1][sector : sector + block] + files[0][sector + block :]
    yield (
        "blocks",
        b"".join(chance.choice(files)[at : at + block] for at in range(0, max(map(len, files)), block)),
    )


@pytest.mark.parametrize("later", [0.2, 40.0])
@pytest.mark.parametrize("clock", [True, False])
def test_no_reading_comes_back_as_that_of_another_campaign(clock: bool, later: float, tmp_path: Path) -> None:
    back = 0
    for case in range(2):
        own, other = story(2 * case, 0.0, clock), story(2 * case + 1, later, clock)
        values = set(values_in(own)), set(values_in(other))
        for name, content in shapes(written_lines(own), written_lines(other), random.Random(case)):
            path, new = tmp_path / "damaged.axiscal", tmp_path / f"{case} {name}.axiscal"
            path.write_bytes(content)
            try:
                found = salvaged(path, new)
            except RecordError:
                continue
            kept = values_in(lines_in(new.read_bytes()))
            assert not (values[0] & {*kept} and values[1] & {*kept}), name
            assert len(kept) == len({*kept})
            assert found.missing or len(kept) == 30, name
            back += len(kept)
    assert back > 200


@pytest.mark.parametrize(
    "tail",
    [bytes(1 << 21), b"a" * (1 << 21), 30_000 * (64 * b"0" + b" 2026-"), 60_000 * b"x .00000000\0"],
    ids=["NULs", "no line ends", "beginnings", "ends"],
)
def test_a_tail_of_anything_costs_what_its_bytes_cost(tail: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    """Summed are no more bytes than a few times those of the file, and no more are held."""
    lines, summed = written_lines(story(1)), list[int]()

    def counted(text: bytes, before: int = 0) -> int:
        summed.append(len(text))
        return crc32(text, before)

    crc32 = zlib.crc32
    content = front(FIRST_PAGE, lines) + b"".join(lines) + tail
    monkeypatch.setattr(zlib, "crc32", counted)
    tracemalloc.start()
    found = merged(content)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert [len(strand.lines) for strand in found.strands] == [len(lines)]
    assert sum(summed) < 8 * len(content)
    assert peak < 12 * len(content)


def test_lines_without_ends_all_come_back() -> None:
    lines = written_lines(story(3, count=150))
    content = (front(FIRST_PAGE, lines) + b"".join(lines)).replace(b"\n", b"")
    assert sum(len(strand.lines) for strand in merged(content).strands) == len(lines)
