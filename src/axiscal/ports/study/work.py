"""Work that can go to any process: a question with its key, and what came of it."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Generator, Iterable
from typing import Any, NamedTuple, Protocol

from axiscal.exceptions import AxiscalError
from axiscal.numerics.stages import listening

Solve = Callable[[Any], dict[str, Any]]
"""A pure function of a question that can be pickled; its result can be written as JSON."""

TRIES = 4
"""Processes that one question may bring to their end before it is given up: the first and three more."""


class WorkItem(NamedTuple):
    """asked : what `Solve` is given"""

    key: str
    asked: Any


class Done(NamedTuple):
    """result : None where there is an error instead, in words"""

    key: str
    result: dict[str, Any] | None
    error: str = ""


class Engine(Protocol):
    """Something that works: in this process, in some on this computer, or on many computers."""

    def __call__(self, solve: Solve, questions: Iterable[WorkItem]) -> Generator[Done]:
        """Yield what comes of questions, in any order."""


def answered(solve: Solve, question: WorkItem) -> Done:
    """Return what comes of a question; whatever is wrong with it is kept, and others go on."""
    try:
        return Done(question.key, solve(question.asked))
    except AxiscalError as fault:
        return Done(question.key, None, str(fault))
    except Exception as fault:  # noqa: BLE001 - a defect in one case of thousands is a row of the table
        return Done(question.key, None, f"a defect in axiscal: {type(fault).__name__}: {fault}")


def given_up(question: WorkItem) -> Done:
    """Return what is kept of a question that ends every process that works on it."""
    return Done(question.key, None, f"the process that worked on it ended without a word, {TRIES} times")


def here(solve: Solve, questions: Iterable[WorkItem]) -> Generator[Done]:
    """Yield what comes of questions, worked on in this process."""
    for question in questions:
        with listening(None):  # which case it is counts, not what is done in it
            found = answered(solve, question)
        yield found


def processors_here() -> int:
    """Return how many processors this process may use."""
    if sys.platform == "linux":
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
