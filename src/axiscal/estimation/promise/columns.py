"""Priors of columns that have a correlation length, and the scale of an axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.errors.plane import PlaneError
from axiscal.numerics import Array
from axiscal.numerics.gaussian import lower_root
from axiscal_core.splines import matern, matern_by_length

_NUGGET = 1e-9
"""Added to correlations of one: long lengths make knots nearly equal, and Cholesky needs more than rounding."""


@dataclass(frozen=True, eq=False)
class Curves:
    """Curves with as many knots and one smoothness, whose control values go together by their distance.

    columns : (f, k); stds, lengths : (f,) as stated; apart : (f, k, k) between knots; length_at : (f,) number of θ, −1
    """

    columns: NDArray[np.intp]
    smoothness: float
    stds: Array
    lengths: Array
    apart: Array
    length_at: NDArray[np.intp]

    def scaled(self, theta: Array) -> Array:
        """Return the distances in correlation lengths, (f, k, k)."""
        factors = np.exp(np.append(theta, 0.0)[self.length_at])
        result: Array = self.apart / (self.lengths * factors)[:, None, None]
        return result

    def roots(self, theta: Array) -> Array:
        """Return L with L Lᵀ = s² R(l), (f, k, k)."""
        correlation = matern(self.scaled(theta), self.smoothness)
        diagonal = np.arange(correlation.shape[1])
        correlation[:, diagonal, diagonal] += _NUGGET
        return np.linalg.cholesky(correlation) * self.stds[:, None, None]

    def bends(self, theta: Array, roots: Array) -> Array:
        """Return M = L⁻¹ (∂ s² R/∂log l) L⁻ᵀ, (f, k, k)."""
        slope = matern_by_length(self.scaled(theta), self.smoothness) * self.stds[:, None, None] ** 2
        half = np.linalg.solve(roots, slope)
        return np.linalg.solve(roots, half.transpose(0, 2, 1))


@dataclass(frozen=True, eq=False)
class PlaneUnknowns:
    """The products of one error of two axes, whose lengths go by one factor; as `Curves` with one member.

    columns : (1, c); length_at : (1,)
    """

    columns: NDArray[np.intp]
    plane: PlaneError
    length_at: NDArray[np.intp]

    def roots(self, theta: Array) -> Array:
        """Return L with L Lᵀ the prior at the lengths, (1, c, c)."""
        covariance = self.plane.prior(self.plane.entry.std, self._stretch(theta))
        # a share of the stated variance: at many times the length the covariance itself is rounding
        covariance[np.diag_indices_from(covariance)] += _NUGGET * self.plane.entry.std**2
        return lower_root(covariance)[None]

    def bends(self, theta: Array, roots: Array) -> Array:
        """Return M = L⁻¹ (∂ prior/∂log l) L⁻ᵀ, (1, c, c)."""
        first, second = (self.plane.prior(self.plane.entry.std, self._stretch(theta), k) for k in (0, 1))
        half = np.linalg.solve(roots[0], first + second)
        return np.linalg.solve(roots[0], half.T)[None]

    def _stretch(self, theta: Array) -> tuple[float, float]:
        factor = float(np.exp(np.append(theta, 0.0)[self.length_at[0]]))
        first, second = self.plane.entry.stretch
        return first * factor, second * factor


@dataclass(frozen=True, eq=False)
class Scale:
    """The scale of a linear axis: part : of the answered unknowns; ramp : (n,) m, what one standard deviation adds."""

    part: slice
    ramp: Array


Bent = Curves | PlaneUnknowns
"""Columns whose prior depends on a length."""
