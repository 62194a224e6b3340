"""Let one library solve one problem, in its own environment: prints one line of JSON, the last on its output.

python -m benchmarks.peers.worker trieste a joint
"""

from __future__ import annotations

import gc
import importlib
import json
import resource
import sys
import time
from importlib.metadata import version
from typing import Any

import numpy as np

from benchmarks.peers.field import Rival, rival_of
from benchmarks.peers.problems import CRITERIA, Array, Posed, case_of

_LEAST, _MOST = 1.0, 4.0
"""Seconds of picks after which nobody is asked again, and seconds with what prepares them."""

_LONG = 0.3


class Stopwatch:
    """Seconds of the processor, all threads of the process together, and seconds that passed."""

    def __init__(self) -> None:
        self.processor: list[float] = []
        self.passed: list[float] = []

    def __enter__(self) -> None:
        self._start = time.process_time(), time.perf_counter()

    def __exit__(self, *_: object) -> None:
        self.processor.append(time.process_time() - self._start[0])
        self.passed.append(time.perf_counter() - self._start[1])


def solve(rival: Rival, posed: Posed) -> dict[str, Any]:
    """Return positions and times of a library on a problem; who is quick does it again."""
    prepare = getattr(importlib.import_module(f"benchmarks.peers.rivals.{rival.module}"), rival.entry)
    watch, began = Stopwatch(), time.process_time()
    positions = _solved(prepare(posed), rival, posed, watch)
    while sum(watch.processor) < _LEAST and time.process_time() - began < _MOST:
        _solved(prepare(posed), rival, posed, watch)
    return {
        "positions": np.asarray(positions, dtype=float).tolist(),
        "processor": watch.processor,
        "passed": watch.passed,
        "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024,
        "versions": {name: version(name) for name in rival.distributions},
    }


def _solved(work: Any, rival: Rival, posed: Posed, watch: Stopwatch) -> Array:
    positions = np.zeros((0, posed.case.axes))
    if rival.together:
        with watch:
            found: Array = work()
        return found
    for _ in range(posed.case.readings):
        positions = _one_more(work, positions, watch)
    return positions


def _one_more(pick: Any, taken: Array, watch: Stopwatch) -> Array:
    """Return the positions with one more; what a long pick left behind is no part of the next one."""
    if watch.processor and watch.processor[-1] > _LONG:
        gc.collect()
    with watch:
        position = pick(taken)
    return np.concatenate([taken, np.asarray(position, dtype=float)[None]])


def main() -> None:
    """Solve what the command line names."""
    key, letter, wanted = sys.argv[1:4]
    criterion = next(name for name in CRITERIA if name == wanted)
    outcome = solve(rival_of(key), Posed(case_of(letter), criterion))
    sys.stdout.write("\n" + json.dumps(outcome) + "\n")


if __name__ == "__main__":
    main()
