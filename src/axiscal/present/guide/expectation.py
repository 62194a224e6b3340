"""What a reading should show before it is taken."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.estimation.estimation import Estimation
from axiscal.estimation.knowledge import block
from axiscal.measurement.place import Place
from axiscal.measurement.reading_rows import blank_readings
from axiscal.numerics import Array

BAND = 2.0
"""Standard deviations about the expectation that are shown; a matter of taste."""
SURPRISING = 4.0
"""Standard deviations from which a person is asked before a reading is kept: one in 16,000 by chance."""


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
    blanks = blank_readings(known.case.description.setups, [place])
    (found,) = block(known.knowledge, blanks, np.zeros(len(blanks), dtype=bool)).innovations
    return Expectation(-np.atleast_1d(found.value), np.atleast_1d(found.std))
