"""What would be known after some readings: a factor of the covariance that readings enter and leave.

A reading enters by Potter's update of F, C − hhᵀ/s with h = Cg and s = σ² + gᵀCg; it leaves by one more column,
C + hhᵀ/e with e = σ² − gᵀCg. Both keep C = F Fᵀ positive semidefinite. No values are needed: the covariance of linear
Gaussian readings does not depend on them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.accuracy.criterion import Root, need_root
from axiscal.belief import Belief
from axiscal.design.gains.gain import Scorer
from axiscal.measurement.observation import Observation
from axiscal.measurement.place import Places
from axiscal.measurement.reading_rows import PlaceRows, rows_at
from axiscal.measurement.visits import visited
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import solution
from axiscal.numerics.gaussian import lower_root

_MODERATE = 1e13
"""By Cholesky up to here, by singular values beyond: the first loses digits only near the inverse of rounding."""
_SPARE = 48
"""How many columns a factor may have beyond its rows before it is made square again."""


class RankOne(NamedTuple):
    """A covariance changes by −η h hᵀ.

    eta : 1/s where a reading enters, −1/e where it leaves; h : C g; z : C W h; omega : hᵀ W h
    """

    eta: float
    h: Array
    z: Array
    omega: float

    @property
    def gain(self) -> float:
        """By how much J = tr(W C) falls."""
        return self.eta * self.omega


@dataclass(frozen=True, eq=False, slots=True)
class Covariance:
    """A covariance over all unknowns, those of visited cells included.

    factor : F (n, r) with C = F Fᵀ; root : V (w, k) of the criterion, W = VᵀV
    """

    observation: Observation
    factor: Array
    root: Root

    @classmethod
    def of(cls, observation: Observation, belief: Belief, root: Root) -> Covariance:
        """Return the state of a belief; raises ShapeError where another thing than a root is given."""
        return cls(observation, belief.factor, need_root(root))

    @property
    def value(self) -> float:
        """J = tr(W C)."""
        return float(np.sum(self.weighted**2))

    @property
    def weighted(self) -> Array:
        """V F (w, r), whose squared length is J."""
        return self.root.of(self.factor)

    def opened(self, places: Places) -> Covariance:
        """Return the state with columns for the cells that the places lie in."""
        after = visited(self.observation, places)
        if after is self.observation:
            return self
        extra = np.sqrt(self.observation.rest_variances(after))
        (size, rank), count = self.factor.shape, len(extra)
        factor = np.zeros((size + count, rank + count))
        factor[:size, :rank] = self.factor
        factor[np.arange(size, size + count), np.arange(rank, rank + count)] = extra
        return replace(self, observation=after, factor=factor)

    def rows(self, places: Places) -> PlaceRows:
        """Return rows and variances of all numbers of readings; cells without columns count as noise."""
        return rows_at(self.observation, places)

    def entered(self, places: Places) -> tuple[Covariance, tuple[RankOne, ...]]:
        """Return the state after readings, and what their numbers changed, one after another."""
        state, changes = self.opened(places), list[RankOne]()
        rows, variances, _ = state.rows(places)
        for row, variance in zip(rows, variances.tolist(), strict=True):
            changes.append(state.change(row, variance))
            state = state.after(row, variance, changes[-1])
        return state, tuple(changes)

    def change(self, row: Array, variance: float, leaving: bool = False) -> RankOne:
        """Return what a reading with this row does when it enters, or leaves."""
        h: Array = self.factor @ (row @ self.factor)
        reach = self.root.of(h)
        z: Array = self.factor @ ((self.root.matrix.T @ reach) @ self.factor[: self.root.size])
        spread = float(row @ h)
        eta = -1.0 / max(variance - spread, 1e-9 * variance) if leaving else 1.0 / (variance + spread)
        return RankOne(eta, h, z, float(reach @ reach))

    def after(self, row: Array, variance: float, change: RankOne) -> Covariance:
        """Return the state after a reading has entered (Potter) or left."""
        if change.eta < 0:
            widened = np.column_stack([self.factor, change.h * np.sqrt(-change.eta)])
            size, rank = widened.shape
            return replace(self, factor=np.linalg.qr(widened.T).R.T if rank > size + _SPARE else widened)
        along = row @ self.factor
        scale = change.eta / (1.0 + np.sqrt(variance * change.eta))
        return replace(self, factor=self.factor - np.outer(change.h, along * scale))

    def after_readings(self, places: Places) -> Covariance:
        """Return the state after readings, all at once."""
        state = self.opened(places)
        if not len(places):
            return state
        return replace(state, factor=informed(state.factor, state.whitened(places)[0]))

    def whitened(self, places: Places) -> tuple[Array, NDArray[np.intp]]:
        """Return R^-½ G F (m, r) of all numbers of readings, and whose each is (m,), in order."""
        rows, variances, owner = self.rows(places)
        return (rows / np.sqrt(variances)[:, None]) @ self.factor, owner

    def scorer(self) -> Scorer:
        """Return the gains under this state."""
        weighted = self.weighted
        return Scorer(self.observation, self.factor, weighted, np.hstack([self.factor, self.factor @ weighted.T]))


def informed(factor: Array, scaled: Array) -> Array:
    """Return F T with T Tᵀ = (I + BᵀB)⁻¹: the factor after readings.  scaled : B = R^-½ G F, (m, r).

    By Cholesky, m r² + r³/3 + n r² operations; by singular values where readings are so much better than the prior that
    forming BᵀB would lose it.
    """
    if np.sum(scaled**2) < _MODERATE:
        information = np.eye(scaled.shape[1]) + scaled.T @ scaled
        return solution(lower_root(information), factor.T).T
    _, values, right = np.linalg.svd(scaled, full_matrices=False)
    shrink = 1.0 - 1.0 / np.hypot(1.0, values)
    return np.asarray(factor - (factor @ right.T * shrink) @ right, dtype=np.float64)
