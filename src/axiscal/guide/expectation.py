"""What a reading should show before it is taken."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.estimation.estimation import Estimation
from axiscal.estimation.knowledge import block
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array


@dataclass(frozen=True, eq=False, slots=True)
class Expectation:
    """mean, std : (k,) of each number of the reading, its noise included, m or rad"""

    mean: Array
    std: Array

    def surprise(self, values: Array) -> float:
        """Return by how many standard deviations the most surprising of the numbers is away.  values : (k,)"""
        return float(np.max(np.abs(values - self.mean) / self.std))


def expectation(known: Estimation, place: Place) -> Expectation:
    """Return what the readings so far say of the next one: ŷ = h·m and s² = h C hᵀ + rests + σ² (method.md 2)."""
    case, knowledge = known.banded
    values = INSTRUMENTS[case.description.setup(place.setup).instrument].values
    blank = Reading(place.setup, place.pose, place.approach, 0.0, others=(0.0,) * (values - 1))
    (innovation,) = block(knowledge, [blank], np.zeros(1)).innovations
    return Expectation(-np.atleast_1d(innovation.value), np.atleast_1d(innovation.std))
