"""How long the next measurement and a whole plan take, and how good they are; seconds of the processor, one thread."""

from __future__ import annotations

import resource
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np

import axiscal_core as ac
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.scores import Scores
from axiscal.planning.plan.task import Limits
from axiscal_core.threads import one_thread
from benchmarks.cases import alone, five_axis, stacked
from benchmarks.peers.problems import CASES, CriterionName, Stacked


def one_at_a_time(posed: Stacked, volume: bool) -> tuple[float, float]:
    """Return the median seconds of a pick, and J after the last."""
    case = alone(posed)
    criterion: CriterionName = "volume" if volume else "joint"
    taken, seconds = ac.Places("s", np.zeros((0, posed.axes))), list[float]()
    for _ in range(posed.readings):
        start = time.process_time()
        taken = taken + case.next(taken, criterion)
        seconds.append(time.process_time() - start)
    return statistics.median(seconds), case.evaluate(taken, criterion=criterion).J


def timed(work: Callable[[], object]) -> float:
    """Return the shortest of five runs, s."""
    seconds = []
    for _ in range(5):
        start = time.process_time()
        work()
        seconds.append(time.process_time() - start)
    return min(seconds)


def picks() -> None:
    """Print the figures of one reading at a time, and of all together."""
    for case in CASES:
        for volume in (False, True):
            problem = stacked(case, 2000, volume)
            pick, value = one_at_a_time(case, volume)
            start = time.process_time()
            plan = make_plan(problem, Limits(readings=case.readings))
            whole = time.process_time() - start
            name = f"{case.name}, {'volume' if volume else 'joint'}"
            print(f"{name:36} pick {1e3 * pick:7.2f} ms, J {value:9.5f}   together {whole:6.2f} s, J {plan.value:9.5f}")


def fixed_candidates() -> None:
    """Print what a pick from a fixed lattice takes, beside the time its memory traffic needs."""
    for name, problem in (("(c), 2,000", stacked(CASES[2], 2000)), ("five axes, 100,000", five_axis(100_000))):
        scores = Scores(problem)
        pick = timed(lambda s=scores: s.put(int(s.gains.argmax())))  # type: ignore[misc]
        source = np.ones(scores.count * scores.width * problem.observation.size)
        copied = np.empty_like(source)
        copy = timed(lambda a=copied, b=source: np.copyto(a, b)) / 2  # type: ignore[misc]
        size = source.nbytes / 1e6
        print(f"{name} candidates: a pick {1e3 * pick:.2f} ms; fetching {size:.0f} MB once {1e3 * copy:.2f} ms")


def five_axes() -> None:
    """Print the figures of the five-axis machine with all error motions."""
    problem = five_axis(20_000)
    start = time.process_time()
    plan = make_plan(problem, Limits(readings=60))
    seconds = time.process_time() - start
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    print(f"five axes, 60 of 20,000 together: {seconds:.1f} s, {memory:.2f} GB at most, ", end="")
    print(f"root of J {1e6 * plan.value**0.5:.2f} um")


if __name__ == "__main__":
    with one_thread():
        picks()
        five_axes()
        fixed_candidates()
