"""The state after some readings, and the fall of J by one more (eq. 31-37).

Everything stands in the space of numbers: K = H C Hᵀ + rests + noise of readings, G = V C Hᵀ. A place of one number
gains |G_i|²/K_ii. Readings that are there already take their share off K and G first (a Schur complement).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from axiscal_core.criterion import Goal
from axiscal_core.model import Model, Numbers
from axiscal_core.places import Places
from axiscal_core.refusals import Array

_BLOCK = 4096  # places at once: of memory, not of the result
_LOST = 1e-13  # of the largest variance: below it rounding may be a thousandth of what is divided by it, or more


def joined(parts: list[Numbers]) -> Numbers:
    """Return numbers one after another; each part keeps its own counting of places."""
    return Numbers(*(np.concatenate(each) for each in zip(*parts, strict=True)))


class State:
    """What is known.  taken : the numbers of readings that are there"""

    def __init__(self, case: Model, goal: Goal, taken: Numbers | None = None) -> None:
        self.case, self.goal, self.taken = case, goal, case.none if taken is None else taken

    @cached_property
    def _root(self) -> Array:
        """The Cholesky factor of K of what is there."""
        n, prior = self.taken, self.case.prior.covariance
        k = n.rows @ prior @ n.rows.T + self.case.shared(n, n) + np.diag(n.noise**2)
        return np.asarray(np.linalg.cholesky(k), dtype=np.float64)

    @cached_property
    def _half(self) -> Array:
        """F⁻¹ H C of what is there, (n, size), K = F Fᵀ."""
        return np.asarray(np.linalg.solve(self._root, self.taken.rows @ self.case.prior.covariance))

    @property
    def moved(self) -> Array:
        """G B (size, c): by what one standard deviation of each cause of type B moves what readings say."""
        return np.asarray(self._half.T @ np.linalg.solve(self._root, self.taken.type_b))

    @cached_property
    def covariance(self) -> Array:
        """C of all unknowns, (size, size)."""
        return np.asarray(self.case.prior.covariance - self._half.T @ self._half)

    @cached_property
    def value(self) -> float:
        """J."""
        return self.goal.value(self.covariance)

    def of_numbers(self, n: Numbers) -> tuple[Array, Array]:
        """Return K without noise, (n, n), and H C, (n, size), of numbers after what is there."""
        reach = n.rows @ self.case.prior.covariance
        k = reach @ n.rows.T + self.case.shared(n, n)
        half = np.linalg.solve(self._root, self.taken.rows @ reach.T + self.case.shared(self.taken, n))
        return k - half.T @ half, reach - half.T @ self._half

    def of_places(self, n: Numbers, each: int) -> tuple[Array, Array]:
        """Return K with noise in blocks, (m, k, k), and H C, (m, k, size), of places of `each` numbers.

        As `of_numbers`, without what different places have in common.
        """
        prior, shape = self.case.prior.covariance, (len(n.rows) // each, each)
        reach = n.rows @ prior
        k = reach.reshape(*shape, self.case.size) @ n.rows.reshape(*shape, self.case.size).swapaxes(1, 2)
        rests = (n.reach * [term.rest for term in self.case.machine.terms]).reshape(*shape, n.reach.shape[1])
        k = k + rests @ rests.swapaxes(1, 2) + n.noise.reshape(*shape)[:, :, None] ** 2 * np.eye(each)
        half = np.linalg.solve(self._root, self.taken.rows @ reach.T + self.case.shared(self.taken, n))
        felt = half.T.reshape(*shape, len(half))
        return k - felt @ felt.swapaxes(1, 2), (reach - half.T @ self._half).reshape(*shape, self.case.size)

    def gains(self, places: Places) -> Array:
        """Return by how much J falls with each place alone, (m,).  places : of one instrument"""
        parts = list[Array]()
        for start in range(0, len(places), _BLOCK):
            block = places.at(np.arange(start, min(start + _BLOCK, len(places))))
            n = self.case.numbers(block)
            parts.append(self.gained(*self.of_places(n, len(n.rows) // len(block))))
        return np.concatenate(parts)

    def gained(self, k: Array, reach: Array) -> Array:
        """Return the same of places.  k : (m, k, k) with noise; reach : (m, k, size)"""
        if self.goal.function is None:
            g = reach @ self.goal.root.T
            if g.shape[1] == 1:  # sums of squares are faster so
                return joint_gains(np.einsum("mkw,mkw->m", g, g)[:, None, None], k)
            return joint_gains(g @ g.swapaxes(1, 2), k)
        found = [self.goal.value(self.covariance - h.T @ np.linalg.solve(s, h)) for s, h in zip(k, reach, strict=True)]
        return self.value - np.array(found)


def joint_gains(above: Array, below: Array) -> Array:
    """Return tr(M⁻¹ N), (...), number by number: with M = L D Lᵀ it is tr(D⁻¹ L⁻¹ N L⁻ᵀ).

    above : N (..., k, k); below : M (..., k, k), both symmetric.
    Where unknowns are open by metres M spans more than a double holds: what rounding may have left of its smallest
    pivots counts as large enough that rounding decides nothing.
    """
    size = above.shape[-1]
    if size == 1:
        return above[..., 0, 0] / below[..., 0, 0]
    above, below = above.copy(order="K"), below.copy(order="K")
    least, gains = _LOST * np.diagonal(below, axis1=-2, axis2=-1).max(axis=-1), np.zeros(above.shape[:-2])
    for i in range(size):
        pivot = np.maximum(below[..., i, i], least)
        gains += above[..., i, i] / pivot
        for j in range(i + 1, size):
            share = below[..., j, i] / pivot
            below[..., j:, j] -= share[..., None] * below[..., j:, i]
            above[..., j, i:] -= share[..., None] * above[..., i, i:]
            above[..., i:, j] -= share[..., None] * above[..., i:, i]
    return gains
