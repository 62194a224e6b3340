"""Before readings are doubted: where stations stand that nobody knows well, and how trackers are turned.

A distance or a tracker is linear only about the place that it is taken to have: about a place 100 mm or 20 mrad away,
good readings look bad. So the likelihood is brought in by shares, and the result polished with the original prior
(docs/nonlinear.md).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from axiscal.estimation.case import Case
from axiscal.estimation.progressive.bent_readings import BentReadings
from axiscal.estimation.progressive.polish import Optimum, polished
from axiscal.estimation.progressive.shares import shares
from axiscal.estimation.progressive.starts import closed_form
from axiscal.measurement.reading import Reading, drawn

_MOST = 200
"""Readings by which stations are found: of time; all of them count once these are found."""
_LINEAR = 0.3
"""Index of the worst reading under the prior below which one linearisation does."""


def progressed(case: Case, readings: Sequence[Reading], implausible: Collection[int]) -> Case:
    """Return the case linearised about the mode that its plausible readings show; as it was where that is linear."""
    kept = [reading for index, reading in enumerate(readings) if index not in implausible]
    if not case.bends or not kept:
        return case
    problem = BentReadings(case, drawn(kept, _MOST))
    prior = case.prior
    if float(np.max(problem.second_order(prior.mean, prior.factor), initial=0.0)) <= _LINEAR**2:
        return case
    return case.linear_about(mode(problem).point)


def mode(problem: BentReadings) -> Optimum:
    """Return the best optimum: from the way through the shares, from closed form and from the prior."""
    case, prior = problem.case, problem.case.prior.mean
    starts = [shares(problem)[-1].point, closed_form(case, problem.readings, prior)]
    return min((polished(problem, start) for start in starts), key=lambda found: found.cost)
