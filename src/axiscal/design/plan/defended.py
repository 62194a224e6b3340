"""The gains of a lattice when a plan is to minimise what its readings can vouch for, not its promise alone.

Beside what `Scores` keeps, each departure column b has β = b − gᵀx and π = eᵀ V C g of every candidate, the information
I = bᵀK⁻¹b and the error e = V φ − V x, x what the estimate makes of b. A reading with v = σ² + gᵀCg and N = |V C g|²
that enters makes of them

    I + β βᵀ/v,   |e|² − 2βπ/v + β²N/v²,   β_c − (g_cᵀ C g) β/v,   e − V C g β/v

and a reading that leaves the same with v = gᵀCg − σ². Of a reading of several numbers v is the matrix R + G C Gᵀ.

The best candidate is found from below: the promise with the few departures that do most is less than the objective, and
only candidates that this does not rule out are looked at in full.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from axiscal.accuracy.yardstick import Yardstick
from axiscal.design.gains.candidate_rows import Pool
from axiscal.design.gains.covariance import Covariance, LowRank
from axiscal.design.gains.running_gains import Allowed, Replacement, Scores
from axiscal.design.gains.three_values import SharedReadings
from axiscal.design.plan.objective import Objective, Standing
from axiscal.design.plan.watch import Watch
from axiscal.measurement.place import Places
from axiscal.numerics import Array
from axiscal.numerics.low_rank import take_off
from axiscal.numerics.ties import ALIKE, first_best

_HEAVIEST = (2, 16)
"""Departures by which candidates are ruled out, two, then more: of time. Of a demo's 3,011 they leave 45, then 11."""
_AT_ONCE = 16
"""Candidates that are looked at in full together: of time."""
_ROUNDING = 1e-10
"""Share of the objective by which a floor may be above it."""
_NEAR = 16384
"""Entries of a table that stay in the cache: of speed, not of the result."""


class _Looked(NamedTuple):
    """What candidates are looked at with, perhaps without a reading.

    standing : before a candidate; above, below, joint : as of `Scores`
    cross, reach : (numbers, r) as of `LeftOver`; pulled, turned : (r, k)
    β is `beta` with cross times pulled added, π is `pi` with cross times turned and reach times pulled
    slot : where a candidate would stand
    """

    standing: Standing
    above: Array
    below: Array
    joint: SharedReadings
    cross: Array
    reach: Array
    pulled: Array
    turned: Array
    slot: int


class _Counted(NamedTuple):
    """The departures that count, all or some.  standing : of these; columns : theirs, None for all"""

    goal: Objective
    standing: Standing
    columns: NDArray[np.intp] | None


