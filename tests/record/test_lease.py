"""Two computers and one record on a share whose locks do not reach: one is refused, or what it wrote is beside it."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from axiscal.document import durable
from axiscal.exceptions import RecordError
from axiscal.record import lease
from axiscal.record.lease import OLD, lease_of
from axiscal.record.line_form import MARKS
from axiscal.record.store import Record
from tests.reliability import writers
from tests.reliability.record_faults import CREATED, recorded, values


@pytest.fixture
def path(tmp_path: Path) -> Path:
    Record.create(tmp_path / "mill.axiscal", CREATED).close()
    return tmp_path / "mill.axiscal"


@pytest.fixture
def on(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Return what puts this process on a computer; the locks of the share do nothing."""
    monkeypatch.setattr(durable, "_taken", lambda handle: True)
    return lambda name: monkeypatch.setattr(lease, "_computer", lambda: f"{name} 0")


def test_another_computer_is_refused_until_the_first_has_done_or_is_silent(
    path: Path, on: Callable[[str], None]
) -> None:
    on("bench")
    first = Record.open(path)
    first.append(recorded(1.0))
    on("laptop")
    with Record.open(path) as second:
        with pytest.raises(RecordError, match=r"on bench has been writing to this record since .* UTC"):
            second.append(recorded(2.0))
        os.utime(lease_of(path), (time.time() - 2 * OLD,) * 2)  # it went to sleep
        assert second.append(recorded(3.0)) == 3
        on("bench")
        with pytest.raises(RecordError, match="on laptop has been writing"):
            first.append(recorded(4.0))
        on("laptop")
    on("bench")
    assert first.append(recorded(5.0)) == 4
    first.close()
    assert values(path) == [1.0, 3.0, 5.0]
    assert not lease_of(path).exists()


def test_a_lease_of_a_process_that_is_gone_is_taken_by_its_computer(path: Path, on: Callable[[str], None]) -> None:
    on("bench")
    lease_of(path).write_text(f"bench 0\n{2**22 + 1}\n2026-03-01 08:00 UTC\nAnna\n")
    with Record.open(path) as record:
        assert record.append(recorded(1.0)) == 2
    lease_of(path).write_text("")  # a kill came before the name
    begin = time.monotonic()
    with Record.open(path) as record:
        assert record.append(recorded(2.0)) == 3
    assert 1 < time.monotonic() - begin < 6


@pytest.mark.parametrize("at", ["lines", "older mark", "newer mark"])
def test_what_reads_back_otherwise_is_kept_in_a_branch_and_overwrites_nothing(
    path: Path, at: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A cache that another computer writes over shows in one of three places."""
    with Record.open(path) as record:
        record.append(recorded(1.0))
        end, marks = record._mark.end, MARKS
        seen = {"lines": end, "older mark": record._older, "newer mark": marks[record._older == marks[0]]}[at]
        read = record._read_back
        other = lambda begin, size: b"x" * size if begin == seen else read(begin, size)  # noqa: E731
        monkeypatch.setattr(record, "_read_back", other)
        with pytest.raises(
            RecordError, match=r"written at the same place.*Record the readings of .*mill-[0-9a-f]{8}.axiscal"
        ):
            record.append(recorded(2.0))
    branch = next(each for each in path.parent.glob("mill-*.axiscal"))
    assert values(branch) == [1.0, 2.0]


def test_two_computers_at_once_lose_nothing_that_was_acknowledged() -> None:
    trial = writers.on_a_share(60)
    assert (trial.lost, trial.tried) == (0, 120), trial.detail
