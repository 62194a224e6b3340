"""Four tracers at once and four in turn: plans of as many distances, the time that they take and what they promise."""

from __future__ import annotations

from axiscal.design.plan.task import Limits
from axiscal.estimation.case import Case
from axiscal.planning.proposal import proposed


def figures(case: Case, readings: int) -> tuple[float, float]:
    """Return seconds of a plan without mounting, and the RMS that it promises, m."""
    setups = case.description.setups
    plan = proposed(case, Limits(readings), bounded=False).plan
    mounted = {int(index) for index in plan.places.setups}
    return plan.seconds - sum(setups[index].setup_time for index in mounted), plan.accuracy.rms
