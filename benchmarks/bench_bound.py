"""How much of the distance between a plan and its bound is the bound's, and how much the plan's: root of J, um."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np

from axiscal.estimation.belief import Belief
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.numerics import Array
from axiscal.planning.bound.certificate import rank_bound
from axiscal.planning.bound.lower_bound import lower_bound, settling
from axiscal.planning.bound.relaxation import Relaxation
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.running_gains import Scores
from axiscal.planning.plan.exchange import exchange
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.task import Limits, Task
from axiscal_core.threads import one_thread
from benchmarks.cases import five_axis

STARTS = 6


def root(value: float) -> str:
    """Return the root of J in um."""
    return f"{1e6 * value**0.5:7.3f}"


def random_starts(problem: Task, pool: Pool, readings: int) -> float:
    """Return the best J of exchanges from random plans."""
    generator, base, found = np.random.default_rng(0), Scores(pool, problem.state), []
    for _ in range(STARTS):
        scores = base.fork()
        for index in generator.choice(len(pool), readings, replace=False):
            scores.enter(int(index))
        exchange(scores)
        found.append(scores.state.value)
    return min(found)


def parts(problem: Task, pool: Pool, places: Places) -> tuple[float, float, float]:
    """Return the bounds by rank, by the equivalence theorem, and by both together; places : of a good plan."""
    readings = len(places)
    relaxation = Relaxation(pool, problem.state, places, np.ones(len(pool) + readings), float(readings))
    steps = list(settling(relaxation))
    whole = max(step.dual.whole - step.spent for step in steps)
    return rank_bound(problem.state, readings), max(whole, 0.0), steps[-1].dual.floor(steps[-1].spent, readings)


def sizes() -> None:
    """Print plans and bounds of the five-axis machine for a few numbers of readings."""
    problem = five_axis(4000)
    pool = Pool(problem.observation, problem.lattice)
    print("five axes, 4,000 candidates; root of J, um")
    print("readings  lattice  random   off it   by rank  by theorem  both     with zeros  ratio")
    for readings in (5, 20, 60, 120):
        plan = make_plan(problem, Limits(readings=readings), patience=0.0, bounded=False)
        off = make_plan(problem, Limits(readings=readings), patience=1e9)
        by_rank, by_theorem, together = parts(problem, pool, off.places)
        print(f"{readings:8}  {root(plan.value)}  {root(random_starts(problem, pool, readings))}", end="")
        print(f"  {root(off.value)}  {root(by_rank)}  {root(by_theorem):>10}  {root(together)}", end="")
        print(f"  {root(off.bound.value if off.bound else 0.0):>10}  {off.ratio**0.5:.3f}", flush=True)


def exact() -> None:
    """Print the best plan there is, by looking at all of them, beside the plan and its bound."""
    problem = five_axis(150)
    pool = Pool(problem.observation, problem.lattice)
    print("five axes, 150 candidates: every plan of them looked at; root of J, um")
    print("readings  the best     plan    bound")
    for readings in (1, 2, 3):
        plan = make_plan(problem, Limits(readings=readings), patience=0.0, bounded=False)
        bound = lower_bound(pool, problem.state, pool.lattice.within(slice(0, 0)), np.ones(len(pool)), float(readings))
        best = best_of_all(Scores(pool, problem.state), readings)
        print(f"{readings:8}   {root(best)}  {root(plan.value)}  {root(bound.value)}", flush=True)


def best_of_all(scores: Scores, readings: int, start: int = 0) -> float:
    """Return the smallest J of all plans, readings repeated included."""
    if readings == 1:
        return scores.state.value - float(scores.gains[start:].max())
    found = []
    for index in range(start, len(scores.pool)):
        more = scores.fork()
        more.enter(index)
        found.append(best_of_all(more, readings - 1, index))
    return min(found)


def causes() -> None:
    """Print the ratio where the zeros of the set-ups are known, and where there are no rests."""
    problem = five_axis(2000)
    machine = problem.observation.machine
    bare = replace(machine, errors=tuple(replace(error, rest=None) for error in machine.errors))
    known = tuple(replace(setup, unknowns=()) for setup in problem.observation.setups)
    print("five axes, 2,000 candidates: what set-ups and rests do; root of J, um")
    for readings in (5, 20, 60):
        for name, asked in (
            ("as it is", problem),
            (
                "no rests",
                changed(problem, Observation(type(problem.observation.errors)(bare), problem.observation.setups)),
            ),
            ("zeros known", changed(problem, Observation(problem.observation.errors, known))),
        ):
            plan = make_plan(asked, Limits(readings=readings), patience=0.0)
            bound = plan.bound.value if plan.bound else 0.0
            print(
                f"{readings:8}  {name:12} plan {root(plan.value)}  bound {root(bound)}  ratio {plan.ratio**0.5:.3f}",
                flush=True,
            )


def changed(problem: Task, observation: Observation) -> Task:
    """Return the problem with another observation, before the first reading."""
    covariance: Array = observation.prior_covariance()
    return replace(problem, observation=observation, belief=Belief(np.zeros(len(covariance)), covariance))


if __name__ == "__main__":
    with one_thread():
        exact()
        sizes()
        causes()
