"""What would be known after some readings: a factor of the covariance that readings enter and leave.

Readings enter by Potter's update of F, with all their numbers at once. The result is C − H M⁻¹ Hᵀ with H = C Gᵀ and M =
R + G C Gᵀ. Readings leave by the same with −(R − G C Gᵀ)⁻¹. Both keep C = F Fᵀ positive semidefinite. No values are
needed: the covariance of linear Gaussian readings does not depend on them.

The gain of a reading follows from one product with [F, C Vᵀ]: ΔJ = gᵀCWCg / (σ² + gᵀCg), and with several numbers ΔJ =
tr(M⁻¹ N), N = G C W C Gᵀ, as these share information. As a ratio of two smooth functions of the place it is
tr(adj(M) N) / det(M). Both are divided by the same power of the noise, to stay within the range of numbers.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.accuracy.yardstick import Accuracy, Root, Yardstick
from axiscal.measurement.observation import JointRows, Observation
from axiscal.measurement.reading import Places
from axiscal.measurement.reading_rows import PlaceRows, rows_at, visited
from axiscal.numerics import Array
from axiscal_core.from_scipy import solution, solution_of_product, take_off
from axiscal_core.normal import condition
from axiscal_core.state import joint_gains

_MODERATE = 1e13
"""By Cholesky up to here, by singular values beyond: the first loses digits only near the inverse of rounding."""
_OPEN = 1e-9
"""Share of a number's noise: what is known better than that without a reading is not told apart from rounding."""
_NOUGHT = 1e-300
"""No division by nought."""


class ReadNumbers(NamedTuple):
    """ReadNumbers of readings that enter or leave together.  rows : (k, n); variances : (k,)"""

    rows: Array
    variances: Array
    leaving: bool = False


class _Turn(NamedTuple):
    """A factor F becomes F T, T = I − U s Uᵀ.  basis : U (r, k); values : σ; turn : Qᵀ (k, k); weights : η; shrink : s

    Let Fᵀ Gᵀ R^-½ = U σ Qᵀ. Where readings enter, s = 1 − 1/√(1 + σ²) and η = 1/(1 + σ²). Where they leave, s = 1 −
    √(1 + σ²/e) and η = −1/e, e = 1 − σ².
    """

    basis: Array
    values: Array
    turn: Array
    weights: Array
    shrink: Array

    @classmethod
    def from_numbers(cls, seen: Array, leaving: bool) -> _Turn:
        """Return what numbers make of a factor.  seen : Fᵀ Gᵀ R^-½ (r, k)"""
        basis, values, turn = _singular(seen)
        if leaving:
            left = np.maximum(1.0 - values**2, _OPEN)
            return cls(basis, values, turn, -1.0 / left, 1.0 - np.sqrt(1.0 + values**2 / left))
        return cls(basis, values, turn, 1.0 / (1.0 + values**2), 1.0 - 1.0 / np.hypot(1.0, values))


class LowRank(NamedTuple):
    """A covariance changes by −H η Hᵀ, where readings enter or leave, of k numbers together.

    The turn T G makes the noise of the numbers one and decorrelates their information. Otherwise the rounding of a
    number that tells all of a zero would drown the others.
    eta : (k, k) diagonal, (I + T G C Gᵀ Tᵀ)⁻¹ where they enter, −(I − T G C Gᵀ Tᵀ)⁻¹ where they leave
    h : (n, k) H = C Gᵀ Tᵀ; z : (n, k) C W H; omega : (k, k) Hᵀ W H; back : T⁻¹ (k, k)
    """

    eta: Array
    h: Array
    z: Array
    omega: Array
    back: Array

    @classmethod
    def by_turn(cls, turn: _Turn, sizes: Array, h: Array, z: Array, reach: Array) -> LowRank:
        """Return what numbers change.  sizes : the std of each, (k,); reach : V H (w, k)"""
        return cls(np.diag(turn.weights), h, z, reach.T @ reach, sizes[:, None] * turn.turn.T)

    @property
    def gain(self) -> float:
        """By how much J = tr(W C) falls."""
        return float(np.sum(self.eta * self.omega))


