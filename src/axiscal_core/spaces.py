"""The likelihood of sizes and its exact gradient, in two rooms with one interface.

`Unknowns` works with Q = 1 + D Lᵀ (Σ_g A_g/σ_g²) L D, A_g = Z_gᵀ Z_g, whatever the number of readings. `Numbers` works
with K = Σ_f s_f² B_f + σ² of the numbers, whatever the number of unknowns. With Q = F Fᵀ, v = F⁻¹b, u = F⁻ᵀv, W = 1 −
Q⁻¹

    log L = −½(Σ y_gᵀy_g/σ_g² − vᵀv) − Σ log F_ii − Σ n_g log σ_g
    ∂/∂log s_f = |u_f|² − tr W_ff,                    I(f, g) = 2 |W_fg|²
    ∂/∂log l   = ½(uᵀM u − tr M W_bb),                I(l, f) = Σ (M W)∘W over b × f,  I(l, l') = ½ tr(M W M' W')
    ∂/∂log σ_g = |e_g|²/σ_g² − n_g + tr(Q⁻¹ B_g),     I(σ_g, σ_g) ≈ 2 (n_g − tr(Q⁻¹ B_g))

With K = F Fᵀ, a = K⁻¹y and P_f = K⁻¹ ∂K_f the gradient is g = ½(aᵀ∂K_f a − tr P_f). The Fisher information I = ½ Σ P_f
∘ P_gᵀ is that of Gaussian regression (Rasmussen and Williams 2006, eq. 5.9).

Causes of type B, which no reading shows, move no mean and teach no size, and count in every uncertainty. With the gain
G of the model without them, and B (m, c) what one standard deviation of each does to the numbers,

    m = G y,    Var[F u] = F (C + G B (G B)ᵀ) Fᵀ

(Schmidt's consider form; GUM 4.3: knowledge from elsewhere, which these readings cannot improve). K + B Bᵀ judges the
readings, since two instruments may differ by their scales. There B lacks the causes that follow from what was read: a
column that is like the values explains them, whatever they are. With N = BᵀK⁻¹B (Woodbury)

    (K + B Bᵀ)⁻¹ = K⁻¹ − K⁻¹B (1 + N)⁻¹ BᵀK⁻¹
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal_core.problem import Problem, by_blocks
from axiscal_core.refusals import Array


class Slope(NamedTuple):
    """log L of θ, its gradient (k,) and the Fisher information (k, k)."""

    value: float
    gradient: Array
    information: Array


class Answered(NamedTuple):
    """Mean (answered,) and covariance (answered, answered) of the answered unknowns, m and rad."""

    mean: Array
    covariance: Array


class Caused(NamedTuple):
    """What causes of type B do at one set of sizes, with B (m, c) of one standard deviation each.

    gains : G B (answered, c) m and rad; fisher : N = BᵀK⁻¹B (c, c); pulled : BᵀK⁻¹y (c,)
    """

    gains: Array
    fisher: Array
    pulled: Array


class Sources(NamedTuple):
    """Mean squares of figures that the prior of each column leaves (p,), and causes of type B (c,).

    setups : (s,) what the noise of each set-up that was read leaves, by its index
    """

    columns: Array
    setups: Array
    causes: Array


class Sums(NamedTuple):
    """Of D, the numbers from each start, and from the end, to the end: DᵀK⁻¹D = own + low s lowᵀ.

    own : (k, k, u + 1); low : (k, u + 1, q); signs : s (q,); pulled : DᵀK⁻¹y (k, u + 1)
    K is that with the causes of type B that judge.
    """

    own: Array
    low: Array
    signs: Array
    pulled: Array

    def to_the_end(self) -> tuple[Array, Array]:
        """Return DᵀK⁻¹D (u, k, k) and DᵀK⁻¹y (u, k) from each start on."""
        low = self.low[:, :-1].transpose(1, 0, 2)
        fisher = self.own[:, :, :-1].transpose(2, 0, 1) + (low * self.signs) @ low.transpose(0, 2, 1)
        return fisher, self.pulled[:, :-1].T

    def between(self, begin: NDArray[np.intp], end: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return DᵀK⁻¹D and DᵀK⁻¹y of the only column from some starts to some others, (b, e) both."""
        low, own, pulled = self.low[0], self.own[0, 0], self.pulled[0]
        alone, both = low**2 @ self.signs, (low[begin] * self.signs) @ low[end].T
        square = (alone + own)[begin, None] + (alone - own)[end] - 2 * both
        return square, pulled[begin, None] - pulled[end]


