"""Gains of a whole lattice, kept up to date while readings enter and leave: O(M n) per change, bound by memory traffic.

A change C ← C − H η Hᵀ has K = G H and T = G Z. Let S = K η and U = T − S Ω/2. The matrices of each candidate change: M
− R = G C Gᵀ to G C Gᵀ − S Kᵀ. Likewise N = G C W C Gᵀ changes to N − S Uᵀ − U Sᵀ. What a reading of the plan gains, and
what others would without it, follows from its rows when it is asked for.

A reading enters and leaves with all its numbers at once, and so do many readings.
"""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.reading import Places
from axiscal.numerics import Array
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.covariance import Covariance, LowRank, ReadNumbers
from axiscal_core.state import joint_gains

_SMALLEST = 1e-9
"""Share of the noise of a reading that counts as left of it where nothing is: no division by nought."""
_ALONE = 1e-7
"""Share of the noise of a reading: where its own variance is nearer to the noise, it alone holds an unknown."""


class Leavings(NamedTuple):
    """Effects of readings of a plan that leave, one at a time.

    grown, omega : E and Ω (m, w, w), without it C ← C + H E Hᵀ; least : eigenvalue of E⁻¹ (m,), m²
    """

    grown: Array
    omega: Array
    least: Array

    @property
    def losses(self) -> Array:
        """By how much J rises, (m,)."""
        return np.asarray(np.sum(self.grown * self.omega, axis=(1, 2)), dtype=np.float64)


Allowed = Callable[["Scores", int], NDArray[np.bool_]]
"""(scores, slot) -> which candidates (M,) may stand in that slot."""


