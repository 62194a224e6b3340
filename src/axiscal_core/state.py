"""The state after some readings, and the fall of J by one more (eq. 31-37).

With K = H C Hᵀ + rests + noise of a place and G = V C Hᵀ, one of one number gains |G|²/K. Readings that are there
already have sharpened the root of C, in which the rests of their cells are unknowns as well.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from axiscal_core.criterion import Goal
from axiscal_core.model import Model, Numbers
from axiscal_core.normal import sharpened
from axiscal_core.places import Places
from axiscal_core.refusals import Array

_BLOCK = 4096  # places at once: of memory, not of the result
_LOST = 1e-13  # of the largest variance: below it rounding may be a thousandth of what is divided by it, or more


def joined(parts: list[Numbers]) -> Numbers:
    """Return numbers one after another; each part keeps its own counting of places."""
    return Numbers(*(np.concatenate(each) for each in zip(*parts, strict=True)))


class State:
    """What is known after readings, as a root: a difference of covariances loses the digits of sharp readings.

    taken : the numbers of readings that are there
    root : R (size + c, k), R Rᵀ the covariance of the unknowns and of the rests of c cells that were read
    """

    def __init__(self, case: Model, goal: Goal, taken: Numbers | None = None) -> None:
        self.case, self.goal, self.root = case, goal, case.prior.factor
        self._means, self._cells = np.zeros((case.size, len(case.causes))), np.zeros((0, 2), dtype=np.intp)
        vars(self).update(vars(self.after(taken)) if taken is not None and len(taken.rows) else {})

    def after(self, n: Numbers) -> State:
        """Return the state after more readings."""
        found, rests = State(self.case, self.goal), self._rests
        at, curve = np.nonzero(self._unread(n) * rests)
        more = np.unique(np.column_stack([curve, n.cell[at, curve]]), axis=0).astype(np.intp)
        found._cells, root = np.vstack([self._cells, more]), np.zeros(np.add(self.root.shape, len(more)))
        root[: len(self.root), : self.root.shape[1]] = self.root
        root[len(self.root) :, self.root.shape[1] :] = np.diag(rests[more[:, 0]])
        means = np.pad(self._means, ((0, len(more)), (0, 0)))
        found._means, found.root = sharpened(means, root, found._wide(n), n.type_b, n.noise**2)
        return found

    @cached_property
    def _rests(self) -> Array:
        """The standard deviation of each error's rest, (terms,)."""
        return np.array([term.rest for term in self.case.machine.terms])

    def _wide(self, n: Numbers) -> Array:
        """Return the rows of numbers over the unknowns and the cells that were read, (n, size + c)."""
        curve, cell = self._cells.T
        return np.hstack([n.rows, n.reach[:, curve] * (n.cell[:, curve] == cell)])

    def _unread(self, n: Numbers) -> Array:
        """Return the reach of numbers where their cell was not read, and nought elsewhere, (n, curves)."""
        result = n.reach.copy()
        for curve, cell in self._cells:
            result[n.cell[:, curve] == cell, curve] = 0.0
        return result

    @property
    def moved(self) -> Array:
        """G B (size, c): by what one standard deviation of each cause of type B moves what readings say."""
        return self._means[: self.case.size]

    @cached_property
    def known(self) -> Array:
        """F (size, k) with F Fᵀ the covariance of all unknowns."""
        return self.root[: self.case.size]

    @cached_property
    def covariance(self) -> Array:
        """C of all unknowns, (size, size)."""
        return np.asarray(self.known @ self.known.T)

    @cached_property
    def value(self) -> float:
        """J."""
        return self.goal.value(self.known)

    def of_numbers(self, n: Numbers) -> tuple[Array, Array]:
        """Return K without noise, (n, n), and H C, (n, size), of numbers after what is there."""
        seen, apart = self._wide(n) @ self.root, n._replace(reach=self._unread(n))
        return seen @ seen.T + self.case.shared(apart, apart), seen @ self.known.T

    def of_places(self, n: Numbers, each: int) -> tuple[Array, Array]:
        """Return K with noise in blocks, (m, k, k), and H C, (m, k, size), of places of `each` numbers.

        As `of_numbers`, without what different places have in common.
        """
        shape, seen = (len(n.rows) // each, each, -1), self._wide(n) @ self.root
        apart = (self._unread(n) * self._rests).reshape(*shape[:2], len(self._rests))
        felt = seen.reshape(shape)
        k = felt @ felt.swapaxes(1, 2) + apart @ apart.swapaxes(1, 2)
        return k + n.noise.reshape(shape[:2])[:, :, None] ** 2 * np.eye(each), (seen @ self.known.T).reshape(shape)

    def gains(self, places: Places) -> Array:
        """Return by how much J falls with each place alone, (m,).  places : of one instrument"""
        parts = list[Array]()
        for start in range(0, len(places), _BLOCK):
            block = places.at(np.arange(start, min(start + _BLOCK, len(places))))
            n = self.case.numbers(block)
            each = np.arange(len(n.rows)).reshape(len(block), -1)
            linear = self.goal.function is None
            parts.append(self.gained(*self.of_places(n, each.shape[1])) if linear else self.fallen(n, each))
        return np.concatenate(parts)

    def gained(self, k: Array, reach: Array) -> Array:
        """Return the same of places, where V says J.  k : (m, k, k) with noise; reach : (m, k, size)"""
        g = reach @ self.goal.root.T
        if g.shape[1] == 1:  # sums of squares are faster so
            return joint_gains(np.einsum("mkw,mkw->m", g, g)[:, None, None], k)
        return joint_gains(g @ g.swapaxes(1, 2), k)

    def fallen(self, n: Numbers, each: Iterable[NDArray[np.intp]]) -> Array:
        """Return the same of places, whatever says J.  each : (m) which of the numbers are theirs"""
        wide, apart, values = self._wide(n), self._unread(n) * self._rests, list[float]()
        none = np.zeros((len(self.root), 0))
        for mine in each:
            noise, turn = np.linalg.eigh(apart[mine] @ apart[mine].T + np.diag(n.noise[mine] ** 2))
            _, root = sharpened(none, self.root, turn.T @ wide[mine], none[: len(noise)], noise)
            values.append(self.goal.value(root[: self.case.size]))
        return self.value - np.array(values)


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
