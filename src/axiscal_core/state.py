"""The state after some readings, and the fall of J by one more (eq. 31-37).

With K = H C Hᵀ + rests + noise of a place and G = V C Hᵀ, one of one number gains |G|²/K. Readings that are there
already have sharpened the root of C, in which the rests of their cells are unknowns as well.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from axiscal_core.criterion import Goal
from axiscal_core.from_scipy import solution, solution_of_product
from axiscal_core.model import Numbers
from axiscal_core.normal import sharpened
from axiscal_core.refusals import Array

_LOST = 1e-13  # of the largest variance: below it rounding may be a thousandth of what is divided by it, or more
_MODERATE = 1e13  # of |R^-½ H F|²: all at once by Cholesky, which would lose the prior beside sharper readings
_SINGLY = 8  # numbers up to which one after another is as fast


def joined(parts: list[Numbers]) -> Numbers:
    """Return numbers one after another; each part keeps its own counting of places."""
    return Numbers(*(np.concatenate(each) for each in zip(*parts, strict=True)))


class State:
    """What is known after readings, as a root: a difference of covariances loses the digits of sharp readings.

    root : R (size + c, k), R Rᵀ the covariance of the unknowns and of the rests of c cells that were read
    rests : (e,) standard deviations, of what numbers reach; causes : how many of type B; cells : (c, 2) rest and cell
    """

    root: Array
    goal: Goal
    size: int

    def __init__(
        self, root: Array, goal: Goal, rests: Array, causes: int = 0, cells: Sequence[tuple[int, int]] = ()
    ) -> None:
        self.root, self.goal, self.size, self._rests = root, goal, len(root) - len(cells), rests
        self._means, self.cells = np.zeros((len(root), causes)), np.array([*cells], dtype=np.intp).reshape(-1, 2)

    def opened(self, n: Numbers) -> State:
        """Return the state in which the rests of the cells that numbers reach are unknowns."""
        at, column = np.nonzero(self.unread(n))
        more = np.unique(np.column_stack([column % self.terms, n.cell[at, column]]), axis=0)
        found, (size, rank) = State(self.root, self.goal, self._rests), self.root.shape
        found.size = self.size
        found.cells = np.vstack([self.cells, more.astype(np.intp)])
        found._means = np.pad(self._means, ((0, len(more)), (0, 0)))
        found.root = np.zeros((size + len(more), rank + len(more)))
        found.root[:size, :rank], found.root[size:, rank:] = self.root, np.diag(self._rests[more[:, 0].astype(np.intp)])
        return found

    def after(self, n: Numbers) -> State:
        """Return the state after more readings."""
        if not len(n.rows):
            return self
        found = self.opened(n)
        rows, noise = found.wide(n), n.noise
        scaled = rows @ found.root / np.where(noise > 0, noise, np.nan)[:, None]
        if len(rows) > _SINGLY and np.sum(scaled**2) < _MODERATE:
            found.root = informed(found.root, scaled)
            away = (n.type_b - rows @ found._means) / noise[:, None] ** 2
            found._means = found._means + found.root @ (found.root.T @ (rows.T @ away))
        else:
            found._means, found.root = sharpened(found._means, found.root, rows, n.type_b, noise**2)
        return found

    def of_first(self, size: int) -> State:
        """Return what is known of the first unknowns, as if no cell had been read."""
        root = self.root[:size]
        if root.shape[1] > size:
            root = np.asarray(np.linalg.qr(root.T, mode="r")).T
        return State(root, self.goal, self._rests)

    def wide(self, n: Numbers) -> Array:
        """Return the rows of numbers over the unknowns and the cells that were read, (n, size + c)."""
        column, cell = self.cells.T
        rests = [
            n.reach[:, first + column] * (n.cell[:, first + column] == cell)
            for first in range(0, n.reach.shape[1], self.terms)
        ]
        return np.hstack([n.rows, sum(rests, np.zeros((len(n.rows), len(cell))))])

    def unread(self, n: Numbers) -> Array:
        """Return what rests that were not read, one standard deviation each, do to numbers, (n, columns)."""
        result: Array = n.reach * np.tile(self._rests, n.reach.shape[1] // self.terms)
        for column, cell in self.cells:
            for each in range(column, result.shape[1], self.terms):
                result[n.cell[:, each] == cell, each] = 0.0
        return result

    @property
    def terms(self) -> int:
        """The number of columns of rests; where a reading stands on several feet it has as many for each."""
        return max(len(self._rests), 1)

    @property
    def moved(self) -> Array:
        """G B (size, c): by what one standard deviation of each cause of type B moves what readings say."""
        return self._means[: self.size]

    @cached_property
    def known(self) -> Array:
        """F (size, k) with F Fᵀ the covariance of all unknowns."""
        return self.root[: self.size]

    @cached_property
    def covariance(self) -> Array:
        """C of all unknowns, (size, size)."""
        return np.asarray(self.known @ self.known.T)

    @cached_property
    def weighted(self) -> Array:
        """V R (w, k): its squared length is J, where V says J."""
        return self.goal.root @ self.root[: self.goal.root.shape[1]]

    @cached_property
    def value(self) -> float:
        """J."""
        return self.goal.value(self.known)

    def whitened(self, n: Numbers) -> Array:
        """Return R^-½ H R of numbers, (n, k), with rests that were not read as noise."""
        variances = n.noise**2 + np.sum(self.unread(n) ** 2, axis=1)
        return np.asarray((self.wide(n) @ self.root) / np.sqrt(variances)[:, None])

    def of_places(self, n: Numbers, each: int) -> tuple[Array, Array]:
        """Return K with noise in blocks, (m, k, k), and G, (m, k, w), of places of `each` numbers.

        Without what different places have in common.
        """
        shape, apart = (len(n.rows) // each, each, -1), self.unread(n)
        apart = apart.reshape(*shape[:2], apart.shape[1])
        noise = n.noise.reshape(shape[:2])[:, :, None] ** 2 * np.eye(each)
        return self.forms(self.wide(n).reshape(*shape[:2], len(self.root)), apart @ apart.swapaxes(1, 2) + noise)

    def forms(self, rows: Array, noise: Array) -> tuple[Array, Array]:
        """Return the same of rows (m, k, size + c).  noise : (m, k, k), with rests that were not read"""
        felt = (rows.reshape(-1, rows.shape[2]) @ self.root).reshape(*rows.shape[:2], self.root.shape[1])
        return felt @ felt.swapaxes(1, 2) + noise, felt @ self.weighted.T

    def gains(self, n: Numbers, each: NDArray[np.intp]) -> Array:
        """Return by how much J falls with each place alone, (m,).  each : (m, k) which of the numbers are its own"""
        if self.goal.function is not None:
            return self.fallen(n, each)
        return gained(*self.of_places(n.at(each.ravel()), each.shape[1]))

    def fallen(self, n: Numbers, each: Iterable[NDArray[np.intp]]) -> Array:
        """Return the same of places, whatever says J.  each : (m) which of the numbers are theirs"""
        wide, apart, values = self.wide(n), self.unread(n), list[float]()
        none = np.zeros((len(self.root), 0))
        for mine in each:
            noise, turn = np.linalg.eigh(apart[mine] @ apart[mine].T + np.diag(n.noise[mine] ** 2))
            _, root = sharpened(none, self.root, turn.T @ wide[mine], none[: len(noise)], noise)
            values.append(self.goal.value(root[: self.size]))
        return self.value - np.array(values)


def unexplained(target: Array, scaled: Array) -> Array:
    """Return Φ (I + BᵀB)⁻¹, (w, k), what readings leave of Φ = V F: times Φ it is J.  scaled : B = R^-½ H F, (m, k)

    In the room of the numbers where these are fewer; only columns that a reading feels are solved for.
    """
    felt, left = np.any(scaled, axis=0), target.copy()
    told, own = scaled[:, felt], target[:, felt]
    if np.sum(told**2) >= _MODERATE:
        _, values, right = np.linalg.svd(told, full_matrices=False)
        left[:, felt] = own - (own @ right.T * (values**2 / (1 + values**2))) @ right
    elif len(told) < told.shape[1]:
        left[:, felt] = own - solution_of_product(_root_of(told.T), told @ own.T).T @ told
    else:
        left[:, felt] = solution_of_product(_root_of(told), own.T).T
    return left


def informed(factor: Array, scaled: Array) -> Array:
    """Return F T with T Tᵀ = (I + BᵀB)⁻¹: a root after readings.  scaled : B = R^-½ H F, (m, k)"""
    return solution(_root_of(scaled), factor.T).T


def _root_of(scaled: Array) -> Array:
    """Return L (k, k) with L Lᵀ = I + BᵀB."""
    information: Array = scaled.T @ scaled
    information[np.diag_indices(len(information))] += 1.0
    return np.asarray(np.linalg.cholesky(information), dtype=float)


def gained(k: Array, g: Array) -> Array:
    """Return by how much J falls, where V says J.  k : (m, k, k) with noise; g : (m, k, w)"""
    if g.shape[1] == 1:  # sums of squares are faster so
        return joint_gains(np.einsum("mkw,mkw->m", g, g)[:, None, None], k)
    return joint_gains(g @ g.swapaxes(1, 2), k)


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
