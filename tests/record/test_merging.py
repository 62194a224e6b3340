"""What stands whole in a damaged file, by number and by line."""

from __future__ import annotations

import pytest

from axiscal.record.events import Noted
from axiscal.record.line_form import MARK, MARKS, START
from axiscal.record.merging import merged
from axiscal.record.store import Record
from tests.reliability.record_faults import CREATED
from tests.reliability.salvaged import lines_of

EVENTS = 9


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The file of a record with nine events, each in a transaction of its own."""
    path = tmp_path_factory.mktemp("whole") / "warm.axiscal"
    with Record.create(path, CREATED) as record:
        for number in range(2, EVENTS + 1):
            record.append(Noted(f"warm {number}"))
    return path.read_bytes()


def _stands(content: bytes) -> tuple[list[int], int | None]:
    """Return the numbers that stand, and the last one by the marks; no line may be of another record."""
    found = merged(content)
    assert found.apart == []
    numbers = [number for strand in found.strands for number in strand.numbers if strand.certain]
    return numbers, found.newest and found.newest.last


def _changed(content: bytes, at: int, new: bytes) -> bytes:
    return content[:at] + new + content[at + len(new) :]


@pytest.mark.parametrize("at", [10, 100], ids=["chain", "text"])
@pytest.mark.parametrize("marks", [True, False])
def test_one_damaged_line_links_those_around_it(whole: bytes, at: int, marks: bool) -> None:
    """By the chain that it names, or by the one that its text gives."""
    damaged = whole
    for number in (4, 6):
        damaged = _changed(damaged, lines_of(whole)[number - 1].begin + at, b"#")
    for mark in () if marks else MARKS:
        damaged = _changed(damaged, mark, bytes(MARK))
    assert _stands(damaged) == ([1, 2, 3, 5, 7, 8, 9], EVENTS if marks else None)


def test_a_line_whose_pieces_stand_in_blocks_that_were_moved_is_put_together(whole: bytes) -> None:
    first, *_, last = blocks = [whole[at : at + 512] for at in range(START, len(whole), 512)]
    moved = whole[:START] + b"".join([first, *reversed(blocks[1:-1]), last])
    assert _stands(moved) == (list(range(1, EVENTS + 1)), EVENTS)
