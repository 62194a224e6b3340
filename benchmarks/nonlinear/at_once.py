"""Four tracers at once and four in turn: plans of as many distances, the time they take, and what is then missed."""

from __future__ import annotations

import numpy as np

from axiscal.design.plan.task import Limits
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.measurement.reading import Reading
from axiscal.planning.proposal import proposed
from axiscal.simulation import Simulator
from benchmarks.nonlinear.stations import judged

_MACHINES = 20


def figures(case: Case, readings: int) -> tuple[float, float, float]:
    """Return seconds of a plan without mounting, the RMS that it promises and the median of what is missed, m."""
    description = case.description
    plan = proposed(case, Limits(readings), guard=False, bounded=False).plan
    mounted = {int(index) for index in plan.places.setups}
    seconds = plan.seconds - sum(description.setups[index].setup_time for index in mounted)
    missed = []
    for seed in range(_MACHINES):
        machine, rng = Simulator(description.machine, description.setups).drawn(seed), np.random.default_rng(seed)
        taken = []
        for index, pose, sides in zip(plan.places.setups, plan.places.poses, plan.places.approaches, strict=True):
            setup, at, side = description.setups[index], tuple(pose.tolist()), tuple(int(s) for s in sides)
            value, *others = machine.read_all(setup, at, side, rng)
            taken.append(Reading(setup.name, at, side, value, others=tuple(others), time=0.0))
        missed.append(judged(case, machine, concluded(case, taken).knowledge.belief).missed)
    return seconds, plan.accuracy.rms, float(np.median(missed))
