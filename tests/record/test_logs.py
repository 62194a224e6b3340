"""What a log keeps is read again, and what cannot follow is refused: a matrix of cases."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from axiscal.exceptions import OvertakenError, RecordError
from axiscal.record.events import Event, Finished, Noted, Undone
from axiscal.record.store import Record
from benchmarks.reliability.record_faults import CREATED, recorded


@pytest.fixture
def log(tmp_path: Path) -> Iterator[Record]:
    with Record.create(tmp_path / "mill.axiscal", CREATED) as record:
        yield record


WRONG: dict[str, list[Event]] = {
    "one good, one bad": [recorded(1e-6), Undone(7)],
    "behind the end": [Finished("done"), recorded(1e-6)],
}


@pytest.mark.parametrize("case", WRONG)
def test_what_cannot_follow_is_refused_whole(log: Record, case: str) -> None:
    before = log.rows
    with pytest.raises(RecordError, match="cannot follow"):
        log.append(*WRONG[case])
    assert log.rows == before
    with Record.open(log.path, write=False) as reader:
        assert reader.rows == before
    assert log.append(recorded(1e-6)) == 2


def test_of_two_that_know_the_same_one_wins_and_the_other_gets_a_sentence(log: Record) -> None:
    with Record.open(log.path) as other:
        one = log
        assert one.append(recorded(1e-6), after=1) == 2
        with pytest.raises(OvertakenError, match=r"Another process has written .* `axiscal step status`"):
            other.append(recorded(2e-6), after=1)
        assert other.append(recorded(3e-6), after=2) == 3
        assert one.append(recorded(4e-6)) == 4  # whoever does not say what he knows comes behind
        assert one.events() == other.events()


def test_what_is_opened_to_be_read_is_not_written(log: Record) -> None:
    with Record.open(log.path, write=False) as reader:
        with pytest.raises(RecordError, match="opened to be read"):
            reader.append(recorded(1e-6))
        log.append(recorded(1e-6))
        assert reader.last() == 2


def test_a_copy_of_either_is_the_same_record(log: Record, tmp_path: Path) -> None:
    log.append(recorded(1e-6))
    log.copy_to(tmp_path / "copy.axiscal")
    log.append(recorded(2e-6))
    log.copy_to(tmp_path / "copy.axiscal")
    assert not list(tmp_path.glob(".*.new"))
    with Record.open(tmp_path / "copy.axiscal") as copied:
        assert copied.events() == log.events()
        copied.append(Noted("by itself"))
    log.append(recorded(3e-6))  # as long, and another one
    with pytest.raises(RecordError, match="no earlier copy"):
        log.copy_to(tmp_path / "copy.axiscal")
