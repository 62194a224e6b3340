"""The estimate of all numbers of all readings at once, when each reading has a weight.

y = Φ z + v, z ~ N(0, 1), v ~ N(0, σ²/w):  with D = diag(w/σ²) and M = 1 + Φᵀ D Φ the estimate of Φ z is Φ M⁻¹ Φᵀ D y,
its variance v = diag(Φ M⁻¹ Φᵀ). With M = L Lᵀ both come from X = L⁻¹ Φᵀ: 2 m r² + r³/3 operations, 16 m r bytes, each
block of numbers and unknowns that have nothing in common with the others apart.

A number i that is taken out moves all by its column c = Φ M⁻¹ φ_i, with f = w_i/(1 − w_i v_i), w in units of 1/σ²:

    left + f left_i c,    v + f c²,    and the column of another one, k, becomes c_k + f c_k[i] c

so neither M⁻¹ nor its change is formed: 8 m bytes and 2 m operations for each number, not 8 r² and 4 r² + 2 m r.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from copy import copy
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.inference.reading_set import ReadingSet
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import solution
from axiscal.numerics.gaussian import lower_root, unique_root


class _TakenOut(NamedTuple):
    """The estimate before a number was taken out, and what that did: f (), its column c (m,)."""

    before: Fitted
    factor: float
    column: Array


class _SharedUnknowns(NamedTuple):
    """Numbers, and their features by the unknowns that they alone depend on, (numbers, unknowns)."""

    numbers: NDArray[np.intp]
    features: Array


class _Half(NamedTuple):
    """X = L⁻¹ Φᵀ of some numbers, (unknowns, numbers), and these."""

    numbers: NDArray[np.intp]
    root: Array


class Fitted:
    """Numbers, their estimate, and how much they surprise.

    features : (m, r) Φ; noise : (m,) σ²; values : (m,); reading : (m,) index of the reading of each number
    left : (m,) values minus estimate; spread : (m,) variances v
    """

    def __init__(self, features: Array, noise: Array, values: Array, reading: NDArray[np.intp]) -> None:
        self._features, self.noise, self.values, self.reading = _short(features), noise, values, reading
        self._halves = [_Half(np.arange(len(values)), self._features.T)]
        self._apart: list[_SharedUnknowns] | None = None
        self._taken: _TakenOut | None = None
        self._columns = dict[int, Array]()
        self._trust = 1.0 / noise
        self.left, self.spread = values.copy(), np.sum(self._features**2, axis=1)

    @classmethod
    def of(
        cls, observation: Observation, readings: Sequence[Reading], prior: tuple[Array, Array] | None = None
    ) -> Fitted:
        """Return the numbers of readings, by the stated model or another prior of the errors (mean, covariance)."""
        numbers, size = ReadingSet(observation, readings), observation.errors.size
        values, root = numbers.values, observation.errors.prior_root() if prior is None else unique_root(prior[1])
        if prior is not None:
            values = values - numbers.rows[:, :size] @ prior[0]
        return cls(numbers.features(root), numbers.noise + numbers.extra_variance, values, numbers.reading)

    def covariance(self) -> Array:
        """Return the covariance of the numbers before any was read, noise included, (m, m)."""
        return self._features @ self._features.T + np.diag(self.noise)

    def estimate(self, values: Array, precisions: Array) -> tuple[Array, Array]:
        """Return mean and variance of the numbers without noise, (m,), if these values had these precisions 1/σ²."""
        information = np.eye(self._features.shape[1]) + (self._features.T * precisions) @ self._features
        spread = self._features @ np.asarray(np.linalg.inv(information), dtype=float)
        mean: Array = spread @ (self._features.T @ (precisions * values))
        return mean, np.einsum("mr,mr->m", spread, self._features)

    def weigh(self, weights: Array) -> None:
        """Estimate with a weight for each reading, (readings,)."""
        self._trust = weights[self.reading] / self.noise
        if self._apart is None:
            self._apart = list(_blocks(self._features))
        self._taken, self._columns, self._halves = None, {}, []
        self.left, self.spread = self.values.copy(), np.zeros(len(self.values))
        for numbers, part in self._apart:
            trust, values = self._trust[numbers], self.values[numbers]
            scaled = part * np.sqrt(trust)[:, None]
            half = solution(lower_root(np.eye(part.shape[1]) + scaled.T @ scaled), part.T)
            self.left[numbers] = values - (half @ (trust * values)) @ half
            self.spread[numbers] = np.einsum("rm,rm->m", half, half)
            self._halves.append(_Half(numbers, half))

    def without(self, reading: int) -> Fitted:
        """Return the estimate without one reading, by a correction of rank one for each of its numbers."""
        other = self
        for number in np.flatnonzero(self.reading == reading).tolist():
            other = other._dropped(number)
        return other

    def _dropped(self, number: int) -> Fitted:
        column, other = self._column(number), copy(self)
        factor = self._trust[number] / (1.0 - self._trust[number] * self.spread[number])
        other._taken, other._columns = _TakenOut(self, factor, column), {}
        other.left = self.left + factor * self.left[number] * column
        other.spread = self.spread + factor * column**2
        other._trust = self._trust.copy()
        other._trust[number] = 0.0
        return other

    def _column(self, number: int) -> Array:
        """Return Φ M⁻¹ φ of a number, (m,), from the last estimate on the way here that was asked for it."""
        way, at = list[_TakenOut](), self
        while number not in at._columns and at._taken is not None:
            way.append(at._taken)
            at = at._taken.before
        if number not in at._columns:
            at._columns[number] = at._first_column(number)
        found = at._columns[number]
        for _, factor, column in reversed(way):
            found = found + factor * column[number] * column
        self._columns[number] = found
        return found

    def _first_column(self, number: int) -> Array:
        """Return the same where none was taken out: nought for numbers that have nothing in common with it."""
        column = np.zeros(len(self.values))
        for numbers, half in self._halves:
            at = np.searchsorted(numbers, number)
            if at < len(numbers) and numbers[at] == number:
                column[numbers] = half.T @ half[:, at]
        return column

    @property
    def surprise(self) -> Array:
        """How far each number is from what the others predict, in standard deviations, signed, (m,)."""
        open_part = np.maximum(1.0 - self.spread * self._trust, 1e-12)
        surprise: Array = self.left / open_part / np.sqrt(self.spread / open_part + self.noise)
        return surprise


def _blocks(features: Array) -> Iterator[_SharedUnknowns]:
    """Yield numbers and unknowns that have nothing in common with the others.  features : (m, r)"""
    felt = features != 0
    left = felt.any(axis=0)
    while left.any():
        unknowns = np.zeros_like(left)
        further = np.arange(len(left)) == np.argmax(left)
        while np.any(further & ~unknowns):
            unknowns = further
            numbers = felt[:, unknowns].any(axis=1)
            further = felt[numbers].any(axis=0)
        whole = numbers.all() and unknowns.all()
        yield _SharedUnknowns(np.flatnonzero(numbers), features if whole else features[np.ix_(numbers, unknowns)])
        left &= ~unknowns


def _short(features: Array) -> Array:
    """Return features with the same products of rows, no more of them than there are rows."""
    if features.shape[1] <= len(features):
        return features
    triangle: Array = np.asarray(np.linalg.qr(features.T, mode="r"))
    return triangle.T
