"""A case of a study: one virtual machine, measured in one way. It carries all that it is a function of.

As work it can go to another process: a question with its key, and what came of it.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Generator, Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

from axiscal.exceptions import AxiscalError
from axiscal.language.stages import listening


class Stop(NamedTuple):
    """When a case ends: after so many readings, or so much time, s; with neither, at the target of the campaign."""

    readings: int | None = None
    budget: float | None = None


@dataclass(frozen=True, slots=True)
class Variant:
    """One way of measuring, as texts, so that it can go to another process.

    choices : JSON of the values of the grid, by key
    campaign, machine, truth : texts; of `truth` the errors are drawn; names : what failures call campaign and machine
    prior : text of the campaign or type whose result is the prior, or ""
    setups : those that are used, None for all
    """

    choices: str
    campaign: str
    machine: str
    truth: str
    names: tuple[str, str]
    prior: str
    setups: tuple[str, ...] | None
    stop: Stop


@dataclass(frozen=True, slots=True)
class StudyCase:
    """One machine of one variant.  seed : of the study; machine : its number from 0"""

    variant: Variant
    seed: int
    machine: int

    @property
    def key(self) -> str:
        """Name of the case as canonical JSON; with the texts it determines the outcome."""
        return key_of(json.loads(self.variant.choices), self.machine)


def key_of(choices: dict[str, Any], machine: int) -> str:
    """Return the key of a case: values of the grid, number of the machine."""
    return canonical({"grid": choices, "machine": machine})


def canonical(value: Any) -> str:
    """Return the one JSON text of a value."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)


class KeptFigure(NamedTuple):
    """column : of the table of results; words : what it is; unit : as printed"""

    column: str
    words: str
    unit: str = ""


FIGURES = {
    "readings": KeptFigure("readings", "readings"),
    "minutes": KeptFigure("minutes", "minutes of machine time", "min"),
    "rms": KeptFigure("rms_um", "RMS promised", "µm"),
    "worst": KeptFigure("worst_um", "worst place promised", "µm"),
    "U": KeptFigure("U_um", "U, expanded uncertainty in space", "µm"),
    "true_rms": KeptFigure("true_rms_um", "RMS that is true", "µm"),
    "true_worst": KeptFigure("true_worst_um", "worst place that is true", "µm"),
    "within_U": KeptFigure("within_U", "share of the volume within U"),
    "coverage_curves": KeptFigure("coverage_curves", "share of the curves in their bands"),
    "coverage_tcp": KeptFigure("coverage_tcp", "share of the tool point in its band"),
    "agreement": KeptFigure("agreement", "whether the readings agree"),
    "said": KeptFigure("said", "warnings"),
    "reached": KeptFigure("reached", "target reached"),
}
"""By the name that a study file has for it."""


Solve = Callable[[Any], dict[str, Any]]
"""A pure function of a question that can be pickled; its result can be written as JSON."""


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
    """Something that works: in this process, or in some of this computer."""

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
