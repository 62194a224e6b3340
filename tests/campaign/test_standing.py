"""What stands whole in a damaged file, by number and by byte; nothing of another file is taken for it."""

from __future__ import annotations

import zlib
from pathlib import Path

import pytest

from axiscal.campaign.salvaging import Missing, Standing, standing
from axiscal.exceptions import NewerError, RecordError
from axiscal.record.events import Event, Noted
from axiscal.record.line_form import BLOCK, MARK, MARKS, START, Mark, mark_bytes
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


@pytest.fixture
def found(tmp_path: Path) -> Path:
    """Where the damaged file is to be."""
    return tmp_path / "found.axiscal"


def _stands(found: Path, content: bytes) -> Standing:
    found.write_bytes(content)
    return standing(found)


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


def _gone(whole: bytes, first: int, last: int) -> Missing:
    lines = lines_of(whole)
    return Missing(first, last, lines[first - 1].begin, lines[last - 1].end)


@pytest.mark.parametrize("at", [10, 100], ids=["chain", "text"])
@pytest.mark.parametrize("marks", [True, False])
def test_one_damaged_line_links_those_around_it(found: Path, whole: bytes, at: int, marks: bool) -> None:
    """By the chain that it names, or by the one that its text gives."""
    damaged = _without(whole, 4, 6, at=at)
    stands = _stands(found, damaged if marks else _unmarked(damaged))
    assert list(stands.entries) == [1, 2, 3, 5, 7, 8, 9]
    assert stands[1:] == ([_gone(whole, 4, 4), _gone(whole, 6, 6)], [], marks)


def test_behind_two_damaged_lines_only_a_mark_gives_numbers(found: Path, whole: bytes) -> None:
    damaged, lines = _without(whole, 4, 5), lines_of(whole)
    stands = _stands(found, damaged)
    assert (list(stands.entries), stands.missing) == ([1, 2, 3, 6, 7, 8, 9], [_gone(whole, 4, 5)])
    stands = _stands(found, _unmarked(damaged))
    assert (list(stands.entries), stands.missing, stands.ends) == ([1, 2, 3], [], False)
    assert stands.apart == [(lines[5].begin, lines[8].end, 4)]


@pytest.mark.parametrize("room", [0, 1, 3])
def test_a_beginning_without_room_for_what_is_missing_is_of_another_file(
    found: Path, whole: bytes, other: bytes, room: int
) -> None:
    lines = lines_of(whole)
    stands = _stands(found, whole[:START] + other[START : lines[3].begin] + bytes(room) + whole[lines[3].begin :])
    assert not any("cold" in row.payload for row in stands.entries.values())
    assert list(stands.entries) == [4, 5, 6, 7, 8, 9]
    assert [count for _, _, count in stands.apart] == [3]


def test_a_block_that_stands_twice_counts_once(found: Path, whole: bytes) -> None:
    lines = lines_of(whole)
    stands = _stands(found, whole[: lines[6].begin] + whole[lines[2].begin :])
    assert (list(stands.entries), stands.missing, stands.apart) == (list(range(1, EVENTS + 1)), [], [])


@pytest.mark.parametrize("at", MARKS)
def test_a_foreign_mark_does_not_say_where_this_file_ends(found: Path, whole: bytes, other: bytes, at: int) -> None:
    stands = _stands(found, _changed(whole, at, other[at : at + MARK]))
    assert (len(stands.entries), stands.missing, stands.ends) == (EVENTS, [], True)


@pytest.mark.parametrize("chain", [63 * "0" + "1", 64 * "f"])
def test_a_mark_of_another_chain_is_no_mark_of_this_file_even_if_it_is_newer(
    found: Path, whole: bytes, chain: str
) -> None:
    """It names an event that stands here, which has another chain, and an end before the last ones."""
    forged = mark_bytes(Mark(99, 4, lines_of(whole)[3].end, chain))
    content = whole
    for at in MARKS:
        content = _changed(content, at, forged)
    stands = _stands(found, content)
    assert (len(stands.entries), stands.missing, stands.ends) == (EVENTS, [], False)


def test_a_tail_that_is_gone_is_missing_up_to_the_mark(found: Path, whole: bytes) -> None:
    lines = lines_of(whole)
    stands = _stands(found, whole[: lines[6].begin + 30])
    assert (list(stands.entries), stands.missing) == ([1, 2, 3, 4, 5, 6], [_gone(whole, 7, 9)])


def test_half_a_transaction_does_not_stand_unless_a_mark_counts_it(found: Path, whole: bytes, tmp_path: Path) -> None:
    path = tmp_path / "batch.axiscal"
    path.write_bytes(whole)
    with Record.open(path) as record:
        batch: list[Event] = [Noted("ten"), Noted("eleven")]
        record.append(*batch)
    acknowledged = path.read_bytes()
    half = acknowledged[: lines_of(acknowledged)[9].end]
    assert list(_stands(found, half).entries) == list(range(1, 11))
    stands = _stands(found, whole[:START] + half[START:])
    assert (list(stands.entries), stands.missing) == (list(range(1, 10)), [])


def test_a_file_without_a_whole_entry_is_refused(found: Path, whole: bytes) -> None:
    for content in (b"", whole[:START]):
        with pytest.raises(RecordError, match="No entry"):
            _stands(found, content)


def test_a_file_of_a_form_to_come_is_refused(found: Path, whole: bytes) -> None:
    title = b"axiscal record 9"
    content = title + b" %08x\n" % zlib.crc32(title)
    with pytest.raises(NewerError, match="form 9"):
        _stands(found, content.ljust(BLOCK) + whole[BLOCK:])
