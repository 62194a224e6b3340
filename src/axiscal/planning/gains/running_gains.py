"""Gains of a whole lattice, kept up to date while readings enter and leave: O(M N) per change, bound by memory traffic.

A change C ← C − H η Hᵀ has K = G H and T = G Z. Let S = K η and U = T − S Ω/2. The matrices of each reading change: M −
R = G C Gᵀ to G C Gᵀ − S Kᵀ. Likewise N = G C W C Gᵀ changes to N − S Uᵀ − U Sᵀ. The same is true of the columns G C g_l
and G C W C g_l of the readings in the plan. With them it costs O(M) to take a reading out and to find its best
replacement.

A reading enters and leaves with all its numbers at once, and so do many readings.
"""

from __future__ import annotations

import copy
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.reading import Places
from axiscal.numerics import Array
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.covariance import Covariance, LowRank, ReadNumbers
from axiscal_core.from_scipy import take_off
from axiscal_core.state import joint_gains

_SMALLEST = 1e-9
"""Share of the noise of a reading that counts as left of it where nothing is: no division by nought."""
_ALONE = 1e-7
"""Share of the noise of a reading: where its own variance is nearer to the noise, it alone holds an unknown."""


class Leavings(NamedTuple):
    """Effects of the readings of a plan that leave, one at a time.

    grown, omega : E and Ω (N, w, w), without it C ← C + H E Hᵀ; least : eigenvalue of E⁻¹ (N,), m²
    """

    grown: Array
    omega: Array
    least: Array


