"""Trials of virtual machines, each kept as a line of JSON: a run goes on where the one before was stopped."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from dataclasses import dataclass
from itertools import islice, takewhile
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from benchmarks.trust.sources import ROOT, version

KEPT = ROOT / "build" / "trust"

Trial = tuple[Any, ...]
"""What one machine is made from, as JSON has it."""
Found = Mapping[str, Any]
"""The figures of a trial; None stands for what is no number."""
Solve = Callable[[Any], Found]
"""A pure function of a trial, which another process can find by its name."""
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
        """Return all that is kept once what is missing of some trials has been tried, as far as the time goes."""
        until = time.monotonic() + self.seconds
        file = self.folder / self.part / f"{version(self.beside)}.jsonl"
        file.parent.mkdir(parents=True, exist_ok=True)
        known = file.read_text(encoding="utf-8").splitlines(keepends=True) if file.exists() else []
        whole = [line for line in known if line.endswith("\n")]  # one that was torn is tried again
        kept = {tuple(trial): figures for trial, figures in map(json.loads, whole)}
        missing = (trial for trial in trials if tuple(trial) not in kept)
        with file.open("w", encoding="utf-8", buffering=1) as lines:
            lines.writelines(whole)
            for trial, figures in self._worked(solve, takewhile(lambda _: time.monotonic() < until, missing)):
                print(json.dumps([trial, figures]), file=lines)
                kept[tuple(trial)] = figures
        return kept

    def _worked(self, solve: Solve, trials: Iterable[Trial]) -> Iterator[tuple[Trial, Found]]:
        """Yield what comes of trials, as it comes."""
        if self.processes == 1:
            yield from ((trial, solve(trial)) for trial in trials)
            return
        coming = iter(trials)
        with ProcessPoolExecutor(self.processes, get_context("spawn")) as pool:
            running = {pool.submit(solve, trial): trial for trial in islice(coming, self.processes)}
            while running:
                for done in wait(running, return_when=FIRST_COMPLETED).done:
                    yield running.pop(done), done.result()
                    running |= {pool.submit(solve, trial): trial for trial in islice(coming, 1)}

    def __call__(self, solve: Solve, trials: Sequence[Trial]) -> list[Found]:
        """Return the figures of trials in their order, however long it takes."""
        found = self.found(solve, trials)
        return [found[trial] for trial in trials]
