"""The likelihood of sizes and its exact gradient, in two rooms with one interface.

`Unknowns` works with Q = 1 + D Lᵀ (Σ_g A_g/σ_g²) L D, A_g = Z_gᵀ Z_g, whatever the number of readings; `Numbers` with
K = Σ_f s_f² B_f + σ² of the numbers, whatever the number of unknowns. With Q = F Fᵀ, v = F⁻¹b, u = F⁻ᵀv, W = 1 − Q⁻¹

    log L = −½(Σ y_gᵀy_g/σ_g² − vᵀv) − Σ log F_ii − Σ n_g log σ_g
    ∂/∂log s_f = |u_f|² − tr W_ff,                    I(f, g) = 2 |W_fg|²
    ∂/∂log l   = ½(uᵀM u − tr M W_bb),                I(l, f) = Σ (M W)∘W over b × f,  I(l, l') = ½ tr(M W M' W')
    ∂/∂log σ_g = |e_g|²/σ_g² − n_g + tr(Q⁻¹ B_g),     I(σ_g, σ_g) ≈ 2 (n_g − tr(Q⁻¹ B_g))

and with K = F Fᵀ, a = K⁻¹y, P_f = K⁻¹ ∂K_f:  g = ½(aᵀ∂K_f a − tr P_f),  I = ½ Σ P_f ∘ P_gᵀ (Rasmussen and Williams
2006, eq. 5.9; the Fisher information is that of Gaussian regression).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from axiscal.estimate.problem import MOST_NUMBERS, Problem
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import back_solution, inverse_of_product, solution, solution_of_product
from axiscal.numerics.gaussian import lower_root

_Bent = tuple[int, NDArray[np.intp], Array]
"""Number of the θ of a length, the columns of a curve, and M."""


class Slope(NamedTuple):
    """log L of θ, its gradient (k,) and the Fisher information (k, k)."""

    value: float
    gradient: Array
    information: Array


class Answer(NamedTuple):
    """Mean (answered,) and a factor (answered, r) of the covariance of the answered unknowns, m and rad.

    covariance = prior factor prior_rootᵀ − taken takenᵀ where `prior` is given, else root rootᵀ
    """

    mean: Array
    covariance: Array


class Given(Protocol):
    """Everything at one set of sizes."""

    value: float

    def slope(self) -> Slope:
        """Return value, gradient and information."""

    def answer(self) -> Answer:
        """Return the posterior of the answered unknowns."""

    def cells(self) -> Array:
        """Return the means of the rests of the cells that were visited, (c,) m or rad."""

    def left_out(self) -> tuple[Array, list[Array]]:
        """Return K⁻¹y (m,), over the noise, and the blocks of K⁻¹ of each reading."""

    def precision(self, columns: Array) -> Array:
        """Return K⁻¹B, (m, c).  columns : B (m, c), over the noise"""


class Space(Protocol):
    """A room for a problem."""

    problem: Problem

    def given(self, theta: Array) -> Given | None:
        """Return everything at sizes θ (k,); None where the covariance is not positive definite to rounding."""


def space_of(problem: Problem) -> Space:
    """Return the room in which a problem costs less."""
    return Numbers(problem) if len(problem.values) <= MOST_NUMBERS else Unknowns(problem)


def _noises(problem: Problem, theta: Array) -> Array:
    """Return the variances of the numbers, times their own, (m,)."""
    result: Array = np.exp(2 * np.append(theta, 0.0))[problem.groups]
    return result


def _factors(problem: Problem, theta: Array) -> Array:
    """Return the size of each column, (p,)."""
    result: Array = np.exp(np.append(theta, 0.0))[problem.size_at]
    return result


def _blocks_of(reading: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """Return the numbers of each reading that has some."""
    starts = np.flatnonzero(np.diff(reading, prepend=-1))
    return np.split(np.arange(len(reading)), starts[1:])


class Numbers:
    """The room of the numbers: K (m, m)."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        plain = np.ones(problem.rows.shape[1], dtype=bool)
        for curves in problem.curves:
            plain[curves.columns] = False
        self._squares = dict[int, Array]()
        for size in np.unique(problem.size_at[plain]).tolist():
            columns = problem.rows[:, plain & (problem.size_at == size)]
            self._squares[size] = columns @ columns.T
        self._fixed = self._squares.pop(-1, np.zeros((len(problem.values),) * 2))

    def terms(self, theta: Array, slopes: bool) -> tuple[Array, dict[int, Array], list[Array]]:
        """Return K, its derivative by each θ but noises, and the roots of the curves' priors."""
        problem, factors = self.problem, _factors(self.problem, theta)
        covariance, by = self._fixed.copy(), dict[int, Array]()
        for size, square in self._squares.items():
            by[size] = 2 * np.exp(2 * theta[size]) * square
            covariance += 0.5 * by[size]
        roots = [curves.roots(theta) for curves in problem.curves]
        for curves, root in zip(problem.curves, roots, strict=True):
            bends = curves.bends(theta, root) if slopes else [None] * len(root)
            pairs = zip(curves.columns, root, bends, curves.length_at.tolist(), strict=True)
            for columns, lower, bend, length in pairs:
                shown = problem.rows[:, columns] @ (lower * factors[columns[0]])
                square, size = shown @ shown.T, int(problem.size_at[columns[0]])
                covariance += square
                if slopes and size >= 0:
                    by[size] = by.get(size, 0.0) + 2 * square
                if bend is not None and length >= 0:
                    by[length] = by.get(length, 0.0) + shown @ bend @ shown.T
        covariance[np.diag_indices_from(covariance)] += _noises(problem, theta)
        return covariance, by, roots

    def given(self, theta: Array) -> Given | None:
        """Return everything at sizes θ."""
        covariance, _, roots = self.terms(theta, slopes=False)
        try:
            root = lower_root(covariance)
        except np.linalg.LinAlgError:
            return None
        return _InNumbers(self, theta, root, roots)


