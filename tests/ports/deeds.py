"""Things to do for tests of the engines: they can be sent to another process by their names."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_info

from axiscal.exceptions import StudyError
from axiscal.ports.study.study_case import WorkItem

COUNT = 24


def doubled(number: int) -> dict[str, Any]:
    """Return twice a number, and what works on it."""
    threads = max(library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas")
    return {"twice": 2 * number, "process": os.getpid(), "threads": threads}


def doubled_slowly(number: int) -> dict[str, Any]:
    """Return twice a number, after a while, so that there is time to end somebody."""
    time.sleep(0.05)
    return {"twice": 2 * number}


def refusing_odd(number: int) -> dict[str, Any]:
    """Return twice an even number; one is wrong, others are a defect."""
    if number == 1:
        raise StudyError("one is wrong", "Take two")
    if number % 2:
        raise ZeroDivisionError("odd")
    return {"twice": 2 * number}


def ending_once(asked: tuple[int, str]) -> dict[str, Any]:
    """Return twice a number; where a file is named that is not there yet, end the process first, as a kill does."""
    number, marker = asked
    if marker and not Path(marker).exists():
        Path(marker).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return {"twice": 2 * number}


def ending_always(number: int) -> dict[str, Any]:
    """Return twice a number; with three, end every process that tries."""
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return {"twice": 2 * number}


def numbers(count: int = COUNT) -> list[WorkItem]:
    """Return so many numbers to double."""
    return [WorkItem(str(number), number) for number in range(count)]