@dataclass(frozen=True, eq=False, slots=True)
class Scorer:
    """Gains under one belief.

    factor : F (n, r) with C = F Fᵀ; both : [F, C Vᵀ], (n, r + w)
    """

    observation: Observation
    factor: Array
    both: Array

    def split_all(self, seen: JointRows) -> tuple[Array, Array]:
        """Return N = G C W C Gᵀ and M = R + G C Gᵀ of readings with all their numbers, each (m, k, k)."""
        (count, values, size), rank = seen.rows.shape, self.factor.shape[1]
        products = (seen.rows.reshape(-1, size) @ self.both).reshape(count, values, -1)
        far, near = products[..., rank:], products[..., :rank]
        if values == 1:  # sums of squares are faster so
            above, below = np.einsum("mkx,mkx->m", far, far), np.einsum("mkx,mkx->m", near, near)
            return above[:, None, None], seen.covariances + below[:, None, None]
        return far @ far.swapaxes(1, 2), seen.covariances + near @ near.swapaxes(1, 2)

    def gains_at(self, setup: int, poses: Array, approaches: Array) -> Array:
        """Return the gain at poses, (m,).  poses, approaches : (m, q)."""
        return joint_gains(*self.split_all(self.observation.numbers(setup, poses, approaches)))


@dataclass(frozen=True, eq=False, slots=True)
class Covariance:
    """A covariance over all unknowns, those of visited cells included.

    root : V (w, k) of the criterion, W = VᵀV; both : [V F; F] (w + n, r), which change alike
    """

    observation: Observation
    root: Root
    both: Array

    @classmethod
    def from_factor(cls, observation: Observation, factor: Array, root: Root) -> Covariance:
        """Return the state with C = F Fᵀ.  factor : F (n, r)"""
        return cls(observation, root, np.vstack([root.times(factor), factor]))

    @property
    def value(self) -> float:
        """J = tr(W C)."""
        return float(np.sum(self.weighted**2))

    @property
    def weighted(self) -> Array:
        """V F (w, r), whose squared length is J."""
        return self.both[: len(self.root.matrix)]

    @property
    def factor(self) -> Array:
        """F (n, r) with C = F Fᵀ."""
        return self.both[len(self.root.matrix) :]

    def opened(self, places: Places) -> Covariance:
        """Return the state with columns for the cells that the places lie in."""
        return self.opened_to(visited(self.observation, places))

    def opened_to(self, after: Observation) -> Covariance:
        """Return the state with the columns that a map has beyond this one's."""
        if after is self.observation:
            return self
        extra = np.sqrt(self.observation.rest_variances(after))
        (size, rank), count = self.both.shape, len(extra)
        both = np.zeros((size + count, rank + count))
        both[:size, :rank] = self.both
        both[np.arange(size, size + count), np.arange(rank, rank + count)] = extra
        return replace(self, observation=after, both=both)

    def rows(self, places: Places) -> PlaceRows:
        """Return rows and variances of all numbers of readings; cells without columns count as noise."""
        return rows_at(self.observation, places)

    def entered(self, places: Places) -> tuple[Covariance, LowRank]:
        """Return the state after readings, and what all their numbers changed."""
        state = self.opened(places)
        rows, variances, _ = state.rows(places)
        return state.changed_by(ReadNumbers(rows, variances))

    def changed_by(self, part: ReadNumbers) -> tuple[Covariance, LowRank]:
        """Return the state after numbers have entered or left, and what they changed: F T, T of `_Turn`."""
        sizes = np.sqrt(part.variances)
        turn = _Turn.from_numbers(((part.rows / sizes[:, None]) @ self.factor).T, part.leaving)
        reach = (self.weighted @ turn.basis) * turn.values
        felt = (reach.T @ self.weighted).T
        seen = (np.hstack([turn.basis, felt]).T @ self.both.T).T  # thin factors first: twice as fast
        along, count = seen[:, : len(turn.values)], len(reach)
        h, z = along[count:] * turn.values, seen[count:, len(turn.values) :]
        taken = self.both.copy()
        take_off(taken, along * turn.shrink, turn.basis.T)
        return replace(self, both=taken), LowRank.by_turn(turn, sizes, h, z, reach)

    def after_readings(self, places: Places) -> Covariance:
        """Return the state after readings, all at once."""
        state = self.opened(places)
        if not len(places):
            return state
        return replace(state, both=informed(state.both, state.whitened(places)[0]))

    def whitened(self, places: Places) -> tuple[Array, NDArray[np.intp]]:
        """Return R^-½ G F (m, r) of all numbers of readings, and whose each is (m,), in order."""
        rows, variances, owner = self.rows(places)
        return (rows / np.sqrt(variances)[:, None]) @ self.factor, owner

    def scorer(self) -> Scorer:
        """Return the gains under this state."""
        return Scorer(self.observation, self.factor, np.hstack([self.factor, self.factor @ self.weighted.T]))