@dataclass(eq=False)
class _InNumbers:
    """K = F Fᵀ at one set of sizes."""

    space: Numbers
    theta: Array
    root: Array
    roots: list[Array]

    def __post_init__(self) -> None:
        self.weighted = solution_of_product(self.root, self.space.problem.values)
        self.value = float(-0.5 * self.space.problem.values @ self.weighted - np.log(np.diagonal(self.root)).sum())

    def slope(self) -> Slope:
        """Return value, gradient and information."""
        problem, theta, weighted = self.space.problem, self.theta, self.weighted
        _, by, _ = self.space.terms(theta, slopes=True)
        noises = np.exp(2 * theta)
        for size in np.unique(problem.groups[problem.groups >= 0]).tolist():
            by[size] = np.diag(np.where(problem.groups == size, 2 * noises[size], 0.0))
        inverse, names = inverse_of_product(self.root), list(by)
        pulls = [inverse @ by[name] for name in names]
        gradient, information = np.zeros(len(theta)), np.zeros((len(theta),) * 2)
        flat = np.array([pull.ravel() for pull in pulls]).reshape(len(names), -1)
        turned = np.array([pull.T.ravel() for pull in pulls]).reshape(len(names), -1)
        gradient[names] = [0.5 * (weighted @ by[n] @ weighted - np.trace(p)) for n, p in zip(names, pulls, strict=True)]
        information[np.ix_(names, names)] = 0.5 * flat @ turned.T
        return Slope(self.value, gradient, information)

    def answer(self) -> Answer:
        """Return the posterior of the answered unknowns."""
        problem = self.space.problem
        prior = self._prior()
        shown = _shown(problem, self.theta, self.roots)  # whitened columns
        half = solution(self.root, shown)
        mean = problem.raw(shown.T @ self.weighted, self.theta, self.roots)
        back = problem.raw(half.T, self.theta, self.roots)
        return Answer(problem.mean + mean, prior @ prior.T - back @ back.T)

    def _prior(self) -> Array:
        problem = self.space.problem
        return problem.raw(np.eye(problem.answered), self.theta, self.roots)

    def cells(self) -> Array:
        """Return the means of the rests of the cells that were visited."""
        problem = self.space.problem
        part = slice(problem.first_cell, problem.first_cell + len(problem.cells))
        factors = _factors(problem, self.theta)[part]
        return _raw_cells(problem, factors**2 * (problem.rows[:, part].T @ self.weighted))

    def left_out(self) -> tuple[Array, list[Array]]:
        """Return K⁻¹y and the blocks of K⁻¹ of each reading."""
        inverse = inverse_of_product(self.root)
        return self.weighted, [inverse[np.ix_(mine, mine)] for mine in _blocks_of(self.space.problem.reading)]

    def precision(self, columns: Array) -> Array:
        """Return K⁻¹B."""
        return solution_of_product(self.root, columns)


