"""Gains of a whole lattice, kept up to date while readings enter and leave: O(M N) per change, bound by memory traffic.

With k = G h and t = G z for a change C ← C − η h hᵀ, the diagonals of G C Gᵀ and of G C W C Gᵀ follow as
gᵀCg − η k² and gᵀCWCg − 2 η k t + η² ω k². The same holds for the columns G C g_l and G C W C g_l of the readings in
the plan, which make taking one of them out, and looking at what would replace it best, cost O(M).
"""

from __future__ import annotations

import copy
from dataclasses import dataclass

import numpy as np

from axiscal.design.pool import Pool
from axiscal.design.state import Change, Point, State
from axiscal.numerics import Array


@dataclass(frozen=True, eq=False, slots=True)
class Member:
    """A reading in the plan.  row : (n,) over the unknowns when it entered; variance : of its noise."""

    point: Point
    row: Array
    variance: float


class Scores:
    """The gains of the candidates of a pool while a plan is made.

    above, below : (M + m,) numerator and denominator for the candidates, then for the readings of the plan
    last : the last change of the covariance
    """

    last: Change

    def __init__(self, pool: Pool, state: State) -> None:
        self.pool, self.state = pool, state
        self.members: list[Member] = []
        self.above, self.below = pool.forms(state.scorer())
        self._cross: Array | None = None
        self._reach: Array | None = None

    def follow(self) -> None:
        """Keep the columns of the readings of the plan from now on, so that they can be looked at one by one."""
        if self._cross is None:
            rows = np.array([self._padded(member) for member in self.members]).reshape(len(self.members), -1)
            half = rows @ self.state.factor if len(rows) else np.zeros((0, self.state.factor.shape[1]))
            weighted = self.state.weight @ self.state.factor[: self.state.weight.shape[1]]
            self._cross = self._products(self.state.factor @ half.T)
            self._reach = self._products(self.state.factor @ (weighted.T @ (weighted @ half.T)))

    def fork(self) -> Scores:
        """Return a copy that goes its own way."""
        other = copy.copy(self)
        other.members = list(self.members)
        other.above, other.below = self.above.copy(), self.below.copy()
        other._cross = None if self._cross is None else self._cross.copy()
        other._reach = None if self._reach is None else self._reach.copy()
        return other

    @property
    def gains(self) -> Array:
        """The gain of every candidate, (M,)."""
        count = len(self.pool)
        gains: Array = self.above[:count] / self.below[:count]
        return gains

    @property
    def points(self) -> list[Point]:
        """The readings of the plan."""
        return [member.point for member in self.members]

    def enter(self, what: int | Point, slot: int | None = None, bundle: int = 1) -> float:
        """Take a candidate, or another reading, into the plan, and return by how much J falls.

        slot : position in the plan of a reading that has left; the end if none is given
        bundle : how often it is read
        """
        row, variance, point = self._looked_at(what)
        variance /= bundle
        change = self.state.change(row, variance)
        self._place(slot, Member(point, row, variance))
        slot = len(self.members) - 1 if slot is None else slot
        cross, reach = self._products(np.column_stack([change.h, change.z])).T
        here = len(self.pool) + slot
        self.above[here], self.below[here] = change.omega, variance + cross[here]
        if self._cross is not None and self._reach is not None:
            self._cross[:, slot], self._reach[:, slot] = cross, reach
            self._cross[here], self._reach[here] = cross[len(self.pool) :], reach[len(self.pool) :]
        self._changed(cross.copy(), reach.copy(), change.eta, change.omega)
        self.state, self.last = self.state.after(row, variance, change), change
        return change.gain

    def leave(self, slot: int) -> float:
        """Take a reading out of the plan; its slot stays open. Return by how much J rises."""
        member, here = self.members[slot], len(self.pool) + slot
        change = self.state.change(self._padded(member), member.variance, leaving=True)
        cross, reach = self._columns(slot)
        self._changed(cross, reach, change.eta, float(self.above[here]))
        self.state, self.last = self.state.after(member.row, member.variance, change), change
        return -change.gain

    def close(self, slot: int) -> None:
        """Forget the slot of a reading that has left."""
        here = len(self.pool) + slot
        del self.members[slot]
        self.above, self.below = np.delete(self.above, here), np.delete(self.below, here)
        if self._cross is not None and self._reach is not None:
            self._cross = np.delete(np.delete(self._cross, slot, axis=1), here, axis=0)
            self._reach = np.delete(np.delete(self._reach, slot, axis=1), here, axis=0)

    def without(self, slot: int) -> tuple[Array, float]:
        """Return the gains (M,) of the candidates were a reading not taken, and that of the reading itself."""
        here, count = len(self.pool) + slot, len(self.pool)
        eta, omega = self._eta_leaving(slot), self.above[here]
        cross, reach = self._columns(slot)
        above = self.above - 2 * eta * cross * reach + eta**2 * omega * cross**2
        below = self.below - eta * cross**2
        gains: Array = above / below
        return gains[:count], float(gains[here])

    def losses(self) -> Array:
        """Return by how much J would rise were each reading of the plan not taken, (m,)."""
        count = len(self.pool)
        return np.array([-self._eta_leaving(s) * self.above[count + s] for s in range(len(self.members))])

    def _eta_leaving(self, slot: int) -> float:
        noise = self.members[slot].variance
        spread = float(self.below[len(self.pool) + slot]) - noise
        return -1.0 / max(noise - spread, 1e-9 * noise)

    def _columns(self, slot: int) -> tuple[Array, Array]:
        self.follow()
        if self._cross is None or self._reach is None:
            raise AssertionError("the columns are kept from here on")
        return self._cross[:, slot].copy(), self._reach[:, slot].copy()

    def _looked_at(self, what: int | Point) -> tuple[Array, float, Point]:
        point = what if isinstance(what, Point) else self.pool.point(what)
        self.state = self.state.opened([point])
        if isinstance(what, Point):
            return *self.state.row(point), point
        return self.pool.row(self.state.observation, what), float(self.pool.noise[what]), point

    def _place(self, slot: int | None, member: Member) -> None:
        if slot is not None:
            self.members[slot] = member
            return
        self.members.append(member)
        self.above, self.below = np.append(self.above, 0.0), np.append(self.below, 1.0)
        if self._cross is not None and self._reach is not None:
            self._cross = np.pad(self._cross, ((0, 1), (0, 1)))
            self._reach = np.pad(self._reach, ((0, 1), (0, 1)))

    def _products(self, vectors: Array) -> Array:
        mine = [member.row @ vectors[: len(member.row)] for member in self.members]
        table = np.array(mine).reshape(len(mine), vectors.shape[1])
        return np.concatenate([self.pool.products(self.state.observation, vectors), table])

    def _padded(self, member: Member) -> Array:
        """The row with zeros for cells that were opened later: no earlier reading lies in them."""
        row = np.zeros(self.state.observation.size)
        row[: len(member.row)] = member.row
        return row

    def _changed(self, cross: Array, reach: Array, eta: float, omega: float) -> None:
        """Bring everything up to date after C ← C − η h hᵀ.  cross : rows times h = C g; reach : times z = C W h."""
        self.above += -2 * eta * cross * reach + eta**2 * omega * cross**2
        self.below -= eta * cross**2
        if self._cross is not None and self._reach is not None:
            here, there = cross[len(self.pool) :], reach[len(self.pool) :]
            self._reach -= np.outer(eta * cross, there - eta * omega * here) + np.outer(eta * reach, here)
            self._cross -= np.outer(eta * cross, here)
