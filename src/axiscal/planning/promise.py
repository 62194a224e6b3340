"""How well a machine will be known after a plan and at best."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.estimation.case import Case, Knowledge, timed
from axiscal.estimation.promise.problem import problem
from axiscal.exceptions import PlanError
from axiscal.measurement.reading import Place, Reading
from axiscal.measurement.reading_rows import blank_readings
from axiscal_core.normal import Normal
from axiscal_core.unknowns import space_of

FEW = 6
"""Readings planned at once where likely sizes alone reach a target, or fall short of it: then it is looked at again."""


def foreseen(case: Case, readings: Sequence[Reading], places: Sequence[Place]) -> Knowledge:
    """Return what readings and those to come would make known, with all that a result counts, at the case's sizes.

    places : of the readings to come, whatever they will show
    It includes type B errors, such as that of a laser's wavelength, and what wanders with time; J leaves them out.
    Raises PlanError.
    """
    every = [*readings, *blank_readings(case.description.setups, places)]
    if not every:
        return case.knowledge
    together = timed(case, every).readings
    posed = problem(case.observation, together, case.sizes, case.inherited, case.description.usual)
    found = space_of(posed).given(np.zeros(len(posed.sizes)))
    if found is None:
        raise PlanError("the stated sizes differ by more than 15 digits", "Look at the std of errors and unknowns")
    answer = found.posterior()
    return Knowledge(case.observation, Normal(answer.mean, (answer.covariance + answer.covariance.T) / 2))


EVERY = 1200.0
"""Seconds of machine time between two readings of a marker: a third of the hour over which a drift keeps its rate."""
