"""The gain of a reading of several numbers, which teach each other: ΔJ = tr(M⁻¹ N), M = R + G C Gᵀ, N = G C W C Gᵀ.

As a ratio of two smooth functions of the place it is tr(adj(M) N) / det(M), both divided by the same power of the
noise so that they stay within the range of numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field
from functools import cache

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array

_USUAL = 3
"""Numbers of a reading of several: along x, y and z."""
_LOST = 1e-13
"""Share of the largest eigenvalue below which rounding may be a thousandth of what is divided by it, or more."""


def joint_forms(above: Array, below: Array, noise: float) -> tuple[Array, Array]:
    """Return numerator and denominator of gains.  above : N (..., k, k); below : M (..., k, k); noise : σ², m²."""
    if above.shape[-1] == 1:
        return above[..., 0, 0], below[..., 0, 0]
    determinant = noise * np.linalg.det(below / noise)
    return determinant * joint_gains(above, below), determinant


def joint_gains(above: Array, below: Array) -> Array:
    """Return tr(M⁻¹ N), (...).  above : N (..., k, k); below : M (..., k, k), both symmetric.

    Where unknowns are open by metres M spans more than a double holds: what rounding may have left of its smallest
    eigenvalues counts as large enough that rounding decides nothing.
    """
    if above.shape[-1] == 3:
        return _gains_of_three(above, below)
    sizes, turn = np.linalg.eigh(below)
    least = _LOST * sizes[..., -1:]
    gains: Array = np.sum(np.einsum("...ji,...jk,...ki->...i", turn, above, turn) / np.maximum(sizes, least), axis=-1)
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


def pairs_of(count: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return which entries beside the diagonal a symmetric matrix of so many has."""
    pairs: tuple[NDArray[np.intp], NDArray[np.intp]] = np.triu_indices(count, 1)
    return pairs


@dataclass(eq=False, slots=True)
class SharedReadings:
    """What the numbers of readings of several have in common.

    first : (t,) index of the first number of each; counts : (t,) its numbers, w at most
    above, below : (t, w (w − 1) / 2) entries of N and M beside the diagonal, nought beyond its own numbers
    """

    first: NDArray[np.intp]
    counts: NDArray[np.intp]
    above: Array
    below: Array
    numbers: NDArray[np.intp] = field(init=False, repr=False)
    inside: NDArray[np.bool_] | None = field(init=False, repr=False)
    _aside: tuple[NDArray[np.intp], NDArray[np.intp]] = field(init=False, repr=False)
    _pairs: tuple[NDArray[np.intp], NDArray[np.intp]] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Note where the numbers of each stand, (t, w), which of them are its own (None: all), and every pair."""
        every = np.arange(int(self.counts.max(initial=_USUAL)))
        inside = every < self.counts[:, None]
        self.inside = None if inside.all() else inside
        self.numbers = self.first[:, None] + np.where(inside, every, 0)
        self._aside = pairs_of(len(every))
        self._pairs = self.numbers[:, self._aside[0]], self.numbers[:, self._aside[1]]

    @classmethod
    def alike(cls, first: NDArray[np.intp], above: Array, below: Array) -> SharedReadings:
        """Return readings of as many numbers each.  above, below : N and M, (t, k, k)"""
        count = above.shape[-1]
        parts = (_padded(whole[:, *pairs_of(count)], count, max(count, _USUAL)) for whole in (above, below))
        return cls(first, np.full(len(first), count), *parts)

    @classmethod
    def of(cls, parts: Sequence[SharedReadings]) -> SharedReadings:
        """Return several as one."""
        if not parts:
            return _none()
        width = max(part.width for part in parts)
        sides = (
            np.concatenate([_padded(getattr(part, name), part.width, width) for part in parts])
            for name in ("above", "below")
        )
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in ("first", "counts")), *sides)

    @property
    def width(self) -> int:
        """w."""
        return int(self.numbers.shape[1])

    def after(self, scaled: Array, half: Array, cross: Array) -> SharedReadings:
        """Return the same after a change of the covariance; the arguments, (numbers, k), are as in `Scores`."""
        other = copy(self)
        (near_a, near_b), (far_a, far_b) = self.ends(scaled), self.ends(half)
        other.above = self.above - np.einsum("tpk,tpk->tp", near_a, far_b) - np.einsum("tpk,tpk->tp", far_a, near_b)
        other.below = self.below - np.einsum("tpk,tpk->tp", near_a, self.ends(cross)[1])
        if self.inside is not None:
            both = self.inside[:, self._aside[1]]
            other.above *= both
            other.below *= both
        return other

    def within(self, kept: NDArray[np.intp]) -> SharedReadings:
        """Return the same of some of the readings."""
        return SharedReadings(self.first[kept], self.counts[kept], *self._narrow(kept))

    def _narrow(self, kept: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return the entries of some readings, as many as the one with the most numbers among them has."""
        width = int(self.counts[kept].max(initial=_USUAL))
        mine = self._aside[1] < width
        return self.above[kept][:, mine], self.below[kept][:, mine]

    def copy(self) -> SharedReadings:
        """Return a copy that goes its own way."""
        other = copy(self)
        other.above, other.below = self.above.copy(), self.below.copy()
        return other

    def gains(self, above: Array, below: Array) -> Array:
        """Return the gains, (t,).  above, below : (numbers,) the diagonals of all readings."""
        return joint_gains(*self.matrices(above, below))

    def matrices(self, above: Array, below: Array) -> tuple[Array, Array]:
        """Return N and M of all readings, each (t, w, w), nought and one beyond its own.  above, below : (numbers,)"""
        return self._full(above, self.above, 0.0), self._full(below, self.below, 1.0)

    def _full(self, diagonal: Array, aside: Array, beyond: float) -> Array:
        every = np.arange(self.width)
        result = np.empty((len(self.first), self.width, self.width))
        own = diagonal[self.numbers]
        result[:, every, every] = own if self.inside is None else np.where(self.inside, own, beyond)
        one, two = self._aside
        result[:, one, two] = result[:, two, one] = aside
        return result

    def ends(self, values: Array) -> tuple[Array, Array]:
        """Return values (numbers, k) of the first and the second number of every pair, each (t, pairs, k)."""
        return values.take(self._pairs[0], axis=0), values.take(self._pairs[1], axis=0)


@cache
def _none() -> SharedReadings:
    return SharedReadings.alike(np.zeros(0, dtype=np.intp), *np.zeros((2, 0, _USUAL, _USUAL)))


def _padded(aside: Array, width: int, most: int) -> Array:
    """Return entries beside the diagonal as those of a wider matrix, (t, most (most − 1) / 2)."""
    if width == most:
        return aside
    _, second = pairs_of(most)
    padded = np.zeros((len(aside), len(second)))
    padded[:, second < width] = aside
    return padded
