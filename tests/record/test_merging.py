"""What stands whole in a damaged file, by number and by line; nothing of another file is taken for it."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import pytest

from axiscal.record.events import Noted
from axiscal.record.line_form import MARK, MARKS, START, Mark, mark_bytes
from axiscal.record.merging import ForeignError, merged
from axiscal.record.store import Record
from tests.reliability.record_faults import CREATED
from tests.reliability.salvaged import lines_of

EVENTS = 9


def _record(folder: Path, word: str) -> bytes:
    """Return the file of a record with nine events, each in a transaction of its own."""
    with Record.create(folder / f"{word}.axiscal", CREATED) as record:
        for number in range(2, EVENTS + 1):
            record.append(Noted(f"{word} {number}"))
    return (folder / f"{word}.axiscal").read_bytes()


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The file of a record."""
    return _record(tmp_path_factory.mktemp("whole"), "warm")


@pytest.fixture(scope="module")
def other(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The file of another record of the same campaign, whose lines are as long."""
    return _record(tmp_path_factory.mktemp("other"), "cold")


class Standing(NamedTuple):
    """The numbers that stand, those of lines that may be of another record, and the last one by the marks."""

    numbers: list[int]
    apart: list[int]
    last: int | None


def _stands(content: bytes) -> Standing:
    found = merged(content)
    numbers = [number for strand in found.strands for number in strand.numbers if strand.certain]
    return Standing(numbers, [len(strand.lines) for strand in found.apart], found.newest and found.newest.last)


def _changed(content: bytes, at: int, new: bytes) -> bytes:
    return content[:at] + new + content[at + len(new) :]


def _without(content: bytes, *numbers: int, at: int = 70) -> bytes:
    """Change a letter in the lines of these events of a file whose lines stand where those of `content` stood."""
    lines = lines_of(content)
    for number in numbers:
        content = _changed(content, lines[number - 1].begin + at, b"#")
    return content


def _unmarked(content: bytes) -> bytes:
    """Wipe both marks."""
    for at in MARKS:
        content = _changed(content, at, bytes(MARK))
    return content


@pytest.mark.parametrize("at", [10, 100], ids=["chain", "text"])
@pytest.mark.parametrize("marks", [True, False])
def test_one_damaged_line_links_those_around_it(whole: bytes, at: int, marks: bool) -> None:
    """By the chain that it names, or by the one that its text gives."""
    damaged = _without(whole, 4, 6, at=at)
    expected = Standing([1, 2, 3, 5, 7, 8, 9], [], EVENTS if marks else None)
    assert _stands(damaged if marks else _unmarked(damaged)) == expected


def test_behind_two_damaged_lines_only_a_mark_gives_numbers(whole: bytes) -> None:
    damaged = _without(whole, 4, 5)
    assert _stands(damaged) == ([1, 2, 3, 6, 7, 8, 9], [], EVENTS)
    found = merged(_unmarked(damaged))
    assert [(strand.certain, len(strand.lines)) for strand in found.strands] == [(True, 3), (False, 4)]


@pytest.mark.parametrize("room", [0, 1, 3])
def test_a_beginning_without_room_for_what_is_missing_is_of_another_file(whole: bytes, other: bytes, room: int) -> None:
    lines = lines_of(whole)
    content = whole[:START] + other[START : lines[3].begin] + bytes(room) + whole[lines[3].begin :]
    assert _stands(content) == ([4, 5, 6, 7, 8, 9], [3], EVENTS)


def test_a_line_whose_pieces_stand_in_blocks_that_were_moved_is_put_together(whole: bytes) -> None:
    first, *_, last = blocks = [whole[at : at + 512] for at in range(START, len(whole), 512)]
    moved = whole[:START] + b"".join([first, *reversed(blocks[1:-1]), last])
    assert _stands(moved) == (list(range(1, EVENTS + 1)), [], EVENTS)


@pytest.mark.parametrize("at", MARKS)
def test_a_foreign_mark_does_not_say_where_this_file_ends(whole: bytes, other: bytes, at: int) -> None:
    found = merged(_changed(whole, at, other[at : at + MARK]))
    assert ([len(strand.lines) for strand in found.strands], len(found.unborne)) == ([EVENTS], 1)
    assert found.newest is not None


@pytest.mark.parametrize("chain", [63 * "0" + "1", 64 * "f"])
def test_marks_that_the_lines_contradict_are_of_another_record(whole: bytes, chain: str) -> None:
    """They name an event that stands here, which has another chain."""
    forged = mark_bytes(Mark(99, 4, lines_of(whole)[3].end, chain))
    content = whole
    for at in MARKS:
        content = _changed(content, at, forged)
    with pytest.raises(ForeignError):
        merged(content)