@dataclass(eq=False)
class Given(ABC):
    """Everything at one set of sizes.

    theta : (k,) the sizes; roots : of the curves' priors there; root : F of the room
    value : log L of the sizes; square : yᵀK⁻¹y
    """

    problem: Problem
    theta: Array
    roots: list[Array]
    root: Array
    value: float = field(init=False)
    square: float = field(init=False)

    @abstractmethod
    def slope(self) -> Slope:
        """Return log L, gradient and information."""

    @abstractmethod
    def unlearnt(self) -> tuple[Array, Array]:
        """Return the block of Q⁻¹ of scales and answered unknowns, which stand last, and their u."""

    def without_causes(self) -> Answered:
        """Return the posterior of the answered unknowns without causes of type B."""
        problem, (left, u) = self.problem, self.unlearnt()
        half = problem.raw(left, self.theta, self.roots)
        covariance = problem.raw(half.T, self.theta, self.roots)
        return Answered(problem.mean + problem.raw(u, self.theta, self.roots), covariance)

    @abstractmethod
    def precision(self, columns: Array) -> Array:
        """Return K⁻¹X, (m, n).  columns : X (m, n), over the noise"""

    @abstractmethod
    def blocks(self, part: NDArray[np.intp]) -> Array:
        """Return the blocks of K⁻¹, (r, k, k), over the noise.  part : (r, k) numbers of readings"""

    @abstractmethod
    def shown(self, columns: Array, starts: NDArray[np.intp], part: slice) -> tuple[Array, Array]:
        """Return own (k, k, u), as of `Sums`, and what columns show from start to start, (k, u, n).

        columns : (k, n) of a part of the numbers.  It is the same at all sizes with the same noise.
        """

    @abstractmethod
    def halves(self, shown: Array) -> tuple[Array, float]:
        """Return low (k, u, q) and sign, as of `Sums`."""

    @cached_property
    def _solved(self) -> Array:
        """K⁻¹y, and K⁻¹B of all causes of type B, (m, 1 + c)."""
        return self.precision(np.column_stack([self.problem.values, self.problem.type_b]))

    @property
    def weighted(self) -> Array:
        """K⁻¹y, (m,)."""
        return self._solved[:, 0]

    @property
    def spread(self) -> Array:
        """K⁻¹B of all causes of type B, (m, c)."""
        return self._solved[:, 1:]

    @cached_property
    def every(self) -> tuple[Array, Array]:
        """(K + B Bᵀ)⁻¹y (m,) and K⁻¹B (m, c) of the causes that judge, over the noise."""
        judging = self.problem.judging
        mine = self.spread[:, judging]
        return self.weighted - mine @ (self.within @ self.type_b.pulled[judging]), mine

    def cell_means(self) -> Array:
        """Return the means of the rests of the cells that were visited, (c,) m or rad."""
        problem = self.problem
        part = slice(problem.first_cell, problem.first_cell + len(problem.cells))
        factors = factors_of(problem, self.theta)[part]
        alike = factors**2 * (problem.rows[:, part].T @ self.weighted)
        return np.asarray(by_blocks(alike[None], [root.T for root in problem.cell_roots])[0])

    def _moved(self, spread: Array) -> Array:
        """Return G X, (answered, n) m and rad.  spread : K⁻¹X (m, n)"""
        problem = self.problem
        moved = turned(problem, spread.T @ problem.rows, self.theta, self.roots, problem.first)
        return problem.raw(moved.T, self.theta, self.roots)

    @cached_property
    def type_b(self) -> Caused:
        """What causes of type B do."""
        problem, spread = self.problem, self.spread
        return Caused(self._moved(spread), problem.type_b.T @ spread, spread.T @ problem.values)

    def posterior(self) -> Answered:
        """Return the posterior of the answered unknowns: the mean without, the covariance with causes of type B."""
        found, moved = self.without_causes(), self.type_b.gains
        return Answered(found.mean, found.covariance + moved @ moved.T) if moved.size else found

    def sources(self, figures: Array) -> Sources:
        """Return what each source of variance leaves of figures of the answered unknowns.  figures : F (k, answered)"""
        columns, setups = self._shares(self.problem.whitened(figures.T, self.theta, self.roots))
        return Sources(columns, setups, np.sum((figures @ self.type_b.gains) ** 2, axis=0))

    @abstractmethod
    def _shares(self, own: Array) -> tuple[Array, Array]:
        """Return columns and setups, as of `Sources`, of figures of whitened unknowns.  own : (p − first, k)"""

    @cached_property
    def within(self) -> Array:
        """(1 + N)⁻¹, (c, c)."""
        judging = self.problem.judging
        fisher = self.type_b.fisher[np.ix_(judging, judging)]
        return np.asarray(np.linalg.inv(fisher + np.eye(len(fisher))), dtype=float)

    @property
    def misfit(self) -> float:
        """yᵀ(K + B Bᵀ)⁻¹y."""
        return self._judged_square(self.square, self.type_b.pulled)

    def misfit_of(self, values: Array) -> float:
        """Return the same of other values.  values : (m,) over the noise"""
        solved = self.precision(values[:, None])[:, 0]
        return self._judged_square(float(values @ solved), self.problem.type_b.T @ solved)

    def _judged_square(self, square: float, pulled: Array) -> float:
        mine = pulled[self.problem.judging]
        return float(square - mine @ self.within @ mine)

    @property
    def density(self) -> float:
        """log N(y; 0, K + B Bᵀ), up to a constant of the readings."""
        gained = self.square - self.misfit + np.linalg.slogdet(self.within)[1]
        return float(self.value + 0.5 * gained)

    def judged(self, columns: Array) -> Array:
        """Return (K + B Bᵀ)⁻¹X, (m, n).  columns : X (m, n), over the noise"""
        return self.precision(columns) - self.every[1] @ (self.within @ (self.every[1].T @ columns))

    def left_out(self, part: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return (K + B Bᵀ)⁻¹y (r, k), over the noise, and blocks of the inverse (r, k, k).

        part : (r, k) numbers of readings
        """
        weighted, mine = (each[part] for each in self.every)
        return weighted, self.blocks(part) - mine @ self.within @ mine.transpose(0, 2, 1)


def sums_of(each: Sequence[Given], columns: Array, starts: NDArray[np.intp]) -> Iterator[Sums]:
    """Yield the sums of columns at some sizes, all with the same noise.

    columns : (k, m), over the noise; starts : (u,) numbers, ascending
    """
    stop = int(np.flatnonzero(columns.any(axis=0))[-1]) + 1 if columns.any() else columns.shape[1]
    part, starts = slice(starts[0], max(stop, starts[-1] + 1)), starts - starts[0]
    columns = columns[:, part]
    own, shown = each[0].shown(columns, starts, part)
    for given in each:
        (weighted, spread), root = (one[part] for one in given.every), np.linalg.cholesky(given.within)
        low, sign = given.halves(shown)
        shared = np.add.reduceat(columns[:, :, None] * (spread @ root), starts, axis=1)
        signs = np.append(np.full(low.shape[2], sign), np.full(len(root), -1.0))
        pulled = np.add.reduceat(columns * weighted, starts, axis=1)
        yield Sums(_from_each(own, 2), _from_each(np.dstack([low, shared]), 1), signs, _from_each(pulled, 1))


def _from_each(parts: Array, axis: int) -> Array:
    """Return the sums from each part to the last one, and behind it nought, along an axis."""
    grown = np.flip(np.cumsum(np.flip(parts, axis), axis=axis), axis)
    return np.insert(grown, parts.shape[axis], 0.0, axis)


def parts_of(reading: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """Return the numbers of the readings that have as many of them, (r, k) each.  reading : (m,) ascending"""
    _, first, counts = np.unique(reading, return_index=True, return_counts=True)
    return [first[counts == k][:, None] + np.arange(k) for k in np.unique(counts)]


def variances_of(problem: Problem, theta: Array) -> Array:
    """Return the variances of the numbers, times their own, (m,)."""
    return np.asarray(np.exp(2 * np.append(theta, 0.0))[problem.groups])


def factors_of(problem: Problem, theta: Array) -> Array:
    """Return the size of each column, (p,)."""
    return np.asarray(np.exp(np.append(theta, 0.0))[problem.size_at])


def times_roots(rows: Array, columns: NDArray[np.intp], lower: Array) -> None:
    """Multiply columns (f, k) of rows (m, p) by the root of each curve (f, k, k), in place."""
    rows[:, columns] = (rows[:, columns].transpose(1, 0, 2) @ lower).transpose(1, 0, 2)


def turned(problem: Problem, rows: Array, theta: Array, roots: Sequence[Array], start: int = 0) -> Array:
    """Return Z L D, the columns from `start` on of unknowns of variance one, (m, p − start).  rows : Z (m, p)"""
    result = rows[:, start:].copy()
    for curves, lower in zip(problem.curves, roots, strict=True):
        times_roots(result, curves.columns - start, lower)
    result *= factors_of(problem, theta)[start:]
    return result


def raised(problem: Problem, unknowns: Array, theta: Array, roots: Sequence[Array], start: int = 0) -> Array:
    """Return L D u, the unknowns from `start` on, (p − start, n).  unknowns : u of variance one, from `start` on"""
    result = unknowns * factors_of(problem, theta)[start:, None]
    for curves, lower in zip(problem.curves, roots, strict=True):
        result[curves.columns - start] = lower @ result[curves.columns - start]
    return result
