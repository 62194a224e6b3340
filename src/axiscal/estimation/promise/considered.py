"""Causes of type B, which no reading shows: they move no mean and teach no size, and count in every uncertainty.

Let G be the gain of the model without them, B (m, c) what one standard deviation of each does to the numbers. Then

    m = G y,    Var[F u] = F (C + G B (G B)ᵀ) Fᵀ

(Schmidt's consider form; GUM 4.3: knowledge from elsewhere, which these readings cannot improve). K + B Bᵀ judges the
readings, since two instruments may differ by their scales. There B lacks the causes that follow from what was read: a
column that is like the values explains them, whatever they are. With N = BᵀK⁻¹B (Woodbury)

    (K + B Bᵀ)⁻¹ = K⁻¹ − K⁻¹B (1 + N)⁻¹ BᵀK⁻¹
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.promise.problem import Problem
from axiscal.estimation.promise.spaces import Answered
from axiscal.estimation.promise.unknowns import Given
from axiscal.numerics import Array


@dataclass(frozen=True, eq=False)
class Considered:
    """Everything at one set of sizes, with causes of type B.  given : without them"""

    given: Given

    @property
    def theta(self) -> Array:
        """The sizes, (k,)."""
        return self.given.theta

    @property
    def value(self) -> float:
        """log L of the sizes, which causes of type B do not teach."""
        return self.given.value

    @property
    def problem(self) -> Problem:
        """The readings."""
        return self.given.space.problem

    def posterior(self) -> Answered:
        """Return the posterior of the answered unknowns: the mean without, the covariance with causes of type B."""
        found, moved = self.given.posterior(), self.given.type_b.gains
        return Answered(found.mean, found.covariance + moved @ moved.T) if moved.size else found

    def gain(self, columns: Array) -> Array:
        """Return G X, (answered, n) m and rad: by what the mean m = G y moves.  columns : X (m, n), over the noise"""
        return self.given.gain(columns)

    def cell_means(self) -> Array:
        """Return the means of the rests of the cells that were visited, (c,) m or rad."""
        return self.given.cell_means()

    @cached_property
    def _within(self) -> Array:
        """(1 + N)⁻¹, (c, c)."""
        judging = self.problem.judging
        fisher = self.given.type_b.fisher[np.ix_(judging, judging)]
        return np.asarray(np.linalg.inv(fisher + np.eye(len(fisher))), dtype=float)

    @cached_property
    def _spread(self) -> Array:
        """K⁻¹B, (m, c)."""
        return self.given.precision(self.problem.type_b[:, self.problem.judging])

    @property
    def _pulled(self) -> Array:
        """BᵀK⁻¹y, (c,)."""
        return self.given.type_b.pulled[self.problem.judging]

    @property
    def square(self) -> float:
        """yᵀ(K + B Bᵀ)⁻¹y."""
        return float(self.given.square - self._pulled @ self._within @ self._pulled)

    @property
    def density(self) -> float:
        """log N(y; 0, K + B Bᵀ), up to a constant of the readings."""
        gained = self.given.square - self.square + np.linalg.slogdet(self._within)[1]
        return float(self.value + 0.5 * gained)

    def precision(self, columns: Array) -> Array:
        """Return (K + B Bᵀ)⁻¹X, (m, n).  columns : X (m, n), over the noise"""
        result: Array = self.given.precision(columns)
        if self.problem.judging.any():
            result = result - self._spread @ (self._within @ (self._spread.T @ columns))
        return result

    def left_out(self, part: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return (K + B Bᵀ)⁻¹y (r, k), over the noise, and blocks of the inverse (r, k, k).

        part : (r, k) numbers of readings
        """
        weighted, blocks = self.given.left_out(part)
        if not self.problem.judging.any():
            return weighted, blocks
        mine = self._spread[part]
        shared = mine @ self._within
        return weighted - shared @ self._pulled, blocks - shared @ mine.transpose(0, 2, 1)