def _singular(matrix: Array) -> tuple[Array, Array, Array]:
    """Return U (r, k), σ (k,), Qᵀ (k, k) of a matrix (r, k); of one column by its length, which is all there is.

    Columns of U that belong to no σ, where k is more than r, are no unit vectors.
    """
    if matrix.shape[1] == 1:
        length = np.sqrt(np.sum(matrix**2, axis=0))
        return matrix / np.maximum(length, _NOUGHT), length, np.ones((1, 1))
    more = max(matrix.shape[1] - len(matrix), 0)  # numbers that have nothing to tell keep their noise
    basis, values, turn = np.linalg.svd(matrix, full_matrices=more > 0)
    return np.pad(basis, ((0, 0), (0, more))), np.pad(values, (0, more)), turn


def informed(factor: Array, scaled: Array) -> Array:
    """Return F T with T Tᵀ = (I + BᵀB)⁻¹: the factor after readings.  scaled : B = R^-½ G F, (m, r).

    Cholesky takes m r² + r³/3 + n r² operations. Singular values replace it where readings are far better than the
    prior: forming BᵀB would then lose the prior.
    """
    if np.sum(scaled**2) < _MODERATE:
        return solution(_triangle(scaled), factor.T).T
    _, values, right = np.linalg.svd(scaled, full_matrices=False)
    shrink = 1.0 - 1.0 / np.hypot(1.0, values)
    return np.asarray(factor - (factor @ right.T * shrink) @ right, dtype=np.float64)


def criterion_after(weighted: Array, scaled: Array) -> float:
    """Return tr(Φ (I + BᵀB)⁻¹ Φᵀ), J after readings.  weighted : Φ = V F (w, r); scaled : B as of `informed`, (m, r)

    In the room of the numbers where these are fewer, J − ‖L⁻¹ B Φᵀ‖² with L Lᵀ = I + B Bᵀ. Else only columns that a
    reading feels are solved for: of many set-ups each has unknowns of its own.
    """
    felt = np.any(scaled, axis=0)
    if len(scaled) < np.count_nonzero(felt) and np.sum(scaled**2) < _MODERATE:
        taken = solution(_triangle(scaled.T), scaled @ weighted.T)
        return float(np.sum(weighted**2) - np.sum(taken**2))
    return float(np.sum(weighted[:, ~felt] ** 2) + np.sum(informed(weighted[:, felt], scaled[:, felt]) ** 2))


def unexplained(target: Array, scaled: Array) -> Array:
    """Return Φ (I + BᵀB)⁻¹, (w, r), what readings leave of Φ = V F; as `informed` otherwise.  scaled : B (m, r)"""
    if np.sum(scaled**2) < _MODERATE:
        return solution_of_product(_triangle(scaled), target.T).T
    _, values, right = np.linalg.svd(scaled, full_matrices=False)
    return np.asarray(target - (target @ right.T * (values**2 / (1 + values**2))) @ right, dtype=np.float64)


def _triangle(scaled: Array) -> Array:
    """Return L (r, r), lower triangular, with L Lᵀ = I + BᵀB."""
    information: Array = scaled.T @ scaled
    information[np.diag_indices(len(information))] += 1.0
    return np.asarray(np.linalg.cholesky(information))


_TOGETHER = 80
"""Readings that are taken in at once: of speed, not of the result."""


def after_each(state: Covariance, yardstick: Yardstick, order: Places) -> Iterator[tuple[float, Accuracy]]:
    """Yield J and the accuracy after each of many readings.  state : before the first"""
    for start in range(0, len(order), _TOGETHER):
        part = order.within(slice(start, start + _TOGETHER))
        state = state.opened(part)
        rows, variances, owner = state.rows(part)
        unread, none = np.zeros(len(rows)), np.zeros(len(rows), dtype=np.intp)
        root, *_, losses = condition(state.factor, np.zeros(len(state.factor)), rows, unread, variances, none)
        ends = np.searchsorted(owner, np.arange(len(part)), side="right")
        values = state.value - np.cumsum(np.sum(state.root.times(losses.T) ** 2, axis=0))[ends - 1]
        yield from zip(values.tolist(), yardstick.accuracies(state.factor, losses, ends), strict=True)
        state = Covariance.from_factor(state.observation, root, state.root)
