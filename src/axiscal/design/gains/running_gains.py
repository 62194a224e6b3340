"""Gains of a whole lattice, kept up to date while readings enter and leave: O(M N) per change, bound by memory traffic.

With K = G H and T = G Z for a change C ← C − H η Hᵀ, S = K η and U = T − S Ω/2, the diagonals of G C Gᵀ and of
G C W C Gᵀ follow as gᵀCg − s·k and gᵀCWCg − 2 s·u. The same holds for the columns G C g_l and G C W C g_l of the
readings in the plan, which make taking one of them out, and looking at what would replace it best, cost O(M).

A reading enters and leaves with all its numbers at once, and so do many readings.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from axiscal.design.gains.candidate_rows import Pool
from axiscal.design.gains.covariance import Covariance, LowRank
from axiscal.design.gains.gain import Scorer
from axiscal.design.gains.leaving import Leaving, LeftOver
from axiscal.design.gains.reading_columns import ReadingColumns
from axiscal.design.gains.three_values import SharedReadings
from axiscal.measurement.place import Places
from axiscal.numerics import Array
from axiscal.numerics.ties import ALIKE, first_best, first_best_each

_SMALLEST = 1e-9
"""Share of the noise of a reading that counts as left of it where nothing is: no division by nought."""
_ALONE = 1e-7
"""Share of the noise of a reading: where its own variance is nearer to the noise, it alone holds an unknown."""


@dataclass(frozen=True, eq=False, slots=True)
class Member:
    """A reading in the plan.  rows : (k, n) over the unknowns when it entered; variance : of its noise."""

    rows: Array
    variance: float


class Replacement(NamedTuple):
    """The best candidate for a slot, what it gains, and what the reading gains that holds the slot."""

    candidate: int
    gain: float
    own: float


Allowed = Callable[["Scores", int], NDArray[np.bool_]]
"""(scores, slot) -> which candidates (M,) may stand in that slot."""


class Scores:
    """The gains of the candidates of a pool while a plan is made.

    above, below : (numbers,) numerator and denominator for those of the candidates, then of the readings of the plan
    joint : what the numbers of one candidate have in common
    places : of the readings of the plan, slot by slot; members : what else is known of each
    last : the last change of the covariance; begun : what was known before the first reading of the plan
    """

    last: LowRank

    def __init__(self, pool: Pool, state: Covariance) -> None:
        self.pool, self.state, self.begun = pool, state, state
        self.members, self.places = list[Member](), Places.none(pool.lattice.poses.shape[1])
        self.above, self.below, self.joint = pool.forms(state.scorer())
        self._followed: ReadingColumns | None = None
        self._rows: Array | None = None
        self._starts: list[int] | None = None
        self._noise: Array | None = None
        self._leavings: dict[int, Leaving] = {}
        self._bare: tuple[Covariance, Scorer] | None = None

    def follow(self) -> ReadingColumns:
        """Keep the columns of the readings of the plan from now on, so that they can be looked at one by one."""
        if self._followed is None:
            size = self.state.observation.size
            rows = np.array([row for m in self.members for row in self._padded(m)]).reshape(-1, size)
            half = rows @ self.state.factor
            weighted = self.state.weighted
            cross = self._products(self.state.factor @ half.T)
            reach = self._products(self.state.factor @ (weighted.T @ (weighted @ half.T)))
            self._followed = ReadingColumns(cross, reach, self.pool.count)
        return self._followed

    def fork(self) -> Self:
        """Return a copy that goes its own way."""
        other = copy.copy(self)
        other.members = list(self.members)
        other.above, other.below, other.joint = self.above.copy(), self.below.copy(), self.joint.copy()
        other._followed = None if self._followed is None else self._followed.copy()
        other._rows, other._noise, other._leavings = None, None, {}  # written in place
        return other

    @property
    def objective(self) -> float:
        """What the readings of the plan leave of what is to be small, m²."""
        return self.state.value

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
        if isinstance(what, Places):
            self.state = self.state.opened(place)
        else:
            self.state = self.state.opened_to(self.pool.opened(self.state.observation, what))
        rows, variance = self._looked_at(what)
        slot = len(self.members) if slot is None else slot
        self._place(slot, place, Member(rows, variance / bundle))
        return self._taken(place, rows, self._numbers(slot), variance / bundle)

    def enter_all(self, places: Places) -> float:
        """Take readings into the plan together, after those that it has, and return by how much J falls."""
        if not len(places):
            return 0.0
        self.state = self.state.opened(places)
        rows, variances, owner = self.state.rows(places)
        start = self.pool.count + sum(len(member.rows) for member in self.members)
        for index in range(len(places)):
            mine = np.flatnonzero(owner == index)
            self.members.append(Member(rows[mine], float(variances[mine[0]])))
        self._rows, self._starts, self._noise = None, None, None
        self.places = Places.joined([self.places, places])
        here = slice(start, start + len(rows))
        self._room(here)
        return self._taken(places, rows, here, self._noises[here.start - self.pool.count :])

    @property
    def _noises(self) -> Array:
        """The variance of the noise of every number of the plan."""
        if self._noise is None:
            counts = [len(member.rows) for member in self.members]
            self._noise = np.repeat([member.variance for member in self.members], counts)
        return self._noise

    def _taken(self, places: Places, rows: Array, here: slice, variances: float | Array) -> float:
        """Take numbers in.  rows : (k, n); here : where they stand; variances : of their noise"""
        noise = np.broadcast_to(variances, len(rows))
        state, change = self.state.changed(rows, noise)
        seen, count = self._products(np.hstack([change.h, change.z])), self.pool.count
        cross, reach = seen[:, : len(rows)], seen[:, len(rows) :]
        back = change.back.T
        self.above[here] = np.diagonal(back.T @ change.omega @ back)
        self.below[here] = noise + np.einsum("ij,ji->i", cross[here], back)
        if self._followed is not None:
            self._followed.put(slice(here.start - count, here.stop - count), cross @ back, reach @ back)
        self._changed(here, change, cross, reach)
        self.state, self.last = state, change
        return change.gain

    def leave(self, slot: int) -> float:
        """Take a reading out of the plan; its slot stays open. Return by how much J rises."""
        numbers, (state, change) = self._numbers(slot), self.known_without(slot)
        if self._short:
            cross, reach = np.hsplit(self._products(np.hstack([change.h, change.z])), 2)
        else:
            cross, reach = (column @ change.turn.T for column in self._columns(slot))
        here = change.turn @ reach[numbers]
        change = change._replace(omega=(here + here.T) / 2)
        self._changed(numbers, change, cross, reach)
        self.state, self.last = state, change
        return -change.gain

    def known_without(self, slot: int) -> tuple[Covariance, LowRank]:
        """Return the state without a reading of the plan, and what that would change."""
        member = self.members[slot]
        rows = self._padded(member)
        return self.state.changed(rows, np.full(len(rows), member.variance), leaving=True)

    def scorer(self) -> Scorer:
        """Return the gains as if no cell had been visited, which are found once until a reading moves."""
        if self._bare is None or self._bare[0] is not self.state:
            self._bare = self.state, self.pool.scorer(self.state)
        return self._bare[1]

    def scorer_without(self, change: LowRank) -> Scorer:
        """Return the same without a reading.  change : what its leaving would change"""
        columns = change.h[: self.pool.size] * np.sqrt(-np.diagonal(change.eta))
        return self.scorer().widened(columns, self.state.root.of(columns))

    def close(self, slot: int) -> None:
        """Forget the slot of a reading that has left."""
        self._cut(self._numbers(slot))
        self._rows, self._starts, self._noise, self._leavings = None, None, None, {}
        del self.members[slot]
        self.places = self.places.without(slot)

    def without(self, slot: int) -> tuple[Array, float]:
        """Return the gains (M,) of the candidates were a reading not taken, and that of the reading itself."""
        left = self._had_left(slot)
        return self.pool.gains(left.above, left.below, left.joint), -float(np.sum(left.eta * left.omega))

    def replacement(self, slot: int, allowed: NDArray[np.bool_], better: float | None = None) -> Replacement:
        """Return the best of the candidates that are allowed (M,) for the slot of a reading.

        better : those that do not bring by this share more than the reading do not matter
        """
        gains, own = self.without(slot)
        gains = np.where(allowed, gains, -np.inf)
        best = first_best(gains, ALIKE)
        return Replacement(best, float(gains[best]), own)

    def replacements(self, slots: Sequence[int], allowed: Allowed, better: float) -> Iterator[Replacement]:
        """Yield the same for several slots, where rows are short from one product of all of them.

        allowed : (scores, slot) -> which candidates (M,) may stand in that slot
        """
        if self._short and slots:
            yield from self._from_short_rows(slots, np.array([allowed(self, slot) for slot in slots]))
        else:
            yield from (self.replacement(slot, allowed(self, slot), better) for slot in slots)

    @property
    def _short(self) -> bool:
        """Whether columns are made anew from rows of one number, 8 m n bytes, in place of tables of all of them."""
        return self._followed is None and self.pool.scalar and self.state.observation.size <= len(self.members)

    def _from_short_rows(self, slots: Sequence[int], allowed: NDArray[np.bool_]) -> Iterator[Replacement]:
        """Yield the replacements of several slots, each as if it alone was left.  allowed : (slots, M)"""
        here, count = np.array(slots, dtype=np.intp), self.pool.count
        noise, omega = self._noises[here], self.above[count + here]
        grown = 1.0 / np.maximum(2 * noise - self.below[count + here], _SMALLEST * noise)
        h = self.state.factor @ (self._stacked()[here] @ self.state.factor).T
        seen = self.pool.products(self.state.observation, np.hstack([h, self.state.weighed(h)[0]])).T
        cross, half = seen[: len(here)], seen[len(here) :]
        scaled = cross * -grown[:, None]
        half -= scaled * (omega / 2)[:, None]
        gains = self.above[:count] - 2 * scaled * half
        gains /= self.below[:count] - scaled * cross
        gains[~allowed] = -np.inf
        best = first_best_each(gains, ALIKE)
        for candidate, gain, own in zip(best.tolist(), gains[np.arange(len(best)), best], grown * omega, strict=True):
            yield Replacement(candidate, float(gain), float(own))

    def _had_left(self, slot: int) -> LeftOver:
        """Return numerators and denominators of all numbers were a reading not taken."""
        grown, omega = self._leaving(slot)
        cross, reach = self._columns(slot)
        above, below, joint = self._after(-grown, omega, cross, reach)
        return LeftOver(above, below, joint, -grown, omega, cross, reach)

    def _after(self, eta: Array, omega: Array, cross: Array, reach: Array) -> tuple[Array, Array, SharedReadings]:
        """Return numerators, denominators and what they have in common after C ← C − H η Hᵀ; as of `_changed`."""
        scaled = cross @ eta
        half = reach - scaled @ (omega / 2)
        above = self.above - 2 * np.einsum("ik,ik->i", scaled, half)
        below = self.below - np.einsum("ik,ik->i", scaled, cross)
        return above, below, self.joint if self.pool.scalar else self.joint.after(scaled, half, cross)

    def losses(self) -> Array:
        """Return by how much J would rise were each reading of the plan not taken, (m,)."""
        if not self.pool.scalar:
            return np.array([float(np.sum(np.multiply(*self._leaving(s)))) for s in range(len(self.members))])
        noise, mine = self._noises, slice(self.pool.count, None)
        return np.asarray(self.above[mine] / np.maximum(2 * noise - self.below[mine], _SMALLEST * noise))

    def held_alone(self, slot: int) -> bool:
        """Whether unknowns would open beyond the digits of a double without a reading of several numbers.

        Tables from which it is taken hold nothing of the rest; such a reading keeps its place.
        """
        numbers = self._numbers(slot)
        several = numbers.stop - numbers.start > 1
        return several and self._left_by(slot).least < _ALONE * self.members[slot].variance

    def _leaving(self, slot: int) -> tuple[Array, Array]:
        """Return E and Ω of a reading: without it C ← C + H E Hᵀ, and J rises by tr(E Ω); each (k, k)."""
        left = self._left_by(slot)
        return left.grown, left.omega

    def _left_by(self, slot: int) -> Leaving:
        """Return the same and its least eigenvalue, kept until something enters or leaves."""
        if slot not in self._leavings:
            self._leavings[slot] = self._found_leaving(slot)
        return self._leavings[slot]

    def _found_leaving(self, slot: int) -> Leaving:
        """Return E = (R − G C Gᵀ)⁻¹ and Ω = G C W C Gᵀ of a reading with its rows G."""
        numbers, noise = self._numbers(slot), self.members[slot].variance
        here = numbers.start
        if numbers.stop - here == 1:
            spread, omega = float(self.below[here]) - noise, float(self.above[here])
            left = max(noise - spread, _SMALLEST * noise)
            return Leaving(np.array([[1.0 / left]]), np.array([[omega]]), left)
        own = slice(here - self.pool.count, numbers.stop - self.pool.count)
        crossed, reached = self.follow().of(own, numbers)
        values, vectors = np.linalg.eigh(noise * np.eye(own.stop - own.start) - crossed)
        grown: Array = vectors / np.maximum(values, _SMALLEST * noise) @ vectors.T
        return Leaving(grown, reached, float(values[0]))

    def _columns(self, slot: int) -> tuple[Array, Array]:
        """Return rows times C Gᵀ and times C W C Gᵀ of a reading of the plan, each (numbers, k).

        From tables, 40 m k bytes to bring up to date at every change, or made anew, 8 m n bytes, where rows are short.
        """
        numbers = self._numbers(slot)
        if self._short:
            h = self.state.factor @ (self._padded(self.members[slot]) @ self.state.factor).T
            seen = self._products(np.hstack([h, self.state.weighed(h)[0]]))
            return seen[:, :1], seen[:, 1:]
        return self.follow().of(slice(numbers.start - self.pool.count, numbers.stop - self.pool.count))

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
        if self._starts is None:
            counts = [len(member.rows) for member in self.members]
            self._starts = list(accumulate(counts, initial=self.pool.count))
        return slice(self._starts[slot], self._starts[slot + 1])

    def _place(self, slot: int, place: Places, member: Member) -> None:
        """Put a reading into a slot, with room for as many numbers as it has."""
        if slot == len(self.members):
            self.members.append(member)
            self._noise, self._starts, self.places = None, None, Places.joined([self.places, place])
            self._room(self._numbers(slot))
            if self._rows is not None:
                self._rows = np.concatenate([self._stacked(), self._padded(member)])
            return
        same = len(self.members[slot].rows) == len(member.rows)
        if not same:
            self._cut(self._numbers(slot))
        self.members[slot], self.places = member, self.places.exchanged(slot, place)
        if not same:
            self._rows, self._noise, self._starts = None, None, None
            self._room(self._numbers(slot))
            return
        numbers = self._numbers(slot)
        here = slice(numbers.start - self.pool.count, numbers.stop - self.pool.count)
        self._noises[here] = member.variance
        if self._rows is not None:
            self._stacked()[here] = self._padded(member)

    def _room(self, numbers: slice) -> None:
        at = np.full(numbers.stop - numbers.start, numbers.start)
        self.above, self.below = np.insert(self.above, at, 0.0), np.insert(self.below, at, 1.0)
        if self._followed is not None:
            self._followed.room(numbers.start - self.pool.count, len(at))

    def _cut(self, numbers: slice) -> None:
        at = np.arange(numbers.start, numbers.stop)
        self.above, self.below = np.delete(self.above, at), np.delete(self.below, at)
        if self._followed is not None:
            self._followed.cut(slice(numbers.start - self.pool.count, numbers.stop - self.pool.count))

    def _products(self, vectors: Array) -> Array:
        mine = self._stacked() @ vectors
        return np.concatenate([self.pool.products(self.state.observation, vectors), mine])

    def _stacked(self) -> Array:
        """The rows of all numbers of the plan, kept while readings change one by one."""
        size = self.state.observation.size
        if self._rows is None:
            self._rows = np.concatenate([np.zeros((0, size)), *map(self._padded, self.members)])
        elif self._rows.shape[1] < size:
            self._rows = np.pad(self._rows, ((0, 0), (0, size - self._rows.shape[1])))
        return self._rows

    def _padded(self, member: Member) -> Array:
        """The rows with zeros for cells that were opened later: no earlier reading lies in them."""
        rows = np.zeros((len(member.rows), self.state.observation.size))
        rows[:, : member.rows.shape[1]] = member.rows
        return rows

    def _changed(self, here: slice, change: LowRank, cross: Array, reach: Array) -> None:
        """Bring everything up to date after C ← C − H η Hᵀ, by the numbers that stand `here`.

        cross : rows times H = C Gᵀ, (numbers, k); reach : times Z = C W H
        """
        self.above, self.below, self.joint = self._after(change.eta, change.omega, cross, reach)
        self._leavings = {}
        if self._followed is not None:
            scaled = cross @ change.eta
            self._followed.change(scaled, reach - scaled @ (change.omega / 2), cross)
