"""The estimate of all numbers of all readings at once, when each reading has a weight.

y = Φ z + v, z ~ N(0, 1), v ~ N(0, σ²/w):  with D = diag(w/σ²) and M = 1 + Φᵀ D Φ the estimate of Φ z is Φ M⁻¹ Φᵀ D y,
its variance v = diag(Φ M⁻¹ Φᵀ). With M = L Lᵀ both come from X = L⁻¹ Φᵀ: 2 m r² + r³/3 operations, 16 m r bytes.
M⁻¹ is formed only where readings are taken out one by one.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy

import numpy as np
from numpy.typing import NDArray

from axiscal.inference.reading_set import ReadingSet
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import inverse_of_product, solution
from axiscal.numerics.gaussian import lower_root


class Fitted:
    """Numbers, their estimate, and how much they surprise.

    features : (m, r) Φ; noise : (m,) σ²; values : (m,); reading : (m,) index of the reading of each number
    left : (m,) values minus estimate; spread : (m,) variances v
    """

    def __init__(self, features: Array, noise: Array, values: Array, reading: NDArray[np.intp]) -> None:
        self._features, self.noise, self.values, self.reading = _short(features), noise, values, reading
        self._lower: Array = np.eye(self._features.shape[1])
        self._inverse: Array | None = None
        self._trust = 1.0 / noise
        self.left, self.spread = values.copy(), np.sum(self._features**2, axis=1)

    @classmethod
    def of(
        cls, observation: Observation, readings: Sequence[Reading], prior: tuple[Array, Array] | None = None
    ) -> Fitted:
        """Return the numbers of readings, by the stated model or another prior of the errors (mean, covariance)."""
        numbers, size = ReadingSet(observation, readings), observation.errors.size
        values, root = numbers.values, observation.errors.prior_root() if prior is None else _root(prior[1])
        if prior is not None:
            values = values - numbers.rows[:, :size] @ prior[0]
        return cls(numbers.features(root), numbers.noise + numbers.extra_variance, values, numbers.reading)

    def covariance(self) -> Array:
        """Return the covariance of the numbers before any was read, noise included, (m, m)."""
        return self._features @ self._features.T + np.diag(self.noise)

    def estimate(self, values: Array, precisions: Array) -> tuple[Array, Array]:
        """Return mean and variance of the numbers without noise, (m,), if these values had these precisions 1/σ²."""
        information = np.eye(self._features.shape[1]) + (self._features.T * precisions) @ self._features
        spread = self._features @ np.asarray(np.linalg.inv(information), dtype=float)
        mean: Array = spread @ (self._features.T @ (precisions * values))
        return mean, np.einsum("mr,mr->m", spread, self._features)

    def weigh(self, weights: Array) -> None:
        """Estimate with a weight for each reading, (readings,)."""
        self._trust = weights[self.reading] / self.noise
        scaled = self._features * np.sqrt(self._trust)[:, None]
        self._lower, self._inverse = lower_root(np.eye(scaled.shape[1]) + scaled.T @ scaled), None
        half = solution(self._lower, self._features.T)
        self.left = self.values - (half @ (self._trust * self.values)) @ half
        self.spread = np.einsum("rm,rm->m", half, half)

    def without(self, reading: int) -> Fitted:
        """Return the estimate without one reading, by a correction of rank one for each of its numbers."""
        if self._inverse is None:
            self._inverse = inverse_of_product(self._lower)
        other, inverse = copy(self), self._inverse.copy()
        other._inverse, other._trust = inverse, self._trust.copy()
        for number in np.flatnonzero(self.reading == reading):
            other._drop(int(number), inverse)
        return other

    def _drop(self, number: int, inverse: Array) -> None:
        gain = inverse @ self._features[number]
        along = self._features @ gain
        factor = self._trust[number] / (1.0 - self._trust[number] * self.spread[number])
        inverse += factor * np.outer(gain, gain)
        self.left = self.left + factor * self.left[number] * along
        self.spread = self.spread + factor * along**2
        self._trust[number] = 0.0

    @property
    def surprise(self) -> Array:
        """How far each number is from what the others predict, in standard deviations, signed, (m,)."""
        open_part = np.maximum(1.0 - self.spread * self._trust, 1e-12)
        surprise: Array = self.left / open_part / np.sqrt(self.spread / open_part + self.noise)
        return surprise


def _short(features: Array) -> Array:
    """Return features with the same products of rows, no more of them than there are rows."""
    if features.shape[1] <= len(features):
        return features
    triangle: Array = np.linalg.qr(features.T, mode="reduced")[1]
    return triangle.T


def _root(covariance: Array) -> Array:
    """Return F with F Fᵀ the covariance."""
    values, vectors = np.linalg.eigh(covariance)
    root: Array = vectors * np.sqrt(np.maximum(values, 0.0))
    return root
