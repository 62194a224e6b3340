"""The room of the numbers: cheaper for few readings of many unknowns.  The equations are those of `spaces`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from axiscal_core.from_scipy import inverse_of_product, root_in_place, solution, solution_of_product
from axiscal_core.problem import Problem
from axiscal_core.refusals import Array
from axiscal_core.spaces import Given, Slope, factors_of, raised, turned, variances_of


class Numbers:
    """The room of the numbers: K (m, m)."""

    def __init__(self, problem: Problem) -> None:
        self.problem, self.sizes = problem, problem.sizes
        plain = np.ones(problem.rows.shape[1], dtype=bool)
        for curves in problem.curves:
            plain[curves.columns] = False
        self._squares = dict[int, Array]()
        for size in np.unique(problem.size_at[plain]).tolist():
            columns = problem.rows[:, plain & (problem.size_at == size)]
            self._squares[size] = columns @ columns.T
        self._fixed = self._squares.pop(-1, np.zeros((len(problem.values),) * 2))
        self._curved = [problem.rows[:, curves.columns].transpose(1, 0, 2).copy() for curves in problem.curves]

    def _shown(self, theta: Array, roots: Sequence[Array]) -> list[Array]:
        """Return the columns of curves with their priors applied, (f, m, k) each."""
        factors = factors_of(self.problem, theta)
        pairs = zip(self._curved, self.problem.curves, roots, strict=True)
        return [rows @ (lower * factors[curves.columns[:, :1, None]]) for rows, curves, lower in pairs]

    def covariance(self, theta: Array, roots: Sequence[Array]) -> Array:
        """Return K, (m, m)."""
        result = self._fixed.copy()
        for size, square in self._squares.items():
            result += np.exp(2 * theta[size]) * square
        for shown in self._shown(theta, roots):
            result += _square(shown)
        result[np.diag_indices_from(result)] += variances_of(self.problem, theta)
        return result

    def derivatives(self, theta: Array, roots: Sequence[Array]) -> dict[int, Array]:
        """Return the derivative of K by each θ but noises, (m, m) each."""
        problem = self.problem
        by = {size: 2 * np.exp(2 * theta[size]) * square for size, square in self._squares.items()}
        for curves, lower, shown in zip(problem.curves, roots, self._shown(theta, roots), strict=True):
            size_at = problem.size_at[curves.columns[:, 0]]
            bent = shown @ curves.bends(theta, lower)
            for size in np.unique(size_at[size_at >= 0]).tolist():
                by[size] = by.get(size, 0.0) + 2 * _square(shown[size_at == size])
            for length in np.unique(curves.length_at[curves.length_at >= 0]).tolist():
                mine = curves.length_at == length
                by[length] = by.get(length, 0.0) + _flat(bent[mine]) @ _flat(shown[mine]).T
        return by

    def given(self, theta: Array) -> InNumbers | None:
        """Return everything at sizes θ (k,); None where the covariance is not positive definite to rounding."""
        roots = [curves.roots(theta) for curves in self.problem.curves]
        root = root_in_place(self.covariance(theta, roots))
        return None if root is None else InNumbers(self.problem, theta, roots, root, self)


def _flat(shown: Array) -> Array:
    """Return curves side by side, (m, f k).  shown : (f, m, k)"""
    curves, numbers, knots = shown.shape
    return shown.transpose(1, 0, 2).reshape(numbers, curves * knots)


def _square(shown: Array) -> Array:
    """Return Σ Z Zᵀ of several curves, (m, m).  shown : Z (f, m, k)"""
    flat = _flat(shown)
    return flat @ flat.T


@dataclass(eq=False)
class InNumbers(Given):
    """K = F Fᵀ at one set of sizes."""

    space: Numbers

    def __post_init__(self) -> None:
        self.square = float(self.problem.values @ self.weighted)
        self.value = float(-0.5 * self.square - np.log(np.diagonal(self.root)).sum())

    @cached_property
    def _inverse(self) -> Array:
        return inverse_of_product(self.root)

    def slope(self) -> Slope:
        """Return log L, gradient and information."""
        theta, weighted, inverse = self.theta, self.weighted, self._inverse
        by = self.space.derivatives(theta, self.roots)
        pulls = {name: inverse @ each for name, each in by.items()}
        names, noises, noisy = list(pulls), *self._noises()
        gradient, information = np.zeros(len(theta)), np.zeros((len(theta),) * 2)
        flat = np.array([pulls[name].ravel() for name in names]).reshape(len(names), inverse.size)
        turned = np.array([pulls[name].T.ravel() for name in names]).reshape(len(names), inverse.size)
        gradient[names] = [0.5 * (weighted @ by[name] @ weighted - np.trace(pulls[name])) for name in names]
        gradient[noises] = 0.5 * (weighted**2 - np.diagonal(inverse)) @ noisy
        information[np.ix_(names, names)] = 0.5 * flat @ turned.T
        information[np.ix_(noises, noises)] = 0.5 * noisy.T @ inverse**2 @ noisy
        for name in names:
            beside = 0.5 * np.sum(pulls[name] * inverse, axis=1) @ noisy
            information[name, noises] = information[noises, name] = beside
        return Slope(self.value, gradient, information)

    def _noises(self) -> tuple[list[int], Array]:
        """Return the numbers of the θ that are noises, and by these the derivatives of all variances, (m, g)."""
        groups = self.problem.groups[:, None]
        noises = np.unique(groups[groups >= 0])
        return noises.tolist(), np.where(groups == noises, 2 * variances_of(self.problem, self.theta)[:, None], 0.0)

    def unlearnt(self) -> tuple[Array, Array]:
        """Return 1 − RᵀK⁻¹R and RᵀK⁻¹y, R the rows of these unknowns of variance one."""
        rows = turned(self.problem, self.problem.rows, self.theta, self.roots, self.problem.first)
        known = solution(self.root, rows)
        return np.eye(known.shape[1]) - known.T @ known, rows.T @ self.weighted

    def blocks(self, part: NDArray[np.intp]) -> Array:
        """Return the blocks of K⁻¹."""
        return np.asarray(self._inverse[part[:, :, None], part[:, None, :]])

    def precision(self, columns: Array) -> Array:
        """Return K⁻¹B, (m, c).  columns : B (m, c), over the noise"""
        return solution_of_product(self.root, columns)

    def _shares(self, own: Array) -> tuple[Array, Array]:
        problem, sizes = self.problem, (self.theta, self.roots)
        passed = self.precision(problem.rows[:, problem.first :] @ raised(problem, own, *sizes, problem.first))
        left = turned(problem, passed.T @ problem.rows, *sizes)
        left[:, problem.first :] -= own.T
        by_noise = np.sum(passed**2, axis=1) * variances_of(problem, self.theta)
        of = np.unique(problem.setup, return_inverse=True)[1]
        return np.sum(left**2, axis=0), np.asarray(np.bincount(of, by_noise), dtype=np.float64)

    def shown(self, columns: Array, starts: NDArray[np.intp], part: slice) -> tuple[Array, Array]:
        """Return nothing of their own, and the columns themselves."""
        of = np.searchsorted(starts, np.arange(columns.shape[1]), side="right") - 1
        alone = np.zeros((len(columns), len(starts), len(self.root)))
        alone[:, :, part] = columns[:, None] * (of == np.arange(len(starts))[:, None])
        return np.zeros((len(columns), len(columns), len(starts))), alone

    def halves(self, shown: Array) -> tuple[Array, float]:
        """Return F⁻¹D."""
        return solution(self.root, shown.reshape(-1, len(self.root)).T).T.reshape(shown.shape), 1.0