class DefendedScores(Scores):
    """Scores whose gains are those of the objective.

    beta, pi : (numbers, k) of the candidates, then of the readings of the plan; x : (n, k); left : (w, k) e
    The first `doubted` columns are not those of a place but of a slot, for whatever reading stands there; none closes.
    squarings : p of the objective is two to this power
    """

    def __init__(self, pool: Pool, state: Covariance, watched: Watch, yardstick: Yardstick, squarings: int = 2) -> None:
        super().__init__(pool, state)
        self._goal, self.watched = Objective.of(watched, squarings), watched
        self._beyond = yardstick.rms_of(state.value) ** 2 - state.value
        self.beta = watched.columns(pool.lattice)
        self.x = np.zeros((state.observation.size, watched.count))
        self.left = watched.fields.copy()
        self.pi = self._products(state.factor @ (state.weighted.T @ self.left))
        pairs = (watched.count - watched.single) // 2
        wrong = np.sum(self.left**2, axis=0) + watched.beside
        self.standing = Standing(np.array(self._promise(state.value)), np.zeros(watched.count), np.zeros(pairs), wrong)

    def fork(self) -> Self:
        """Return a copy that goes its own way."""
        other = super().fork()
        other.beta, other.pi, other.x, other.left = (each.copy() for each in (self.beta, self.pi, self.x, self.left))
        return other

    def _promise(self, value: float) -> float:
        return value + self._beyond

    @property
    def objective(self) -> float:
        """What the readings of the plan make of the objective, m²."""
        return float(self._goal.value(self.standing))

    @property
    def gains(self) -> Array:
        """By how much every candidate would lower the objective, (M,)."""
        none = np.zeros((len(self.above), 0)), np.zeros((0, self.watched.count))
        tables, slot = (self.above, self.below, self.joint), len(self.members)
        looked = _Looked(self.standing, *tables, none[0], none[0], none[1], none[1], slot)
        return self.objective - self._with_each(looked, np.arange(len(self.pool)))

    def losses(self) -> Array:
        """By how much the objective would rise were each reading of the plan not taken, (m,)."""
        if not self.pool.scalar:
            left = [self._standing_without(slot, *self._leaving(slot)) for slot in range(len(self.members))]
            return np.array([float(self._goal.value(each)) for each in left]) - self.objective
        mine = slice(self.pool.count, None)
        noise = np.array([member.variance for member in self.members])
        lost = np.minimum(self.below[mine] - 2 * noise, -1e-9 * noise)
        after = self._goal.after_one(self.standing, lost, self.above[mine], self.beta[mine], self.pi[mine])
        return after - self.objective

    def without(self, slot: int) -> tuple[Array, float]:
        """Return by how much each candidate lowers the objective without a reading, (M,), and the reading itself."""
        looked = self._looked_without(slot)
        before = float(self._goal.value(looked.standing))
        return before - self._with_each(looked, np.arange(len(self.pool))), before - self.objective

    def replacement(self, slot: int, allowed: NDArray[np.bool_], better: float | None = None) -> Replacement:
        """Return the best of the candidates that are allowed (M,) for the slot of a reading.

        better : where one is given, those that cannot bring by this share more than the reading are not looked at
        """
        looked, those = self._looked_without(slot), np.flatnonzero(allowed)
        before, gains = float(self._goal.value(looked.standing)), np.full(len(self.pool), -np.inf)
        own = before - self.objective
        best = -np.inf if better is None else own * (1 + better)
        for count in _HEAVIEST:
            heaviest = self._goal.heaviest(looked.standing, count)
            floors = self._with_each(looked, those, np.union1d(heaviest, self._doubted(slot)))
            most = before - floors + _ROUNDING * before
            able = ~(most < best - ALIKE * abs(best))
            those, most = those[able], most[able]
        order = np.argsort(-most, kind="stable")
        for start in range(0, len(order), _AT_ONCE):
            part = order[start : start + _AT_ONCE]
            if most[part[0]] < best - ALIKE * abs(best):
                break
            gains[those[part]] = before - self._with_each(looked, those[part])
            best = max(best, float(gains.max()))
        index = first_best(gains, ALIKE)
        return Replacement(index, float(gains[index]), own)

    def replacements(self, slots: Sequence[int], allowed: Allowed, better: float) -> Iterator[Replacement]:
        """Yield the same for several slots, one after another."""
        return (self.replacement(slot, allowed(self, slot), better) for slot in slots)

    def _looked_without(self, slot: int) -> _Looked:
        left, mine = self._had_left(slot), self._numbers(slot)
        pulled = -left.eta @ self.beta[mine]
        turned = -left.eta @ (self.pi[mine] + left.omega @ pulled)
        standing = self._standing_without(slot, -left.eta, left.omega)
        return _Looked(standing, left.above, left.below, left.joint, left.cross, left.reach, pulled, turned, slot)

    def _standing_without(self, slot: int, grown: Array, omega: Array) -> Standing:
        mine = self._numbers(slot)
        standing = self._goal.after_several(self.standing, -grown, omega, self.beta[mine], self.pi[mine])
        gone = self._doubted(slot)
        standing.own[gone] = standing.wrong[gone] = 0.0
        return standing

    def _with_each(self, looked: _Looked, candidates: NDArray[np.intp], only: NDArray[np.intp] | None = None) -> Array:
        """Return the objective with each of some candidates, (m,), or a floor of it, by some departures only."""
        part = _Counted(self._goal, looked.standing, None)
        if only is not None:
            columns, pairs = self._goal.columns(only)
            part = _Counted(self._goal.within(only), looked.standing.within(columns, pairs), columns)
        result, several = np.empty(len(candidates)), self.pool.values[candidates] > 1
        for which, objective in ((~several, self._with_one), (several, self._with_several)):
            mine = np.flatnonzero(which)
            for start in range(0, len(mine), height := max(1, _NEAR // len(part.goal.beside))):
                block = mine[start : start + height]
                result[block] = objective(looked, part, candidates[block])
        return result

    def _with_one(self, looked: _Looked, part: _Counted, candidates: NDArray[np.intp]) -> Array:
        """Return the objective with each of candidates of one number, (m,)."""
        numbers = self.pool.first[candidates]
        tables = self._tables(looked, part, numbers)
        return part.goal.after_one(part.standing, looked.below[numbers], looked.above[numbers], *tables)

    def _with_several(self, looked: _Looked, part: _Counted, candidates: NDArray[np.intp]) -> Array:
        """Return the objective with each of candidates of several numbers, (m,)."""
        joint = looked.joint.within(np.searchsorted(looked.joint.first, self.pool.first[candidates]))
        above, below = joint.matrices(looked.above, looked.below)
        inverse: Array = np.asarray(np.linalg.inv(below), dtype=np.float64)
        tables = self._tables(looked, part, joint.numbers.ravel())
        beta, pi = (table.reshape(*joint.numbers.shape, -1) for table in tables)
        if joint.inside is not None:
            beta, pi = (table * joint.inside[:, :, None] for table in (beta, pi))
        return part.goal.value(part.goal.after_several(part.standing, inverse, above, beta, pi))

    def _tables(self, looked: _Looked, part: _Counted, numbers: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return β and π of numbers (m,), each (m, k), of the departures that count."""
        cross, reach, pulled, turned = looked.cross[numbers], looked.reach[numbers], looked.pulled, looked.turned
        if part.columns is None:
            beta, pi = self.beta[numbers], self.pi[numbers]
        else:
            at = numbers[:, None] * self.watched.count + part.columns
            beta, pi = (table.reshape(-1).take(at) for table in (self.beta, self.pi))
            pulled, turned = pulled[:, part.columns], turned[:, part.columns]
        beta, pi = beta + cross @ pulled, pi + cross @ turned + reach @ pulled
        own = self._doubted(looked.slot)
        if part.columns is not None:
            own = np.flatnonzero(np.isin(part.columns, own))
        beta[:, own], pi[:, own] = 1.0, 0.0
        return beta, pi

    def _doubted(self, slot: int) -> NDArray[np.intp]:
        """Return the column of a slot whose reading may be bad, none of another."""
        return np.flatnonzero(np.arange(self.watched.doubted) == slot)

    def _taken(self, places: Places, rows: Array, here: slice, variances: float | Array) -> float:
        """Take numbers in, and with them what departures do to them; arguments as of `Scores`."""
        self._pad()
        h = self.state.factor @ (rows @ self.state.factor).T
        self.beta[here] = self.watched.columns(places) - rows @ self.x
        self._doubt(here)
        self.pi[here] = self.state.root.of(h).T @ self.left
        return super()._taken(places, rows, here, variances)

    def _doubt(self, here: slice) -> None:
        """Let readings that enter be bad ones, perhaps.  here : their numbers"""
        for slot in range(min(len(self.members), self.watched.doubted)):
            mine = self._numbers(slot)
            if here.start <= mine.start < here.stop:
                self.beta[mine, slot] = 1.0

    def leave(self, slot: int) -> float:
        """Take a reading out of the plan, which is no bad one then; as of `Scores`."""
        risen = super().leave(slot)
        gone = self._doubted(slot)
        for table in (self.beta, self.pi, self.x, self.left):
            table[:, gone] = 0.0
        self.standing.own[gone] = self.standing.wrong[gone] = 0.0
        return risen

    def _pad(self) -> None:
        """Give the unknowns that came with cells a row of nothing in x."""
        missing = self.state.observation.size - len(self.x)
        if missing:
            self.x = np.vstack([self.x, np.zeros((missing, self.x.shape[1]))])

    def _room(self, numbers: slice) -> None:
        super()._room(numbers)
        at = np.full(numbers.stop - numbers.start, numbers.start)
        self.beta, self.pi = (np.insert(table, at, 0.0, axis=0) for table in (self.beta, self.pi))

    def _cut(self, numbers: slice) -> None:
        super()._cut(numbers)
        at = np.arange(numbers.start, numbers.stop)
        self.beta, self.pi = (np.delete(table, at, axis=0) for table in (self.beta, self.pi))

    def _changed(self, here: slice, change: LowRank, cross: Array, reach: Array) -> None:
        beta, pi = change.turn @ self.beta[here], change.turn @ self.pi[here]
        pulled = change.eta @ beta
        turned = change.eta @ (pi - change.omega @ pulled)
        take_off(self.beta, cross, pulled, self.beta)
        take_off(self.pi, np.hstack([cross, reach]), np.vstack([turned, pulled]), self.pi)
        self.left = self.left - self.state.root.of(change.h) @ pulled
        self.x = self.x + change.h @ pulled
        self.standing = self._goal.after_several(self.standing, change.eta, change.omega, beta, pi)
        super()._changed(here, change, cross, reach)
