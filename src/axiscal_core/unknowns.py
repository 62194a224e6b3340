"""The room of the unknowns: cheaper for many readings.  The equations are those of `spaces`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from axiscal_core.from_scipy import back_solution, inverse_of_product, root_in_place, solution, solution_of_product
from axiscal_core.numbers import Numbers
from axiscal_core.problem import MOST_NUMBERS, Problem
from axiscal_core.refusals import Array
from axiscal_core.spaces import (
    Given,
    Slope,
    factors_of,
    raised,
    times_roots,
    turned,
    variances_of,
)

_DEARER = 2  # times as much as of an unknown is the cost of a number: of speed, not of the result
_AT_ONCE = 600  # numbers whose rows are worked through at once: more would not stay in the cache


class Unknowns:
    """The room of the unknowns: Q (p, p)."""

    def __init__(self, problem: Problem) -> None:
        self.problem, self.sizes = problem, problem.sizes
        self.groups = np.unique(problem.groups).tolist() or [-1]
        self.counts, self.totals = list[int](), list[float]()
        self.squares, self.products = list[Array](), list[Array]()
        for group in self.groups:
            mine = problem if len(self.groups) == 1 else problem.only(problem.groups == group)
            self.counts.append(len(mine.values))
            self.totals.append(float(mine.values @ mine.values))
            self.squares.append(mine.rows.T @ mine.rows)
            self.products.append(mine.rows.T @ mine.values)

    @cached_property
    def setups(self) -> list[list[tuple[int, Array]]]:
        """The products A of each set-up that was read, with the group of their noise."""
        groups, setup = self.problem.groups, self.problem.setup
        return [[(g, self._square(g, (setup == s) & (groups == g))) for g in np.unique(groups[setup == s]).tolist()]
                for s in np.unique(setup).tolist()]  # fmt: skip

    def _square(self, group: int, mine: NDArray[np.bool_]) -> Array:
        """Return the products of some numbers of a group, which are there where those are all."""
        at = self.groups.index(group)
        if np.count_nonzero(mine) == self.counts[at]:
            return self.squares[at]
        rows = self.problem.rows[mine]
        return np.asarray(rows.T @ rows)

    def weights(self, theta: Array) -> Array:
        """Return 1/σ² of each group, (g,)."""
        return np.asarray(np.exp(-2 * np.append(theta, 0.0))[self.groups])

    def whitened(self, square: Array, theta: Array, roots: Sequence[Array]) -> None:
        """Turn A into D Lᵀ A L D in place: its lower triangle (p, p), which is all that Q's factor reads.

        Curves are answered and stand last: below the diagonal L acts on the rows of these columns only.
        """
        first, factors = self.problem.first, factors_of(self.problem, theta)
        own = square[first:]
        for curves, lower in zip(self.problem.curves, roots, strict=True):
            columns = curves.columns - first
            own[columns] = lower.transpose(0, 2, 1) @ own[columns]
        for curves, lower in zip(self.problem.curves, roots, strict=True):
            times_roots(own, curves.columns, lower)
        square *= factors
        square *= factors[:, None]

    def given(self, theta: Array) -> InUnknowns | None:
        """Return everything at sizes θ."""
        roots = [curves.roots(theta) for curves in self.problem.curves]
        weights = self.weights(theta)
        matrix = weights[0] * self.squares[0]
        for weight, square in zip(weights[1:], self.squares[1:], strict=True):
            matrix += weight * square
        self.whitened(matrix, theta, roots)
        matrix[np.diag_indices_from(matrix)] += 1.0
        root = root_in_place(matrix)
        return None if root is None else InUnknowns(self.problem, theta, roots, root, self)


@dataclass(eq=False)
class InUnknowns(Given):
    """Q = F Fᵀ at one set of sizes."""

    space: Unknowns

    def __post_init__(self) -> None:
        space, weights = self.space, self.space.weights(self.theta)
        right = np.zeros((1, len(self.root)))
        for weight, each in zip(weights, space.products, strict=True):
            right += weight * each
        self.half = half = solution(self.root, turned(self.problem, right, self.theta, self.roots)[0])
        self.solved = back_solution(self.root, half)
        scales = np.append(self.theta, 0.0)[space.groups]
        self.square = float(weights @ np.array(space.totals) - half @ half)
        logs = float(np.log(np.diagonal(self.root)).sum() + np.array(space.counts) @ scales)
        self.value = -0.5 * self.square - logs

    def slope(self) -> Slope:
        """Return value, gradient and information."""
        problem, u, k = self.problem, self.solved, len(self.theta)
        inverse = inverse_of_product(self.root)
        w = -inverse
        w[np.diag_indices_from(w)] += 1.0
        pick, bent = _picked(problem.size_at, k), self._bent(w)
        gradient = pick.T @ (u**2 - np.diagonal(w))
        own = bent.rows[:, bent.at]
        gradient += 0.5 * bent.pick.T @ (u[bent.at] * bent.times(u[:, None])[:, 0] - np.diagonal(own))
        information = 2 * pick.T @ ((w * w) @ pick)
        cross = bent.pick.T @ ((bent.rows * w[bent.at]) @ pick)
        information += cross + cross.T
        information += 0.5 * bent.pick.T @ ((own * own.T) @ bent.pick)
        self._noises(gradient, information, (w, inverse), (pick, bent))
        return Slope(self.value, gradient, information)

    def _bent(self, w: Array) -> _Bent:
        curves = self.problem.curves
        pairs = list(zip(curves, self.roots, strict=True))
        bends = [each.bends(self.theta, lower) for each, lower in pairs]
        at = np.concatenate([each.columns.ravel() for each in curves] or [np.zeros(0, dtype=np.intp)])
        lengths = [np.repeat(each.length_at, each.columns.shape[1]) for each in curves]
        pick = _picked(np.concatenate(lengths or [np.zeros(0, dtype=np.intp)]), len(self.theta))
        bent = _Bent(at, pick, [each.columns for each in curves], bends, w)
        bent.rows = bent.times(w)
        return bent

    def _noises(self, gradient: Array, information: Array, both: tuple[Array, Array], of: tuple[Array, _Bent]) -> None:
        """Add what the noises of the groups do, in place.  both : W and Q⁻¹; of : which size each column has"""
        (w, inverse), (pick, bent) = both, of
        products = self._products(w, inverse)
        turned = bent.times(inverse)
        for index, (group, product) in enumerate(zip(self.space.groups, products, strict=True)):
            if group < 0:
                continue
            count, trace = self.space.counts[index], float(np.trace(product))
            gradient[group] += float(self.space.weights(self.theta)[index]) * self._left(index) - count + trace
            information[group, group] += 2 * (count - 2 * trace)
            for other, beside in zip(self.space.groups, products, strict=True):
                if other >= 0:
                    information[group, other] += 2 * float(np.sum(product * beside.T))
            cross = 2 * np.sum(product * inverse, axis=1) @ pick
            cross += np.sum(product[bent.at] * turned, axis=1) @ bent.pick
            information[group] += cross
            information[:, group] += cross

    def _products(self, w: Array, inverse: Array) -> list[Array]:
        """Return Q⁻¹B of each group, (p, p): together they are W, so the first is what the others leave."""
        space, result = self.space, list[Array]()
        for weight, square in list(zip(space.weights(self.theta), space.squares, strict=True))[1:]:
            gram = weight * square
            space.whitened(gram, self.theta, self.roots)
            result.append(inverse @ (np.tril(gram) + np.tril(gram, -1).T))
        return [w - np.sum(result, axis=0), *result] if result else [w] * len(space.groups)

    def _left(self, index: int) -> float:
        """Return the sum of the squares that the estimate leaves of a group's numbers, over their base noise."""
        space, problem = self.space, self.problem
        raw = raised(problem, self.solved[:, None], self.theta, self.roots)[:, 0]
        return float(space.totals[index] - 2 * raw @ space.products[index] + raw @ space.squares[index] @ raw)

    def unlearnt(self) -> tuple[Array, Array]:
        """Return them by the trailing triangle."""
        first = self.problem.first
        return inverse_of_product(self.root[first:, first:]), self.solved[first:]

    def blocks(self, part: NDArray[np.intp]) -> Array:
        """Return the blocks of K⁻¹ of some readings."""
        return np.concatenate([self._blocks(piece) for piece in np.array_split(part, 1 + part.size // _AT_ONCE)])

    def _blocks(self, part: NDArray[np.intp]) -> Array:
        rows, roots = self._rows(part.ravel())
        half = np.ascontiguousarray(solution(self.root, rows.T).T).reshape(*part.shape, -1)
        own = roots.reshape(part.shape)
        blocks = np.eye(part.shape[1]) - half @ half.transpose(0, 2, 1)
        return np.asarray(blocks * own[:, :, None] * own[:, None, :])

    def precision(self, columns: Array) -> Array:
        """Return K⁻¹B.  Priors are applied to unknowns, for the rows of many readings are gigabytes."""
        problem, sizes = self.problem, (self.theta, self.roots)
        weights = 1 / variances_of(problem, self.theta)[:, None]
        half = solution(self.root, turned(problem, (weights * columns).T @ problem.rows, *sizes).T)
        return np.asarray(weights * (columns - problem.rows @ raised(problem, back_solution(self.root, half), *sizes)))

    def _shares(self, own: Array) -> tuple[Array, Array]:
        """Return them from u = Q⁻¹F: the prior of each column leaves u², and noise uᵀB u, B as in `spaces`."""
        problem, every = self.problem, np.zeros((len(self.root), own.shape[1]))
        every[problem.first :] = own
        left = solution_of_product(self.root, every)
        raw, weights = raised(problem, left, self.theta, self.roots), np.exp(-2 * np.append(self.theta, 0.0))
        parts = [[weights[group] * np.vdot(raw, square @ raw) for group, square in each] for each in self.space.setups]
        return np.sum(left**2, axis=1), np.array([sum(each) for each in parts])

    def shown(self, columns: Array, starts: NDArray[np.intp], part: slice) -> tuple[Array, Array]:
        """Return what columns show of each other, and of the unknowns with priors not applied."""
        problem, weights = self.problem, 1 / variances_of(self.problem, self.theta)[part]
        own = np.add.reduceat(weights * columns[:, None] * columns, starts, axis=2)
        seen = [np.add.reduceat((weights * one)[:, None] * problem.rows[part], starts, axis=0) for one in columns]
        return own, np.array(seen)

    def halves(self, shown: Array) -> tuple[Array, float]:
        """Return F⁻¹ of what is shown, priors applied."""
        rows = turned(self.problem, shown.reshape(-1, len(self.root)), self.theta, self.roots)
        return solution(self.root, rows.T).T.reshape(shown.shape), -1.0

    def _rows(self, which: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return rows of unknowns of variance one over the noise, (n, p), and one over the noise, (n,)."""
        problem = self.problem
        roots = 1 / np.sqrt(variances_of(problem, self.theta)[which])
        return turned(problem, problem.rows[which], self.theta, self.roots) * roots[:, None], roots


@dataclass(eq=False)
class _Bent:
    """All columns whose prior has a length: at (q,), pick (q, k) which θ, M of each curve, and rows = M W (q, p)."""

    at: NDArray[np.intp]
    pick: Array
    columns: list[NDArray[np.intp]]
    bends: list[Array]
    rows: Array

    def times(self, matrix: Array) -> Array:
        """Return M applied to the rows of these columns, (q, n).  matrix : (p, n)"""
        pairs = zip(self.columns, self.bends, strict=True)
        parts = [(bend @ matrix[columns]).reshape(-1, matrix.shape[1]) for columns, bend in pairs]
        return np.concatenate(parts) if parts else np.zeros((0, matrix.shape[1]))


def _picked(number_at: NDArray[np.intp], count: int) -> Array:
    """Return which of `count` sizes each column has, (n, count) of ones and noughts.  number_at : (n,), −1 for none"""
    return np.asarray(number_at[:, None] == np.arange(count), dtype=float)


Space = Numbers | Unknowns
"""A room for a problem."""


def space_of(problem: Problem) -> Space:
    """Return the room in which a problem costs less: of many set-ups each has unknowns of its own."""
    numbers, unknowns = problem.rows.shape
    return Numbers(problem) if numbers <= max(MOST_NUMBERS, unknowns // _DEARER) else Unknowns(problem)
