"""The gain of a reading of several numbers, which teach each other: ΔJ = tr(M⁻¹ N), M = R + G C Gᵀ, N = G C W C Gᵀ.

As a ratio of two smooth functions of the place it is tr(adj(M) N) / det(M), both divided by the same power of the
noise so that they stay within the range of numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array

PAIRS: tuple[NDArray[np.intp], NDArray[np.intp]] = (np.array([0, 0, 1]), np.array([1, 2, 2]))
"""Which entries beside the diagonal a symmetric matrix of three has."""


def joint_forms(above: Array, below: Array, noise: float) -> tuple[Array, Array]:
    """Return numerator and denominator of gains.  above : N (..., k, k); below : M (..., k, k); noise : σ², m²."""
    if above.shape[-1] == 1:
        return above[..., 0, 0], below[..., 0, 0]
    determinant = noise * np.linalg.det(below / noise)
    return determinant * joint_gains(above, below), determinant


def joint_gains(above: Array, below: Array) -> Array:
    """Return tr(M⁻¹ N), (...).  above : N (..., k, k); below : M (..., k, k)."""
    if above.shape[-1] == 3:
        return _gains_of_three(above, below)
    gains: Array = np.trace(np.linalg.solve(below, above), axis1=-2, axis2=-1)
    return gains


def _gains_of_three(above: Array, below: Array) -> Array:
    """Return tr(M⁻¹ N) with M = L D Lᵀ written out: tr(D⁻¹ L⁻¹ N L⁻ᵀ), some forty operations for each.

    above : N (..., 3, 3), below : M (..., 3, 3), both symmetric
    """
    one = 1.0 / below[..., 0, 0]
    up, far = below[..., 0, 1] * one, below[..., 0, 2] * one
    two = 1.0 / (below[..., 1, 1] - up * below[..., 0, 1])
    left = below[..., 1, 2] - up * below[..., 0, 2]
    across = left * two
    three = 1.0 / (below[..., 2, 2] - far * below[..., 0, 2] - across * left)
    back = up * across - far  # the last row of L⁻¹ is [back, −across, 1]
    first, both, second = above[..., 0, 0], above[..., 0, 1], above[..., 1, 1]
    middle = second + up * (up * first - 2 * both)
    last = above[..., 2, 2] + 2 * (back * above[..., 0, 2] - across * above[..., 1, 2])
    last += back * (back * first - 2 * across * both) + across**2 * second
    gains: Array = first * one + middle * two + last * three
    return gains


@dataclass(eq=False, slots=True)
class SharedReadings:
    """What the numbers of readings of three have in common.

    first : (t,) index of the first number of each; above, below : (t, 3) entries of N and M beside the diagonal
    """

    first: NDArray[np.intp]
    above: Array
    below: Array
    _pairs: tuple[NDArray[np.intp], NDArray[np.intp]] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Note where both numbers of every pair stand."""
        self._pairs = self.first[:, None] + PAIRS[0], self.first[:, None] + PAIRS[1]

    @classmethod
    def of(cls, parts: Sequence[SharedReadings]) -> SharedReadings:
        """Return several as one."""
        if not parts:
            return cls(np.zeros(0, dtype=np.intp), np.zeros((0, 3)), np.zeros((0, 3)))
        return cls(*(np.concatenate([getattr(p, name) for p in parts]) for name in ("first", "above", "below")))

    def after(self, scaled: Array, half: Array, cross: Array) -> SharedReadings:
        """Return the same after a change of the covariance; the arguments, (numbers, k), are as in `Scores`."""
        other = copy(self)
        (near_a, near_b), (far_a, far_b) = self.ends(scaled), self.ends(half)
        other.above = self.above - np.einsum("tpk,tpk->tp", near_a, far_b) - np.einsum("tpk,tpk->tp", far_a, near_b)
        other.below = self.below - np.einsum("tpk,tpk->tp", near_a, self.ends(cross)[1])
        return other

    def within(self, kept: NDArray[np.intp]) -> SharedReadings:
        """Return the same of some of the readings."""
        return SharedReadings(self.first[kept], self.above[kept], self.below[kept])

    def copy(self) -> SharedReadings:
        """Return a copy that goes its own way."""
        other = copy(self)
        other.above, other.below = self.above.copy(), self.below.copy()
        return other

    def gains(self, above: Array, below: Array) -> Array:
        """Return the gains, (t,).  above, below : (numbers,) the diagonals of all readings."""
        return joint_gains(*self.matrices(above, below))

    def matrices(self, above: Array, below: Array) -> tuple[Array, Array]:
        """Return N and M of all readings, each (t, 3, 3).  above, below : (numbers,) their diagonals."""
        return self._full(above, self.above), self._full(below, self.below)

    def _full(self, diagonal: Array, aside: Array) -> Array:
        result = np.empty((len(self.first), 3, 3))
        every = np.arange(3)
        result[:, every, every] = diagonal[self.first[:, None] + every]
        result[:, PAIRS[0], PAIRS[1]] = result[:, PAIRS[1], PAIRS[0]] = aside
        return result

    def ends(self, values: Array) -> tuple[Array, Array]:
        """Return values (numbers, k) of the first and the second number of every pair, each (t, 3, k)."""
        return values.take(self._pairs[0], axis=0), values.take(self._pairs[1], axis=0)
