"""Waiting for a file that another process holds: for a while, but never less than a fair number of looks."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator
from fcntl import LOCK_UN, flock
from pathlib import Path

import pytest

from axiscal.document import durable
from axiscal.document.durable import HeldError

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="two openings of one file by one process: POSIX only")


@pytest.fixture
def handles(tmp_path: Path) -> Iterator[tuple[int, int]]:
    """Yield one file, opened twice."""
    both = [os.open(tmp_path / "file", os.O_RDWR | os.O_CREAT) for _ in range(2)]
    yield both[0], both[1]
    for handle in both:
        os.close(handle)


def test_who_was_left_without_a_processor_for_seconds_looks_again(
    handles: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    seconds = iter(range(0, 10**9, 10))
    monkeypatch.setattr(time, "monotonic", lambda: float(next(seconds)))
    first, second = handles
    with durable.alone(first, 4.0):
        naps = 0

        def nap(_seconds: float) -> None:
            nonlocal naps
            naps += 1
            if naps == 20:
                flock(first, LOCK_UN)  # the other process ends

        monkeypatch.setattr(time, "sleep", nap)
        with durable.alone(second, 4.0):
            assert naps == 20


def test_a_file_that_stays_held_is_said_to_be(handles: tuple[int, int]) -> None:
    first, second = handles
    with durable.alone(first, 4.0), pytest.raises(HeldError), durable.alone(second, 0.01):
        pass
