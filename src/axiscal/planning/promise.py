"""How well a machine will be known after a plan and at best, and what the plan rests on."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np

from axiscal.estimation.case import Case, Knowledge, timed
from axiscal.estimation.judged import Doubt
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
_FIRST, _GROWTH = 5, 1.34
_AS_STATED = 1.2
"""By this factor a reading's own std may differ from its set-up's noise before it tells more or less than planned."""


def plan_basis(case: Case, readings: Sequence[Reading], doubts: Sequence[Doubt]) -> str:
    """Return what a plan made now rests on beside where readings were taken, in words; empty for nothing.

    Where a zero drifts it rests on the clock as well: markers are due by it.
    doubts : readings that are not believed
    """
    noise = {setup.name: setup.noise for setup in case.description.setups}
    said = [f"sizes of {count} readings"] if len(case.sizes) and (count := _learnt_from(len(readings))) else []
    said += [f"{doubt.reading + 1} rejected" for doubt in doubts]
    passed = int(max((reading.time or 0.0 for reading in readings), default=0.0) // EVERY)
    if passed and any(setup.drift > 0 for setup in case.description.setups):
        said.append(f"{passed} times {EVERY / 60:.0f} min")
    stds = ((n, r.std / noise[r.setup]) for n, r in enumerate(readings, 1) if r.std is not None)
    other = [n for n, times in stds if not 1 / _AS_STATED < times < _AS_STATED]
    return ", ".join([*said, *(f"noise of {number}" for number in other)])


def rejected(basis: str) -> frozenset[int]:
    """Return the indices of the readings that are not believed.  basis : of `plan_basis`"""
    return frozenset(int(number) - 1 for number in re.findall(r"(\d+) rejected", basis))


def _learnt_from(count: int) -> int:
    """Return the last number of readings, by a third more each time, after which sizes make a plan anew."""
    due, following = 0, _FIRST
    while following <= count:
        due, following = following, math.ceil(following * _GROWTH)
    return due
