"""What readings leave as the formulas stand, on dense matrices: the truth that every fast way is tested against.

    C₊ = C − C Gᵀ (R + G C Gᵀ)⁻¹ G C          what is left after readings (B&H eq. 31-33)
    J  = tr(W C)                              what a plan makes small (B&H eq. 26, 36)

with the rows G of all numbers of the readings and R their noise; readings of one cell have its rest in common.
Nothing is kept, nothing is factorised: O(n³) for a single number.
"""

from typing import NamedTuple

import numpy as np

from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.numerics import Array


class DenseState(NamedTuple):
    """The map to readings, and the covariance C (n, n) of its unknowns."""

    observation: Observation
    covariance: Array


def after_readings(known: DenseState, places: Places) -> DenseState:
    """Return what is known after readings."""
    numbers = known.observation.numbers(places)
    crossed = known.covariance @ numbers.rows.T
    noise, rests = np.diag(numbers.noise**2), known.observation.rests
    for i, reach in enumerate(numbers.reach.T):  # of machines whose readings have no feet: a column for each rest
        alike = numbers.cell[:, i, None] == numbers.cell[:, i]
        noise += rests[i] ** 2 * alike * np.outer(reach, reach)
    lost: Array = crossed @ np.linalg.inv(noise + numbers.rows @ crossed) @ crossed.T
    return known._replace(covariance=known.covariance - lost)


def value(known: DenseState, gram: Array) -> float:
    """Return J.  gram : W (n, n), over the leading unknowns"""
    return float(np.trace(gram @ known.covariance[: len(gram), : len(gram)]))
