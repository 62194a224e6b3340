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


def joined(parts: list[Numbers]) -> Numbers:
    """Return numbers one after another; each part keeps its own counting of places."""
    return Numbers(*(np.concatenate(each) for each in zip(*parts, strict=True)))


class State:
    """What is known.  taken : the numbers of readings that are there, None for none"""

    def __init__(self, case: Model, goal: Goal, taken: Numbers | None = None) -> None:
        self.case, self.goal, self.taken = case, goal, taken

    @cached_property
    def _root(self) -> Array:
        """The Cholesky factor of K of what is there."""
        assert self.taken is not None
        n, prior = self.taken, self.case.prior.covariance
        k = n.rows @ prior @ n.rows.T + self.case.shared(n, n) + np.diag(n.noise**2)
        return np.asarray(np.linalg.cholesky(k), dtype=np.float64)

    @cached_property
    def covariance(self) -> Array:
        """C of all unknowns, (size, size)."""
        prior = self.case.prior.covariance
        if self.taken is None:
            return prior
        half = np.linalg.solve(self._root, self.taken.rows @ prior)
        return np.asarray(prior - half.T @ half)

    @cached_property
    def value(self) -> float:
        """J."""
        return self.goal.value(self.covariance)

    def of_numbers(self, n: Numbers) -> tuple[Array, Array]:
        """Return K without noise, (n, n), and H C, (n, size), of numbers after what is there."""
        reach = n.rows @ self.case.prior.covariance
        k = reach @ n.rows.T + self.case.shared(n, n)
        if self.taken is None:
            return k, reach
        half = np.linalg.solve(self._root, self.taken.rows @ reach.T + self.case.shared(self.taken, n))
        own = np.linalg.solve(self._root, self.taken.rows @ self.case.prior.covariance)
        return k - half.T @ half, reach - half.T @ own

    def of_places(self, n: Numbers, each: int) -> tuple[Array, Array]:
        """Return K with noise in blocks, (m, k, k), and H C, (m, k, size), of places of `each` numbers.

        As `of_numbers`, without what different places have in common.
        """
        prior, shape = self.case.prior.covariance, (len(n.rows) // each, each)
        reach = n.rows @ prior
        k = reach.reshape(*shape, self.case.size) @ n.rows.reshape(*shape, self.case.size).swapaxes(1, 2)
        rests = (n.reach * [term.rest for _, term in self.case.machine.curves]).reshape(*shape, n.reach.shape[1])
        k = k + rests @ rests.swapaxes(1, 2) + n.noise.reshape(*shape)[:, :, None] ** 2 * np.eye(each)
        if self.taken is not None:
            half = np.linalg.solve(self._root, self.taken.rows @ reach.T + self.case.shared(self.taken, n))
            own = np.linalg.solve(self._root, self.taken.rows @ prior)
            reach = reach - half.T @ own
            felt = half.T.reshape(*shape, len(half))
            k = k - felt @ felt.swapaxes(1, 2)
        return k, reach.reshape(*shape, self.case.size)

    def gains(self, places: Places) -> Array:
        """Return by how much J falls with each place alone, (m,).  places : of one instrument"""
        n = self.case.numbers(places)
        return self.gained(*self.of_places(n, len(n.rows) // len(places)))

    def gained(self, k: Array, reach: Array) -> Array:
        """Return the same of places.  k : (m, k, k) with noise; reach : (m, k, size)"""
        if self.goal.function is None:
            g = reach @ self.goal.root.T
            fallen: Array = np.trace(np.linalg.solve(k, g @ g.swapaxes(1, 2)), axis1=1, axis2=2)
            return fallen
        found = [self.goal.value(self.covariance - h.T @ np.linalg.solve(s, h)) for s, h in zip(k, reach, strict=True)]
        return self.value - np.array(found)
