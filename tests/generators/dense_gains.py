"""What readings leave as the formulas stand, on dense matrices: the truth that every fast way is tested against.

    C₊ = C − C Gᵀ (R + G C Gᵀ)⁻¹ G C          what is left after readings (B&H eq. 31-33)
    J  = tr(W C)                              what a plan makes small (B&H eq. 26, 36)

with the rows G of all numbers of the readings and R, diagonal, their noise. The rest of a cell is a separate unknown
from the first reading in it on. Nothing is kept, nothing is factorised: O(n³) for a single number.
"""

from typing import NamedTuple

import numpy as np

from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.measurement.reading_rows import rows_at, visited
from axiscal.numerics import Array


class DenseState(NamedTuple):
    """The map to readings, and the covariance C (n, n) of its unknowns."""

    observation: Observation
    covariance: Array


def opened(known: DenseState, places: Places) -> DenseState:
    """Return the same with the rests of the cells that places lie in, each independent of all else."""
    wider, size = visited(known.observation, places), known.observation.size
    covariance = np.zeros((wider.size, wider.size))
    covariance[:size, :size] = known.covariance
    covariance[size:, size:] = np.diag(known.observation.rest_variances(wider))
    return DenseState(wider, covariance)


def after_readings(known: DenseState, places: Places) -> DenseState:
    """Return what is known after readings."""
    before = opened(known, places)
    rows, noise, _ = rows_at(before.observation, places)
    crossed = before.covariance @ rows.T
    lost: Array = crossed @ np.linalg.inv(np.diag(noise) + rows @ crossed) @ crossed.T
    return before._replace(covariance=before.covariance - lost)


def value(known: DenseState, gram: Array) -> float:
    """Return J.  gram : W (n, n), over the leading unknowns"""
    return float(np.trace(gram @ known.covariance[: len(gram), : len(gram)]))