class Scores:
    """The gains of the candidates of a pool while a plan is made.

    above, below : N and M of the candidates, then of the readings of the plan, each (w, w, M + N)
    places : of the readings of the plan, slot by slot; rows, noise : theirs, (N, w, n) and the variance (N,)
    last : the last change of the covariance; begun : what was known before the first reading of the plan
    """

    last: LowRank

    def __init__(self, pool: Pool, state: Covariance) -> None:
        self.pool, self.state, self.begun = pool, state, state
        self.places, self.noise = Places.none(pool.lattice.poses.shape[1]), np.zeros(0)
        self.rows = np.zeros((0, pool.width, state.observation.size))
        self.above, self.below = pool.gain_forms(state.scorer())
        self._columns: ReadingColumns | None = None
        self._leavings: Leavings | None = None

    def told(self, columns: NDArray[np.intp]) -> Array:
        """Return the shares of the first variances of unknowns that each candidate takes away, summed, (M,)."""
        first = np.sqrt(self.state.observation.prior_variances()[columns])[:, None]
        scaled = self.state.factor @ (self.state.factor[columns[first[:, 0] > 0]] / first[first > 0][:, None]).T
        told = self.pool.grams(self.state.observation, scaled)
        return _gains(told, self.below[:, :, : len(self.pool)])

    def fork(self) -> Self:
        """Return a copy that goes its own way."""
        other = copy.copy(self)
        other.above, other.below = self.above.copy(), self.below.copy()
        other.rows, other.noise = self.rows.copy(), self.noise.copy()
        other._columns = None if self._columns is None else self._columns.copy()
        return other

    @property
    def gains(self) -> Array:
        """The gain of every candidate, (M,)."""
        count = len(self.pool)
        return _gains(self.above[:, :, :count], self.below[:, :, :count])

    def enter(self, what: int | Places) -> float:
        """Take a candidate, or a reading at another single place, into the plan, and return by how much J falls."""
        place, rows, variance = self._read(what)
        self.places = Places.joined([self.places, place])
        return self._taken(
            np.array([len(self.places) - 1]), rows, np.zeros(len(rows), dtype=np.intp), np.array([variance])
        )

    def exchange(self, slot: int, what: int | Places) -> float:
        """Put a candidate, or a reading at another single place, where another stands; return by how much J falls."""
        place, rows, variance = self._read(what)
        self._make_room()
        state, left = self.known_without(slot)
        self._changed(left, *self._products(left))
        self.state, self.places = state, self.places.exchanged(slot, place)
        every = np.zeros(len(rows), dtype=np.intp)
        return left.gain + self._taken(np.array([slot]), rows, every, np.array([variance]))

    def _read(self, what: int | Places) -> tuple[Places, Array, float]:
        """Return a reading's place, rows (k, n) and variance, with columns for the cells that it opens."""
        if isinstance(what, Places):
            self.state = self.state.opened(what)
            rows, variances, _ = self.state.rows(what)
            return what, rows, float(variances[0])
        self.state = self.state.opened_to(self.pool.opened(self.state.observation, what))
        rows = self.pool.rows(self.state.observation, what)
        return self.pool.lattice.single(what), rows, float(self.pool.noise[what])

    def enter_all(self, places: Places) -> float:
        """Take readings into the plan together, after those that it has, and return by how much J falls."""
        if not len(places):
            return 0.0
        self.state = self.state.opened(places)
        rows, variances, owner = self.state.rows(places)
        slots = len(self.places) + np.arange(len(places))
        self.places = Places.joined([self.places, places])
        return self._taken(slots, rows, owner, variances[np.searchsorted(owner, np.arange(len(places)))])

    def _taken(self, slots: NDArray[np.intp], rows: Array, owner: NDArray[np.intp], noise: Array) -> float:
        """Take readings in.  slots : (m,); rows : (k, n) of all numbers; owner : (k,) of which reading; noise : (m,)"""
        inside = np.arange(len(rows)) - np.searchsorted(owner, owner)
        self._make_room()
        self.rows[slots], self.noise[slots] = 0.0, noise
        self.rows[slots[owner], inside] = rows
        self.state, self.last = self.state.changed_by(ReadNumbers(rows, noise[owner]))
        cross, reach = self._products(self.last)
        if self._columns is not None:
            self._columns.put(int(slots[0]), self._back(self.last, cross), self._back(self.last, reach))
        self._changed(self.last, cross, reach)
        self._own(slots, owner, inside)
        return self.last.gain

    def _own(self, slots: NDArray[np.intp], owner: NDArray[np.intp], inside: NDArray[np.intp]) -> None:
        """Find N and M of readings that have entered: a zero that opened before them is a million times their noise.

        T G C Gᵀ Tᵀ = 1 − η and V C Gᵀ Tᵀ = V H η after the last change.  As of `_taken`.
        """
        eta, own, width = self.last.eta, len(self.pool) + slots, self.pool.width
        shape = (len(slots), width, len(eta))
        back = np.zeros(shape)
        back[owner, inside] = self.last.back
        flat = back.reshape(-1, len(eta))  # one product of two matrices, not one for each reading
        far, near = (flat @ (eta @ self.last.omega @ eta)).reshape(shape), (flat - flat @ eta).reshape(shape)
        for whole, turned in ((self.above, far), (self.below, near)):
            whole[:, :, own] = (turned @ back.swapaxes(1, 2)).transpose(1, 2, 0)
        self.below[:, :, own] += np.eye(width)[:, :, None] * self.noise[slots]

    def _back(self, change: LowRank, turned: Array) -> Array:
        """Return what candidates see of the numbers of one reading, (w, w, M).  turned : (k, w, M + N)"""
        columns = np.zeros((self.pool.width, self.pool.width, len(self.pool)))
        columns[: len(turned)] = np.tensordot(change.back, turned[:, :, : len(self.pool)], 1)
        return columns

    def _make_room(self) -> None:
        """Make room for as many readings as there are places, over all unknowns."""
        more, size = len(self.places) - len(self.noise), self.state.observation.size
        if more:
            self._columns = None
            room = np.zeros((self.pool.width, self.pool.width, more))
            self.above, self.below = (np.concatenate([each, room], axis=2) for each in (self.above, self.below))
            self.noise = np.append(self.noise, np.zeros(more))
        if more or size > self.rows.shape[2]:
            rows, (count, width, known) = self.rows, self.rows.shape
            self.rows = np.zeros((count + more, width, size))
            self.rows[:count, :, :known] = rows

    def leave(self, slot: int) -> float:
        """Take a reading out of the plan, and return by how much J rises."""
        self.state, self.last = self.known_without(slot)
        self._columns = None
        self._changed(self.last, *self._products(self.last))
        own = len(self.pool) + slot
        self.above, self.below = np.delete(self.above, own, axis=2), np.delete(self.below, own, axis=2)
        self.rows, self.noise = np.delete(self.rows, slot, axis=0), np.delete(self.noise, slot)
        self.places = self.places.without(slot)
        return -self.last.gain

    def known_without(self, slot: int) -> tuple[Covariance, LowRank]:
        """Return the state without a reading of the plan, and what that would change."""
        count = self._numbers(slot)
        leaving = ReadNumbers(self.rows[slot, :count], np.full(count, self.noise[slot]), leaving=True)
        return self.state.changed_by(leaving)

    def without(self, slot: int) -> tuple[Array, float]:
        """Return the gains (M,) of the candidates were a reading not taken, and that of the reading itself."""
        left, every = self._left_by(), slice(len(self.pool))
        cross, reach = self._followed().against(slot)
        scaled, half = _scaled(-left.grown[slot], left.omega[slot], cross, reach)
        gains = _gains(*_after(self.above[:, :, every], self.below[:, :, every], scaled, half, cross))
        return gains, float(np.sum(left.grown[slot] * left.omega[slot]))

    def losses(self) -> Array:
        """Return by how much J would rise were each reading of the plan not taken, (N,)."""
        left = self._left_by()
        return np.asarray(np.sum(left.grown * left.omega, axis=(1, 2)), dtype=np.float64)

    def held_alone(self, slot: int) -> bool:
        """Whether unknowns would open beyond the digits of a double without a reading of several numbers.

        Tables from which it is taken hold nothing of the rest; such a reading keeps its place.
        """
        return self._numbers(slot) > 1 and bool(self._left_by().least[slot] < _ALONE * self.noise[slot])

    def _left_by(self) -> Leavings:
        """Return E = (R − G C Gᵀ)⁻¹ and Ω = G C W C Gᵀ of each reading, kept until something enters or leaves."""
        if self._leavings is None:
            omega, below = (each[:, :, len(self.pool) :].transpose(2, 0, 1) for each in (self.above, self.below))
            noise = self.noise[:, None, None]
            values, vectors = np.linalg.eigh(2 * noise * np.eye(self.pool.width) - below)
            grown = vectors / np.maximum(values, _SMALLEST * noise[:, 0])[:, None] @ vectors.swapaxes(1, 2)
            self._leavings = Leavings(grown, omega, values[:, 0])
        return self._leavings

    def _followed(self) -> ReadingColumns:
        """Return the columns of the readings of the plan, kept until there is another number of them."""
        if self._columns is None:
            half = self.state.factor.T @ self.rows.reshape(-1, self.rows.shape[2]).T
            weighted = self.state.weighted
            both = (self.state.factor @ each for each in (half, weighted.T @ (weighted @ half)))
            shape = (len(self.rows), self.pool.width, self.pool.width, len(self.pool))
            seen = (self.pool.products(self.state.observation, each).reshape(shape) for each in both)
            self._columns = ReadingColumns(*seen)
        return self._columns

    def _numbers(self, slot: int) -> int:
        """Return how many numbers a reading of the plan has."""
        return int(self.pool.numbers[self.places.setups[slot]])

    def _products(self, change: LowRank) -> tuple[Array, Array]:
        """Return rows times H and Z of a change, for candidates, then readings, each (k, w, M + N)."""
        vectors = np.hstack([change.h, change.z])
        mine = (self.rows @ vectors).transpose(2, 1, 0)
        seen = np.concatenate([self.pool.products(self.state.observation, vectors), mine], axis=2)
        return seen[: len(change.eta)], seen[len(change.eta) :]

    def _changed(self, change: LowRank, cross: Array, reach: Array) -> None:
        """Bring everything up to date after C ← C − H η Hᵀ.  cross, reach : as of `_products`"""
        scaled, half = _scaled(change.eta, change.omega, cross, reach)
        self.above, self.below = _after(self.above, self.below, scaled, half, cross)
        self._leavings = None
        if self._columns is not None:
            self._columns.change(scaled, half, cross)


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


