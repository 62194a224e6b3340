"""Our own side: one reading at a time, from fixed candidates, and all together."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

import axiscal_core as ac
from axiscal.measurement.reading import Places
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.scores import Scores
from axiscal.planning.plan.task import Limits, Task
from benchmarks.cases import alone, stacked
from benchmarks.peers.problems import CANDIDATES, Array, Posed


def _problem(posed: Posed) -> Task:
    return stacked(posed.case, CANDIDATES, posed.criterion == "volume")


def picker(posed: Posed) -> Callable[[Array], Array]:
    """Return the next measurement, exactly, by the exact integral."""
    case, root = alone(posed.case), _problem(posed).root
    wanted = np.pad(root, ((0, 0), (0, case.size - root.shape[1])))  # the dial's zero, which is known

    def pick(taken: Array) -> Array:
        found: Array = case.next(ac.Places("s", taken) if len(taken) else None, wanted).poses[0]
        return found

    return pick


def candidate_picker(posed: Posed) -> Callable[[Array], Array]:
    """Return the best of the fixed candidates; the gains follow the reading that enters."""
    problem, poses = _problem(posed), posed.candidates
    lattice = Places(np.zeros(len(poses), dtype=np.intp), poses, np.ones_like(poses))
    problem = replace(problem, lattice=lattice)
    scores = Scores(problem)

    def pick(taken: Array) -> Array:
        best = int(scores.gains.argmax())
        scores.put(best)
        chosen: Array = poses[best]
        return chosen

    return pick


def planner(posed: Posed) -> Callable[[], Array]:
    """Return the whole plan as a user gets it, the lower bound included."""
    problem = _problem(posed)

    def plan() -> Array:
        return make_plan(problem, Limits(readings=posed.case.readings)).places.poses

    return plan