def _shown(problem: Problem, theta: Array, roots: Sequence[Array]) -> Array:
    """Return the answered columns with their priors applied, (m, answered): of unknowns of variance one."""
    own = problem.rows[:, problem.first :].copy()
    for curves, lower in zip(problem.curves, roots, strict=True):
        for columns, each in zip(curves.columns - problem.first, lower, strict=True):
            own[:, columns] = own[:, columns] @ each
    return np.asarray(own * _factors(problem, theta)[problem.first :])


def _raw_cells(problem: Problem, whitened: Array) -> Array:
    """Return rests of cells, (c,) m or rad, from unknowns whose prior is that of one rest over its size."""
    result, start = whitened.copy(), 0
    for root in problem.cell_roots:
        part = slice(start, start + len(root))
        result[part] = root @ whitened[part]
        start += len(root)
    return result


class Unknowns:
    """The room of the unknowns: Q (p, p)."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.groups = np.unique(problem.groups).tolist()
        each = [problem.groups == group for group in self.groups]
        self.counts = [int(mine.sum()) for mine in each]
        self.squares = [problem.rows[mine].T @ problem.rows[mine] for mine in each]
        self.products = [problem.rows[mine].T @ problem.values[mine] for mine in each]
        self.totals = [float(problem.values[mine] @ problem.values[mine]) for mine in each]

    def weights(self, theta: Array) -> Array:
        """Return 1/σ² of each group, (g,)."""
        result: Array = np.exp(-2 * np.append(theta, 0.0))[self.groups]
        return result

    def whitened(self, square: Array, theta: Array, roots: Sequence[Array]) -> Array:
        """Return D Lᵀ A L D, (p, p)."""
        result = square.copy()
        for curves, lower in zip(self.problem.curves, roots, strict=True):
            for columns, each in zip(curves.columns, lower, strict=True):
                part = slice(int(columns[0]), int(columns[-1]) + 1)
                result[:, part] = result[:, part] @ each
                result[part] = each.T @ result[part]
        factors = _factors(self.problem, theta)
        return np.asarray(result * factors * factors[:, None])

    def given(self, theta: Array) -> Given | None:
        """Return everything at sizes θ."""
        roots = [curves.roots(theta) for curves in self.problem.curves]
        weights = self.weights(theta)
        total = sum((w * square for w, square in zip(weights, self.squares, strict=True)), np.zeros(1))
        matrix = self.whitened(total, theta, roots)
        matrix[np.diag_indices_from(matrix)] += 1.0
        try:
            root = lower_root(matrix)
        except np.linalg.LinAlgError:
            return None
        return _InUnknowns(self, theta, root, roots)


@dataclass(eq=False)
class _InUnknowns:
    """Q = F Fᵀ at one set of sizes."""

    space: Unknowns
    theta: Array
    root: Array
    roots: list[Array]

    def __post_init__(self) -> None:
        space, weights = self.space, self.space.weights(self.theta)
        right = sum((w * each for w, each in zip(weights, space.products, strict=True)), np.zeros(1))
        for curves, lower in zip(space.problem.curves, self.roots, strict=True):
            for columns, each in zip(curves.columns, lower, strict=True):
                right[columns] = each.T @ right[columns]
        half = solution(self.root, right * _factors(space.problem, self.theta))
        self.solved = back_solution(self.root, half)
        scales = np.append(self.theta, 0.0)[space.groups]
        total = float(weights @ np.array(space.totals) - half @ half)
        self.value = -0.5 * total - float(np.log(np.diagonal(self.root)).sum()) - float(np.array(space.counts) @ scales)

    def slope(self) -> Slope:
        """Return value, gradient and information."""
        space, theta, u = self.space, self.theta, self.solved
        problem, k = space.problem, len(self.theta)
        w = -inverse_of_product(self.root)
        w[np.diag_indices_from(w)] += 1.0
        pick = np.zeros((len(u), k))
        sized = np.flatnonzero(problem.size_at >= 0)
        pick[sized, problem.size_at[sized]] = 1.0
        gradient = pick.T @ (u**2 - np.diagonal(w))
        information = 2 * pick.T @ ((w * w) @ pick)
        bent = list[_Bent]()
        for curves, lower in zip(problem.curves, self.roots, strict=True):
            lengths = curves.length_at.tolist()
            bent += [
                each for each in zip(lengths, curves.columns, curves.bends(theta, lower), strict=True) if each[0] >= 0
            ]
        for length, columns, bend in bent:
            gradient[length] += 0.5 * float(u[columns] @ bend @ u[columns] - np.sum(bend * w[np.ix_(columns, columns)]))
            cross = np.sum((bend @ w[columns]) * w[columns], axis=0) @ pick
            information[length] += cross
            information[:, length] += cross
        for length, columns, bend in bent:
            for other, beside, their in bent:
                between = w[np.ix_(columns, beside)]
                information[length, other] += 0.5 * float(np.sum((bend @ between) * (between @ their)))
        self._noises(gradient, information, w, (pick, bent))
        return Slope(self.value, gradient, information)

    def _noises(self, gradient: Array, information: Array, w: Array, others: tuple[Array, list[_Bent]]) -> None:
        """Add what the noises of the groups do, in place.  others : which size each column has, and the lengths."""
        space, (pick, bent) = self.space, others
        inverse = -w
        inverse[np.diag_indices_from(inverse)] += 1.0
        products = dict[int, tuple[int, Array]]()
        for index, group in enumerate(space.groups):
            if group < 0:
                continue
            weight = float(space.weights(self.theta)[index])
            gram = weight * space.whitened(space.squares[index], self.theta, self.roots)
            products[group] = space.counts[index], inverse @ gram
            gradient[group] += weight * self._left(index) - space.counts[index] + np.trace(products[group][1])
        for group, (count, product) in products.items():
            information[group, group] += 2 * (count - 2 * np.trace(product))
            for other, (_, beside) in products.items():
                information[group, other] += 2 * float(np.sum(product * beside.T))
            cross = 2 * np.sum(product * inverse, axis=1) @ pick
            for length, columns, bend in bent:
                cross[length] += float(np.sum(bend * (product[columns] @ inverse[:, columns])))
            information[group] += cross
            information[:, group] += cross

    def _left(self, index: int) -> float:
        """Return the sum of the squares that the estimate leaves of a group's numbers, over their base noise."""
        space, problem = self.space, self.space.problem
        raw = self.solved * _factors(problem, self.theta)
        for curves, lower in zip(problem.curves, self.roots, strict=True):
            for columns, each in zip(curves.columns, lower, strict=True):
                raw[columns] = each @ raw[columns]
        return float(space.totals[index] - 2 * raw @ space.products[index] + raw @ space.squares[index] @ raw)

    def answer(self) -> Answer:
        """Return the posterior of the answered unknowns: they stand last, so the trailing triangle is enough."""
        problem = self.space.problem
        first = problem.first
        turned = back_solution(self.root[first:, first:], np.eye(problem.answered))
        back = problem.raw(turned, self.theta, self.roots)
        return Answer(problem.mean + problem.raw(self.solved[first:], self.theta, self.roots), back @ back.T)

    def cells(self) -> Array:
        """Return the means of the rests of the cells that were visited."""
        problem = self.space.problem
        part = slice(problem.first_cell, problem.first_cell + len(problem.cells))
        return _raw_cells(problem, _factors(problem, self.theta)[part] * self.solved[part])

    def left_out(self) -> tuple[Array, list[Array]]:
        """Return K⁻¹y and the blocks of K⁻¹ of each reading, over the noise."""
        rows, roots = self._rows()
        half = solution(self.root, rows.T)
        weighted = roots * (self.space.problem.values * roots - rows @ self.solved)
        blocks = []
        for mine in _blocks_of(self.space.problem.reading):
            inner = np.eye(len(mine)) - half[:, mine].T @ half[:, mine]
            blocks.append(inner * roots[mine][:, None] * roots[mine])
        return weighted, blocks

    def precision(self, columns: Array) -> Array:
        """Return K⁻¹B."""
        rows, roots = self._rows()
        own = columns * roots[:, None]
        half = solution(self.root, rows.T @ own)
        return np.asarray(roots[:, None] * (own - rows @ back_solution(self.root, half)))

    def _rows(self) -> tuple[Array, Array]:
        """Return the columns of unknowns of variance one over the noise, (m, p), and one over the noise, (m,)."""
        problem, rows = self.space.problem, self.space.problem.rows.copy()
        for curves, lower in zip(problem.curves, self.roots, strict=True):
            for columns, each in zip(curves.columns, lower, strict=True):
                rows[:, columns] = rows[:, columns] @ each
        roots = 1 / np.sqrt(_noises(problem, self.theta))
        rows *= _factors(problem, self.theta) * roots[:, None]
        return rows, roots
