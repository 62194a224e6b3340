"""Our own side: one reading at a time, from fixed candidates, and all together."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from axiscal.estimation.knowledge import Knowledge
from axiscal.measurement.reading import Places
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.running_gains import Scores
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.task import Limits, Task
from axiscal.planning.step.best_step import best_step
from benchmarks.cases import stacked
from benchmarks.peers.problems import CANDIDATES, Array, Posed


def _problem(posed: Posed) -> Task:
    return stacked(posed.case, CANDIDATES, posed.criterion == "volume")


def picker(posed: Posed) -> Callable[[Array], Array]:
    """Return the next measurement, exactly; the belief follows the readings taken."""
    problem = _problem(posed)
    observation, belief, known = problem.observation, problem.belief, 0

    def pick(taken: Array) -> Array:
        nonlocal belief, known
        if len(taken) > known:
            seen = observation.rows(0, taken[known:], np.ones_like(taken[known:]))
            belief, known = belief.update(seen.rows, np.zeros(len(seen.rows)), seen.variances), len(taken)
        return best_step(Knowledge(observation, belief), problem.root, problem.lattice).pose

    return pick


def candidate_picker(posed: Posed) -> Callable[[Array], Array]:
    """Return the best of the fixed candidates; the gains follow the reading that enters."""
    problem, poses = _problem(posed), posed.candidates
    lattice = Places(np.zeros(len(poses), dtype=np.intp), poses, np.ones_like(poses))
    problem = replace(problem, lattice=lattice)
    scores = Scores(Pool(problem.observation, lattice), problem.state)

    def pick(taken: Array) -> Array:
        best = int(scores.gains.argmax())
        scores.enter(best)
        chosen: Array = poses[best]
        return chosen

    return pick


def planner(posed: Posed) -> Callable[[], Array]:
    """Return the whole plan as a user gets it, the lower bound included."""
    problem = _problem(posed)

    def plan() -> Array:
        return make_plan(problem, Limits(readings=posed.case.readings)).places.poses

    return plan