class ReadingColumns:
    """What the candidates see of each of the readings.  cross, reach : (N, w, w, M), reading by reading."""

    def __init__(self, cross: Array, reach: Array) -> None:
        self._tables = np.stack([cross, reach])

    def copy(self) -> Self:
        """Return a copy that goes its own way."""
        return type(self)(*self._tables)

    def against(self, slot: int) -> tuple[Array, Array]:
        """Return G C Gᵀ and G C W C Gᵀ of the candidates and a reading, each (w, w, M), its own numbers first."""
        cross, reach = self._tables[:, slot]
        return cross, reach

    def put(self, slot: int, cross: Array, reach: Array) -> None:
        """Put a reading in the place of another.  cross, reach : (w, w, M)"""
        self._tables[:, slot] = cross, reach

    def change(self, scaled: Array, half: Array, cross: Array) -> None:
        """Take a change off: crossᵀ scaled, and halfᵀ scaled + scaledᵀ half; each (k, w, M + N), as of `Scores`."""
        count, rank = self._tables.shape[-1], len(scaled)
        both = np.concatenate([scaled, half])
        mine, right = both[:, :, count:].transpose(2, 1, 0), both[:, :, :count].reshape(len(both), -1)
        near = cross[:, :, count:].transpose(2, 1, 0).reshape(-1, rank)
        take_off(self._tables[0].reshape(len(near), -1), near, right[:rank])
        crossed = np.concatenate([mine[:, :, rank:], mine[:, :, :rank]], axis=2).reshape(len(near), -1)
        take_off(self._tables[1].reshape(len(near), -1), crossed, right)
