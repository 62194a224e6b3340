"""The file of a record by itself: whole at every moment, and no bit of it changes unseen."""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections.abc import Callable
from pathlib import Path

import pytest

from axiscal.exceptions import RecordError
from axiscal.record.events import Event
from axiscal.record.line_form import BLOCK, FORM, MARK, MARKS, START, Mark, head, mark_bytes, read_mark
from axiscal.record.store import Record
from tests.reliability.record_faults import CREATED, events, recorded


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "trial.axiscal"
    with Record.create(path, CREATED) as record:
        for number in range(3):
            record.append(recorded(1e-6 * number))
    return path


def test_what_was_not_acknowledged_is_left_out_and_written_over(path: Path) -> None:
    whole = events(path)
    with path.open("ab") as file:
        file.write(b"half a line of a reading that nobody has heard of" * 30)
    assert events(path) == whole
    with Record.open(path) as record:
        record.append(recorded(7e-6))
    assert events(path)[:-1] == whole
    assert path.read_bytes().count(b"nobody") == 0


def test_the_name_is_the_chain_of_kinds_and_contents(path: Path) -> None:
    name = 64 * "0"
    for line in path.read_bytes()[START:].splitlines():
        _, _, kind, rest = line.decode().split(" ", 3)
        payload = rest.rpartition(" ")[0]
        json.loads(payload)
        name = hashlib.sha256(f"{name} {kind} {payload}".encode()).hexdigest()
    with Record.open(path, write=False) as record:
        assert record.name == name


def test_several_events_are_there_together_or_not_at_all(path: Path) -> None:
    """One mark is gone and a transaction broke off: its whole lines are not taken without the others."""
    whole = events(path)
    batch: list[Event] = [recorded(1e-6 * number) for number in range(5)]
    with Record.open(path) as record:
        record.append(*batch)
    content = path.read_bytes()
    turns = [int(content[at:].split()[1]) for at in MARKS]
    newest = MARKS[turns.index(max(turns))]
    broken = content[:newest] + b"torn" + content[newest + 4 :]
    path.write_bytes(broken)
    assert len(events(path)) == len(whole) + 5
    path.write_bytes(broken[:-30])
    assert events(path) == whole


def test_a_record_that_was_moved_away_takes_nothing(path: Path, tmp_path: Path) -> None:
    with Record.open(path) as record:
        path.rename(tmp_path / "elsewhere.axiscal")
        with pytest.raises(RecordError, match="no longer here"):
            record.append(recorded(1e-6))


def test_an_older_copy_written_over_it_is_noticed(path: Path, tmp_path: Path) -> None:
    older = path.read_bytes()
    with Record.open(path) as record:
        record.append(recorded(1e-6))
        path.write_bytes(older)
        with pytest.raises(RecordError, match="older copy"):
            record.append(recorded(2e-6))
    assert path.read_bytes() == older


@pytest.mark.parametrize("chain", [63 * "0" + "1", 64 * "f"])
def test_another_record_of_as_many_turns_written_over_it_is_noticed(path: Path, chain: str) -> None:
    with Record.open(path) as record:
        content = path.read_bytes()
        marks = [each for at in MARKS if isinstance(each := read_mark(content[at:]), Mark)]
        mark = max(marks, key=lambda each: each.turn)
        for at in MARKS:
            content = content[:at] + mark_bytes(mark._replace(chain=chain)) + content[at + MARK :]
        path.write_bytes(content)
        with pytest.raises(RecordError, match="another record has been written over it"):
            record.last()


def test_head_and_marks_have_a_block_each(path: Path) -> None:
    """A disk that tears a write leaves the other blocks alone."""
    assert sorted({0, *(at // BLOCK for at in MARKS), START // BLOCK}) == [0, 1, 2, 3]
    with contextlib.closing(path.open("rb")) as file:
        assert file.read(17) == b"axiscal record 3 "


def test_a_record_of_the_second_form_goes_on_as_it_is(path: Path) -> None:
    second = head(2) + path.read_bytes()[BLOCK:]
    path.write_bytes(second)
    with Record.open(path) as record:
        record.append(recorded(4e-6))
    assert (path.read_bytes()[:BLOCK], len(events(path))) == (second[:BLOCK], 5)


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace(b"\n", b"\r\n"),
        lambda text: text.replace(b"\r\n", b"\n"),
        lambda text: text.replace(b"  ", b""),
    ],
)
def test_a_head_that_was_taken_for_text_says_so(path: Path, change: Callable[[bytes], bytes]) -> None:
    for form in (2, FORM):
        changed = change(head(form) + path.read_bytes()[BLOCK:])
        if changed[:BLOCK] != head(form):
            path.write_bytes(changed)
            with pytest.raises(RecordError, match=r"took it for text.*axiscal data salvage"):
                Record.open(path)
        else:
            assert form == 2


def test_who_writes_clears_what_a_writer_that_is_gone_left_and_who_reads_does_not(path: Path) -> None:
    left = path.with_name(f".{path.name}.{2**22 + 1}.new")  # no process has so large a number
    left.write_bytes(b"half a record")
    Record.open(path, write=False).close()
    assert left.exists()
    Record.open(path).close()
    assert not left.exists()