class Scores:
    """The gains of the candidates of a pool while a plan is made.

    above, below : N and M of the candidates, each (w, w, M)
    places : of the readings of the plan, slot by slot; rows, noise : theirs, (N, w, n) and the variance (N,)
    begun : what was known before the first reading of the plan
    No array is changed in place: copies go their own ways.
    """

    def __init__(self, pool: Pool, state: Covariance) -> None:
        self.pool, self.state, self.begun = pool, state, state
        self.places, self.noise = Places.none(pool.lattice.poses.shape[1]), np.zeros(0)
        self.rows = np.zeros((0, pool.width, state.observation.size))
        self.above, self.below = pool.gain_forms(state.scorer())

    def told(self, columns: NDArray[np.intp]) -> Array:
        """Return the shares of the first variances of unknowns that each candidate takes away, summed, (M,)."""
        first = np.sqrt(self.state.observation.prior_variances()[columns])[:, None]
        scaled = self.state.factor @ (self.state.factor[columns[first[:, 0] > 0]] / first[first > 0][:, None]).T
        told = self.pool.grams(self.state.observation, scaled)
        return _gains(told, self.below)

    def fork(self) -> Self:
        """Return a copy that goes its own way."""
        return copy.copy(self)

    @property
    def gains(self) -> Array:
        """The gain of every candidate, (M,)."""
        return _gains(self.above, self.below)

    def enter(self, what: int | Places) -> float:
        """Take a candidate, or a reading at another single place, into the plan, and return by how much J falls."""
        place, rows, variance = self._read(what)
        return self._taken(place, rows, np.zeros(len(rows), dtype=np.intp), np.array([variance]))

    def exchange(self, slot: int, what: int | Places) -> float:
        """Put a candidate, or a reading at another single place, where another stands; return by how much J falls."""
        place, rows, variance = self._read(what)
        gone = self._changed(self._leaving(slot))
        self.places, self.noise, self.rows = self.places.exchanged(slot, place), self.noise.copy(), self.rows.copy()
        self.noise[slot], self.rows[slot], self.rows[slot, : len(rows)] = variance, 0.0, rows
        return gone + self._changed(ReadNumbers(rows, np.full(len(rows), variance)))

    def _read(self, what: int | Places) -> tuple[Places, Array, float]:
        """Return a reading's place, rows (k, n) and variance, with columns for the cells that it opens."""
        if isinstance(what, Places):
            self._open(self.state.opened(what))
            rows, variances, _ = self.state.rows(what)
            return what, rows, float(variances[0])
        self._open(self.state.opened_to(self.pool.opened(self.state.observation, what)))
        rows = self.pool.rows(self.state.observation, what)
        return self.pool.lattice.single(what), rows, float(self.pool.noise[what])

    def _open(self, state: Covariance) -> None:
        """Go on with a state that may have more columns."""
        if (more := state.observation.size - self.rows.shape[2]) > 0:
            self.state, self.rows = state, np.pad(self.rows, ((0, 0), (0, 0), (0, more)))

    def enter_all(self, places: Places) -> float:
        """Take readings into the plan together, after those that it has, and return by how much J falls."""
        if not len(places):
            return 0.0
        self._open(self.state.opened(places))
        rows, variances, owner = self.state.rows(places)
        return self._taken(places, rows, owner, variances[np.searchsorted(owner, np.arange(len(places)))])

    def _taken(self, places: Places, rows: Array, owner: NDArray[np.intp], noise: Array) -> float:
        """Take readings in.  rows : (k, n) of all numbers; owner : (k,) of which reading; noise : (m,)"""
        mine = np.zeros((len(places), *self.rows.shape[1:]))
        mine[owner, np.arange(len(rows)) - np.searchsorted(owner, owner)] = rows
        self.places, self.noise = Places.joined([self.places, places]), np.append(self.noise, noise)
        self.rows = np.concatenate([self.rows, mine])
        return self._changed(ReadNumbers(rows, noise[owner]))

    def leave(self, slot: int) -> float:
        """Take a reading out of the plan, and return by how much J rises."""
        gone = self._changed(self._leaving(slot))
        self.rows, self.noise = np.delete(self.rows, slot, axis=0), np.delete(self.noise, slot)
        self.places = self.places.without(slot)
        return -gone

    def known_without(self, slot: int) -> tuple[Covariance, LowRank]:
        """Return the state without a reading of the plan, and what that would change."""
        return self.state.changed_by(self._leaving(slot))

    def _leaving(self, slot: int) -> ReadNumbers:
        count = self._numbers(slot)
        return ReadNumbers(self.rows[slot, :count], np.full(count, self.noise[slot]), leaving=True)

    def without(self, slot: int) -> tuple[Array, float]:
        """Return the gains (M,) of the candidates were a reading not taken, and that of the reading itself."""
        near, far, left = self._left_by([slot])
        vectors = self.state.factor @ np.hstack([near[0].T, self.state.weighted.T @ far[0].T])
        seen = self.pool.products(self.state.observation, vectors)
        cross, reach = seen[: self.pool.width], seen[self.pool.width :]
        scaled, half = _scaled(-left.grown[0], left.omega[0], cross, reach)
        return _gains(*_after(self.above, self.below, scaled, half, cross)), float(left.losses[0])

    def losses(self) -> Array:
        """Return by how much J would rise were each reading of the plan not taken, (N,)."""
        return self._left_by(slice(None))[2].losses

    def held_alone(self, slot: int) -> bool:
        """Whether unknowns would open beyond the digits of a double without a reading of several numbers.

        The rest could not be told from rounding; such a reading keeps its place.
        """
        return self._numbers(slot) > 1 and bool(self._left_by([slot])[2].least[0] < _ALONE * self.noise[slot])

    def _left_by(self, which: list[int] | slice) -> tuple[Array, Array, Leavings]:
        """Return G F (m, w, r) and G F Φᵀ (m, w, k) of some readings, Φ = V F, and what they do where they leave."""
        near, noise = self.rows[which] @ self.state.factor, self.noise[which, None, None]
        far = near @ self.state.weighted.T
        values, vectors = np.linalg.eigh(noise * np.eye(self.pool.width) - near @ near.swapaxes(1, 2))
        grown = vectors / np.maximum(values, _SMALLEST * noise[:, 0])[:, None] @ vectors.swapaxes(1, 2)
        return near, far, Leavings(grown, far @ far.swapaxes(1, 2), values[:, 0])

    def _numbers(self, slot: int) -> int:
        """Return how many numbers a reading of the plan has."""
        return int(self.pool.numbers[self.places.setups[slot]])

    def _changed(self, numbers: ReadNumbers) -> float:
        """Bring everything up to date after numbers have entered or left, and return by how much J falls."""
        self.state, change = self.state.changed_by(numbers)
        seen = self.pool.products(self.state.observation, np.hstack([change.h, change.z]))
        cross, reach = seen[: len(change.eta)], seen[len(change.eta) :]
        scaled, half = _scaled(change.eta, change.omega, cross, reach)
        self.above, self.below = _after(self.above, self.below, scaled, half, cross)
        return change.gain


def _scaled(eta: Array, omega: Array, cross: Array, reach: Array) -> tuple[Array, Array]:
    """Return S and U.  eta, omega : (k, k); cross, reach : (k, w, m)"""
    scaled = np.tensordot(eta, cross, 1)
    return scaled, reach - np.tensordot(omega / 2, scaled, 1)


def _after(above: Array, below: Array, scaled: Array, half: Array, cross: Array) -> tuple[Array, Array]:
    """Return N and M after a change.  above, below : before, (w, w, m); the others : S, U and K, (k, w, m)"""
    crossed = np.einsum("kim,kjm->ijm", scaled, half)
    return above - crossed - crossed.swapaxes(0, 1), below - np.einsum("kim,kjm->ijm", scaled, cross)


def _gains(above: Array, below: Array) -> Array:
    """Return the gains (m,).  above, below : N and M, (w, w, m)"""
    return joint_gains(above.transpose(2, 0, 1), below.transpose(2, 0, 1))
