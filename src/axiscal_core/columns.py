"""Columns whose prior depends on a length that readings may teach, and those that add to curves."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal_core.refusals import Array
from axiscal_core.splines import matern, matern_by_length
from axiscal_core.theta import Kind

NUGGET = 1e-9
"""Added to correlations of one: long lengths make knots nearly equal, and Cholesky needs more than rounding."""


@dataclass(frozen=True, eq=False)
class Bent(ABC):
    """Columns whose prior depends on a length.  columns : (f, k); length_at : (f,) number of θ, −1 for none"""

    columns: NDArray[np.intp]
    length_at: NDArray[np.intp]

    @abstractmethod
    def roots(self, theta: Array) -> Array:
        """Return L with L Lᵀ the prior, (f, k, k)."""

    @abstractmethod
    def bends(self, theta: Array, roots: Array) -> Array:
        """Return M = L⁻¹ (∂ prior/∂log l) L⁻ᵀ, (f, k, k)."""


@dataclass(frozen=True, eq=False)
class Curves(Bent):
    """Curves with as many knots and one smoothness, whose control values go together by their distance.

    stds, lengths : (f,) as stated; apart : (f, k, k) between knots
    """

    smoothness: float
    stds: Array
    lengths: Array
    apart: Array

    def scaled(self, theta: Array) -> Array:
        """Return the distances in correlation lengths, (f, k, k)."""
        factors = np.exp(np.append(theta, 0.0)[self.length_at])
        return np.asarray(self.apart / (self.lengths * factors)[:, None, None])

    def roots(self, theta: Array) -> Array:
        """Return L with L Lᵀ = s² R(l), (f, k, k)."""
        correlation = matern(self.scaled(theta), self.smoothness)
        diagonal = np.arange(correlation.shape[1])
        correlation[:, diagonal, diagonal] += NUGGET
        return np.linalg.cholesky(correlation) * self.stds[:, None, None]

    def bends(self, theta: Array, roots: Array) -> Array:
        """Return M = L⁻¹ (∂ s² R/∂log l) L⁻ᵀ, (f, k, k)."""
        slope = matern_by_length(self.scaled(theta), self.smoothness) * self.stds[:, None, None] ** 2
        half = np.linalg.solve(roots, slope)
        return np.linalg.solve(roots, half.transpose(0, 2, 1))


@dataclass(frozen=True, eq=False)
class Scale:
    """What adds to a curve: the scale of a linear axis, or a part of a reversal that comes over a way.

    kind : of its size; part : of the answered unknowns; ramp : (n,) m, what one standard deviation adds
    """

    kind: Kind
    part: slice
    ramp: Array
