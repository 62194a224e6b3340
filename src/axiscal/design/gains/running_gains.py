"""Gains of a whole lattice, kept up to date while readings enter and leave: O(M N) per change, bound by memory traffic.

With k = G h and t = G z for a change C ← C − η h hᵀ, the diagonals of G C Gᵀ and of G C W C Gᵀ follow as
gᵀCg − η k² and gᵀCWCg − 2 η k t + η² ω k². The same holds for the columns G C g_l and G C W C g_l of the readings in
the plan, which make taking one of them out, and looking at what would replace it best, cost O(M).

A reading of several numbers enters and leaves number by number; its gain, and what leaving changes, are those of all.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from axiscal.design.gains.candidate_rows import Pool
from axiscal.design.gains.covariance import Covariance, RankOne
from axiscal.design.gains.three_values import SharedReadings
from axiscal.measurement.place import Places
from axiscal.numerics import Array

_NEAR = 32768
"""Numbers that stay in the cache while a product is taken off: of speed, not of the result."""


@dataclass(frozen=True, eq=False, slots=True)
class Member:
    """A reading in the plan.  rows : (k, n) over the unknowns when it entered; variance : of its noise."""

    rows: Array
    variance: float


class _Left(NamedTuple):
    """What a reading leaves that is not taken.

    above, below, joint : as of `Scores`; grown, omega : E and Ω of its numbers, (k, k)
    cross, reach : (k, numbers) G C Hᵀ and G C W C Hᵀ with its rows H
    """

    above: Array
    below: Array
    joint: SharedReadings
    grown: Array
    omega: Array
    cross: Array
    reach: Array


class Scores:
    """The gains of the candidates of a pool while a plan is made.

    above, below : (numbers,) numerator and denominator for those of the candidates, then of the readings of the plan
    joint : what the numbers of one candidate have in common
    places : of the readings of the plan, slot by slot; members : what else is known of each
    last : the last changes of the covariance; begun : what was known before the first reading of the plan
    """

    last: tuple[RankOne, ...]

    def __init__(self, pool: Pool, state: Covariance) -> None:
        self.pool, self.state, self.begun = pool, state, state
        self.members, self.places = list[Member](), Places.none(pool.lattice.poses.shape[1])
        self.above, self.below, self.joint = pool.forms(state.scorer())
        self._cross: Array | None = None
        self._reach: Array | None = None
        self._rows: Array | None = None

    def follow(self) -> tuple[Array, Array]:
        """Keep the columns of the readings of the plan from now on, so that they can be looked at one by one."""
        if self._cross is None or self._reach is None:
            size = self.state.observation.size
            rows = np.array([row for m in self.members for row in self._padded(m)]).reshape(-1, size)
            half = rows @ self.state.factor
            weighted = self.state.weighted
            self._cross = self._products(self.state.factor @ half.T)
            self._reach = self._products(self.state.factor @ (weighted.T @ (weighted @ half.T)))
        return self._cross, self._reach

    def fork(self) -> Self:
        """Return a copy that goes its own way."""
        other = copy.copy(self)
        other.members = list(self.members)
        other.above, other.below, other.joint = self.above.copy(), self.below.copy(), self.joint.copy()
        other._cross = None if self._cross is None else self._cross.copy()
        other._reach = None if self._reach is None else self._reach.copy()
        return other

    @property
    def gains(self) -> Array:
        """The gain of every candidate, (M,)."""
        return self.pool.gains(self.above, self.below, self.joint)

    def enter(self, what: int | Places, slot: int | None = None, bundle: int = 1) -> float:
        """Take a candidate, or a reading at another single place, into the plan, and return by how much J falls.

        slot : position in the plan of a reading that has left; the end if none is given
        bundle : how often it is read
        """
        place = what if isinstance(what, Places) else self.pool.lattice.at(what)
        self.state = self.state.opened(place)
        rows, variance = self._looked_at(what)
        variance /= bundle
        slot = len(self.members) if slot is None else slot
        self._place(slot, place, Member(rows, variance))
        self.last = tuple(self._entered(self._numbers(slot).start + i, row, variance) for i, row in enumerate(rows))
        return sum(change.gain for change in self.last)

    def _entered(self, here: int, row: Array, variance: float) -> RankOne:
        """Take one number in.  here : its index"""
        change, count = self.state.change(row, variance), self.pool.count
        cross, reach = self._products(np.column_stack([change.h, change.z])).T
        self.above[here], self.below[here] = change.omega, variance + cross[here]
        if self._cross is not None and self._reach is not None:
            self._cross[:, here - count], self._reach[:, here - count] = cross, reach
            self._cross[here], self._reach[here] = cross[count:], reach[count:]
        self._changed(here, change, cross.copy(), reach.copy())
        self.state = self.state.after(row, variance, change)
        return change

    def leave(self, slot: int) -> float:
        """Take a reading out of the plan; its slot stays open. Return by how much J rises."""
        member, numbers = self.members[slot], self._numbers(slot)
        rows = self._padded(member)
        pairs = list(zip(range(numbers.start, numbers.stop), rows, strict=True))
        self.last = tuple(self._left(here, row, member.variance) for here, row in reversed(pairs))
        return -sum(change.gain for change in self.last)

    def _left(self, here: int, row: Array, variance: float) -> RankOne:
        change = self.state.change(row, variance, leaving=True)
        cross, reach = self._columns(here)
        self._changed(here, change._replace(omega=float(self.above[here])), cross, reach)
        self.state = self.state.after(row, variance, change)
        return change

    def close(self, slot: int) -> None:
        """Forget the slot of a reading that has left."""
        self._rows = None
        self._cut(self._numbers(slot))
        del self.members[slot]
        self.places = self.places.without(slot)

    def without(self, slot: int) -> tuple[Array, float]:
        """Return the gains (M,) of the candidates were a reading not taken, and that of the reading itself."""
        left = self._had_left(slot)
        return self.pool.gains(left.above, left.below, left.joint), float(np.sum(left.grown * left.omega))

    def _had_left(self, slot: int) -> _Left:
        """Return numerators and denominators of all numbers were a reading not taken."""
        numbers = self._numbers(slot)
        grown, omega = self._leaving(slot)
        columns = [self._columns(here) for here in range(numbers.start, numbers.stop)]
        cross, reach = [c for c, _ in columns], [r for _, r in columns]
        lifted = [sum(grown[i, j] * cross[j] for j in range(len(cross))) for i in range(len(cross))]
        turned = [2 * reach[i] + sum(omega[i, j] * lifted[j] for j in range(len(cross))) for i in range(len(cross))]
        above, below, joint = self.above.copy(), self.below.copy(), self.joint
        for near, far, column in zip(lifted, turned, cross, strict=True):
            above += near * far
            below += near * column
        if not self.pool.scalar:
            joint = self._joint_without(cross, lifted, turned)
        return _Left(above, below, joint, grown, omega, np.array(cross), np.array(reach))

    def _joint_without(self, cross: list[Array], lifted: list[Array], turned: list[Array]) -> SharedReadings:
        joint = self.joint.copy()
        for near, far, column in zip(lifted, turned, cross, strict=True):
            (near_a, near_b), (far_a, far_b) = joint.ends(near), joint.ends(far)
            joint.above += (near_a * far_b + far_a * near_b) / 2
            joint.below += near_a * joint.ends(column)[1]
        return joint

    def losses(self) -> Array:
        """Return by how much J would rise were each reading of the plan not taken, (m,)."""
        return np.array([float(np.sum(np.multiply(*self._leaving(s)))) for s in range(len(self.members))])

    def _leaving(self, slot: int) -> tuple[Array, Array]:
        """Return E and Ω of a reading: without it C ← C + H E Hᵀ, and J rises by tr(E Ω); each (k, k).

        E = (R − G C Gᵀ)⁻¹, Ω = G C W C Gᵀ with its rows G.
        """
        numbers, noise = self._numbers(slot), self.members[slot].variance
        here = numbers.start
        if numbers.stop - here == 1:
            spread, omega = float(self.below[here]) - noise, float(self.above[here])
            return np.array([[1.0 / max(noise - spread, 1e-9 * noise)]]), np.array([[omega]])
        crossed, reached = self.follow()
        own = slice(here - self.pool.count, numbers.stop - self.pool.count)
        values, vectors = np.linalg.eigh(noise * np.eye(own.stop - own.start) - crossed[numbers, own])
        grown: Array = vectors / np.maximum(values, 1e-9 * noise) @ vectors.T
        return grown, reached[numbers, own]

    def _columns(self, here: int) -> tuple[Array, Array]:
        """Return rows times C g and times C W C g of a reading of the plan, each (numbers,).  here : its index

        From tables, 40 m k bytes to bring up to date at every change, or made anew, 8 m n bytes, where rows are short.
        """
        column = here - self.pool.count
        if self._cross is None and self.pool.scalar and self.state.observation.size <= len(self.members):
            change = self.state.change(self._padded(self.members[column])[0], 1.0)
            cross, reach = self._products(np.column_stack([change.h, change.z])).T
            return cross.copy(), reach.copy()
        crossed, reached = self.follow()
        return crossed[:, column].copy(), reached[:, column].copy()

    def _looked_at(self, what: int | Places) -> tuple[Array, float]:
        """Return the rows (k, n) of a reading whose cells have columns, and the variance of its noise."""
        if isinstance(what, Places):
            rows, variances, _ = self.state.rows(what)
            return rows, float(variances[0])
        return self.pool.rows(self.state.observation, what), float(self.pool.noise[what])

    def _numbers(self, slot: int) -> slice:
        """Return where the numbers of a reading of the plan stand."""
        if self.pool.scalar:
            return slice(self.pool.count + slot, self.pool.count + slot + 1)
        start = self.pool.count + sum(len(member.rows) for member in self.members[:slot])
        return slice(start, start + len(self.members[slot].rows))

    def _place(self, slot: int, place: Places, member: Member) -> None:
        """Put a reading into a slot, with room for as many numbers as it has."""
        self._rows = None
        if slot == len(self.members):
            self.members.append(member)
            self.places = Places.joined([self.places, place])
            self._room(self._numbers(slot))
            return
        same = len(self.members[slot].rows) == len(member.rows)
        if not same:
            self._cut(self._numbers(slot))
        self.members[slot], self.places = member, self.places.exchanged(slot, place)
        if not same:
            self._room(self._numbers(slot))

    def _room(self, numbers: slice) -> None:
        at = np.full(numbers.stop - numbers.start, numbers.start)
        self.above, self.below = np.insert(self.above, at, 0.0), np.insert(self.below, at, 1.0)
        if self._cross is not None and self._reach is not None:
            self._cross, self._reach = (
                np.insert(np.insert(table, at - self.pool.count, 0.0, axis=1), at, 0.0, axis=0)
                for table in (self._cross, self._reach)
            )

    def _cut(self, numbers: slice) -> None:
        at = np.arange(numbers.start, numbers.stop)
        self.above, self.below = np.delete(self.above, at), np.delete(self.below, at)
        if self._cross is not None and self._reach is not None:
            self._cross, self._reach = (
                np.delete(np.delete(table, at - self.pool.count, axis=1), at, axis=0)
                for table in (self._cross, self._reach)
            )

    def _products(self, vectors: Array) -> Array:
        if self._rows is None:
            self._rows = np.concatenate([np.zeros((0, self.state.observation.size)), *map(self._padded, self.members)])
        mine = self._rows @ vectors[: self._rows.shape[1]]
        return np.concatenate([self.pool.products(self.state.observation, vectors), mine])

    def _padded(self, member: Member) -> Array:
        """The rows with zeros for cells that were opened later: no earlier reading lies in them."""
        rows = np.zeros((len(member.rows), self.state.observation.size))
        rows[:, : member.rows.shape[1]] = member.rows
        return rows

    def _changed(self, here: int, change: RankOne, cross: Array, reach: Array) -> None:
        """Bring everything up to date after C ← C − η h hᵀ, by the number whose index is `here`.

        cross : rows times h = C g; reach : times z = C W h
        """
        eta, omega = change.eta, change.omega
        self.above += -2 * eta * cross * reach + eta**2 * omega * cross**2
        self.below -= eta * cross**2
        if not self.pool.scalar:
            (cross_a, cross_b), (reach_a, reach_b) = self.joint.ends(cross), self.joint.ends(reach)
            both = cross_a * cross_b
            self.joint.above += -eta * (cross_a * reach_b + reach_a * cross_b) + eta**2 * omega * both
            self.joint.below -= eta * both
        if self._cross is not None and self._reach is not None:
            near, far = cross[self.pool.count :], reach[self.pool.count :]
            _take_off(self._reach, eta * np.column_stack([cross, reach]), np.stack([far - eta * omega * near, near]))
            _take_off(self._cross, eta * cross[:, None], near[None])


def _take_off(table: Array, left: Array, right: Array) -> None:
    """Subtract a product of low rank in place, (m, k) −= (m, j) (j, k): 2 m k j operations, 16 m k bytes.

    A few rows at a time, so that the product is taken off while it is near.
    """
    height = max(1, _NEAR // max(table.shape[1], 1))
    for start in range(0, len(table), height):
        table[start : start + height] -= left[start : start + height] @ right
