"""Trials of virtual machines, worked on by the engine of studies: a run goes on where the one before was stopped."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from typing import Any

from axiscal.campaign.possible import versions
from axiscal.exceptions import StudyError
from axiscal.ports.study.results import Processes, Results, run_missing
from axiscal.ports.study.study_case import Engine, Solve, WorkItem, canonical, here
from benchmarks.trust.sources import ROOT, version

KEPT = ROOT / "build" / "trust"

Trial = tuple[Any, ...]
"""What one machine is made from, as JSON has it."""
Found = Mapping[str, Any]
"""The figures of a trial; None stands for what is no number."""
Tried = Callable[[Solve, Sequence[Trial]], Iterable[Found]]
"""What makes the figures of trials, in their order, by a function of one of them."""


def one_by_one(solve: Solve, trials: Sequence[Trial]) -> Iterable[Found]:
    """Yield the figures of trials, made here and now; nothing is kept."""
    return map(solve, trials)


@dataclass(frozen=True)
class Keeping:
    """What keeps trials.

    part : of the page; beside : the files that trials are made by, whose contents name the outcomes beside the sources
    processes : that work at once; seconds : after which no more trials are begun
    """

    part: str
    beside: Sequence[Path]
    processes: int = 1
    seconds: float = math.inf
    folder: Path = KEPT

    def found(self, solve: Solve, trials: Sequence[Trial]) -> dict[Trial, Found]:
        """Return all that is kept once what is missing of some trials has been tried, as far as the time goes.

        Raises StudyError where one could not be tried.
        """
        until = time.monotonic() + self.seconds
        begun = takewhile(lambda _: time.monotonic() < until, trials)
        items = (WorkItem(canonical(list(trial)), trial) for trial in begun)
        name = version(self.beside)
        folder = self.folder / self.part / name
        engine: Engine = Processes(self.processes) if self.processes > 1 else here
        with Results(folder, self.part, name, versions(), resume=True) as results:
            run_missing(results, items, len(trials), solve, engine)
            found = results.found
        if wrong := next((done for done in found.values() if done.result is None), None):
            raise StudyError(f"{wrong.key} could not be tried: {wrong.error}", f"Mend it, and remove {folder}")
        return {tuple(json.loads(key)): done.result or {} for key, done in found.items()}

    def __call__(self, solve: Solve, trials: Sequence[Trial]) -> list[Found]:
        """Return the figures of trials in their order, however long it takes."""
        found = self.found(solve, trials)
        return [found[trial] for trial in trials]
