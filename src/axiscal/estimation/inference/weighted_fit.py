"""The estimate of all numbers of all readings at once, when each has its own precision.

The model is y = Φ z + v, z ~ N(0, 1), v ~ N(0, 1/d). Let D = diag(d) and M = 1 + Φᵀ D Φ. The estimate of Φ z is Φ M⁻¹
Φᵀ D y, its variance diag(Φ M⁻¹ Φᵀ).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.description.sizes import NONE_VARY
from axiscal.estimation.promise.problem import Inherited, problem
from axiscal.estimation.promise.spaces import turned
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array

WIDEST = 1e8
"""Times the noise: so wide a site says nothing."""
SHARE = 0.02
"""Share of the readings that chips or burrs shift: an assumption."""


class Fitted:
    """Numbers before any of them was read, and their estimate.

    features : (m, r) Φ; noise : (m,) σ²; values : (m,); reading : (m,) index of the reading of each number
    """

    def __init__(self, features: Array, noise: Array, values: Array, reading: NDArray[np.intp]) -> None:
        self._features, self.noise, self.values, self.reading = _short(features), noise, values, reading

    @classmethod
    def of(
        cls, observation: Observation, readings: Sequence[Reading], prior: tuple[Array, Array] | None = None
    ) -> Fitted:
        """Return the numbers of readings, by the stated model or another prior of the errors (mean, covariance)."""
        posed = problem(observation, readings, NONE_VARY, None if prior is None else Inherited(*prior), usual=False)
        stated = np.zeros(0)
        features = turned(posed, posed.rows, stated, [curves.roots(stated) for curves in posed.curves])
        return cls(features * posed.noise[:, None], posed.noise**2, posed.values * posed.noise, posed.reading)

    def covariance(self) -> Array:
        """Return the covariance of the numbers before any was read, noise included, (m, m)."""
        return self._features @ self._features.T + np.diag(self.noise)

    def estimate(self, values: Array, precisions: Array) -> tuple[Array, Array]:
        """Return mean and variance of the numbers without noise, (m,), if these values had these precisions 1/σ²."""
        information = np.eye(self._features.shape[1]) + (self._features.T * precisions) @ self._features
        spread = self._features @ np.asarray(np.linalg.inv(information), dtype=float)
        mean: Array = spread @ (self._features.T @ (precisions * values))
        return mean, np.einsum("mr,mr->m", spread, self._features)


def _short(features: Array) -> Array:
    """Return features with the same products of rows, no more of them than there are rows."""
    if features.shape[1] <= len(features):
        return features
    triangle: Array = np.asarray(np.linalg.qr(features.T, mode="r"))
    return triangle.T


class Sites(NamedTuple):
    """Normal readings in the place of others.  values, variances : (m,)"""

    values: Array
    variances: Array
