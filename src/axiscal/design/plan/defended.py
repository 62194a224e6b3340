"""The gains of a lattice when a plan is to minimise what its readings can vouch for, not its promise alone.

    objective = (P^p + Σ_h w_h D_h^{2p})^{1/p},  P the promised variance, D the damage of each departure, p = 4

Beside what `Scores` keeps, each departure column b has β = b − gᵀx and π = eᵀ V C g of every candidate, the information
I = bᵀK⁻¹b and the error e = V φ − V x, x what the estimate makes of b. A reading with v = σ² + gᵀCg and N = |V C g|²
that enters makes of them

    I + β βᵀ/v,   |e|² − 2βπ/v + β²N/v²,   β_c − (g_cᵀ C g) β/v,   e − V C g β/v

and a reading that leaves the same with v = gᵀCg − σ². Of a reading of several numbers v is the matrix R + G C Gᵀ.
"""

from __future__ import annotations

from typing import NamedTuple, Self

import numpy as np

from axiscal.accuracy.damage import KAPPA, needed
from axiscal.accuracy.yardstick import Yardstick
from axiscal.design.gains.candidate_rows import Pool
from axiscal.design.gains.covariance import Covariance, RankOne
from axiscal.design.gains.running_gains import Scores
from axiscal.design.gains.three_values import SharedReadings
from axiscal.design.plan.watch import Watch
from axiscal.measurement.place import Places
from axiscal.numerics import Array

_SMALLEST = 1e-300
"""No division by nought."""
_HOPELESS = 1e200
"""Of a power, so that sums of many stay below the largest float; a curve of millimetres went beyond it."""


class Standing(NamedTuple):
    """What readings show of each departure; of one plan, or of many at once.

    promise : P, m²; own : (..., k) information; across : (..., pairs) between the columns of a pair
    wrong : (..., k) |e|², m²
    """

    promise: Array
    own: Array
    across: Array
    wrong: Array


class DefendedScores(Scores):
    """Scores whose gains are those of the objective.

    beta, pi : (numbers, k) of the candidates, then of the readings of the plan; x : (n, k); left : (w, k) e
    squarings : p of the objective is two to this power
    """

    def __init__(self, pool: Pool, state: Covariance, watched: Watch, yardstick: Yardstick, squarings: int = 2) -> None:
        super().__init__(pool, state)
        self._squarings, self.watched = squarings, watched
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
        return float(self._objective(self.standing))

    @property
    def gains(self) -> Array:
        """By how much every candidate would lower the objective, (M,)."""
        return self.objective - self._with_each(self.standing, self.above, self.below, self.joint, self.beta, self.pi)

    def losses(self) -> Array:
        """By how much the objective would rise were each reading of the plan not taken, (m,)."""
        if not self.pool.scalar:
            left = [self._standing_without(slot, *self._leaving(slot)) for slot in range(len(self.members))]
            return np.array([float(self._objective(each)) for each in left]) - self.objective
        mine = slice(self.pool.count, None)
        noise = np.array([member.variance for member in self.members])
        lost = np.minimum(self.below[mine] - 2 * noise, -1e-9 * noise)
        return self._after(self.standing, lost, self.above[mine], self.beta[mine], self.pi[mine]) - self.objective

    def without(self, slot: int) -> tuple[Array, float]:
        """Return by how much each candidate lowers the objective without a reading, (M,), and the reading itself."""
        left, mine, count = self._had_left(slot), self._numbers(slot), self.pool.count
        pulled = left.grown @ self.beta[mine]
        cross, reach = left.cross[:, :count], left.reach[:, :count]
        betas = self.beta[:count] + cross.T @ pulled
        pis = self.pi[:count] + cross.T @ (left.grown @ (self.pi[mine] + left.omega @ pulled)) + reach.T @ pulled
        other = self._standing_without(slot, left.grown, left.omega)
        before = float(self._objective(other))
        return before - self._with_each(other, left.above, left.below, left.joint, betas, pis), before - self.objective

    def _standing_without(self, slot: int, grown: Array, omega: Array) -> Standing:
        mine = self._numbers(slot)
        return self._with_numbers(self.standing, -grown, omega, self.beta[mine], self.pi[mine])

    def _with_each(
        self, standing: Standing, above: Array, below: Array, joint: SharedReadings, beta: Array, pi: Array
    ) -> Array:
        """Return the objective with each candidate, (M,).  above, below, beta, pi : of all their numbers, and more"""
        count, pool = self.pool.count, self.pool
        if pool.scalar:
            return self._after(standing, below[:count], above[:count], beta[:count], pi[:count])
        result, single = np.empty(len(pool)), pool.values == 1
        alone = pool.first[single]
        if len(alone):
            result[single] = self._after(standing, below[alone], above[alone], beta[alone], pi[alone])
        near, spread = joint.matrices(above, below)
        three = joint.first[:, None] + np.arange(3)
        inverse: Array = np.asarray(np.linalg.inv(spread), dtype=np.float64)
        together = self._with_numbers(standing, inverse, near, beta[three], pi[three])
        result[~single] = self._objective(together)
        return result

    def _with_numbers(self, standing: Standing, inverse: Array, above: Array, beta: Array, pi: Array) -> Standing:
        """Return what readings show after one of several numbers, or after each of many.

        inverse : (..., r, r) M⁻¹, with M = R + G C Gᵀ; -M of one that leaves; above : (..., r, r) G C W C Gᵀ
        beta, pi : (..., r, k)
        """
        solved = inverse @ beta
        across = np.sum(self._pair(beta)[0] * self._pair(solved)[1], axis=-2)
        wrong = standing.wrong - 2 * np.sum(solved * pi, axis=-2) + np.sum(solved * (above @ solved), axis=-2)
        return Standing(
            standing.promise - np.sum(inverse * above, axis=(-2, -1)),
            standing.own + np.sum(beta * solved, axis=-2),
            standing.across + across,
            np.maximum(wrong, self.watched.beside),
        )

    def _entered(self, here: int, row: Array, variance: float) -> RankOne:
        self._pad()
        reach = self.state.root.of(self.state.factor @ (row @ self.state.factor))
        self.beta[here] = next(self._coming) - row @ self.x
        self.pi[here] = reach @ self.left
        return super()._entered(here, row, variance)

    def enter(self, what: int | Places, slot: int | None = None, bundle: int = 1) -> float:
        """Take a candidate, or a reading at another single place, into the plan, and return by how much J falls."""
        place = what if isinstance(what, Places) else self.pool.lattice.at(what)
        self._coming = iter(self.watched.columns(place))
        return super().enter(what, slot, bundle)

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

    def _changed(self, here: int, change: RankOne, cross: Array, reach: Array) -> None:
        beta, pi = self.beta[here].copy(), self.pi[here].copy()
        eta, omega = change.eta, change.omega
        self.beta, self.pi = self._moved(self.beta, self.pi, cross, reach, eta, omega, beta, pi)
        self.left = self.left - eta * np.outer(self.state.root.of(change.h), beta)
        self.x = self.x + eta * np.outer(change.h, beta)
        self.standing = self._entering(self.standing, eta, omega, beta, pi)
        super()._changed(here, change, cross, reach)

    @staticmethod
    def _moved(
        betas: Array, pis: Array, cross: Array, reach: Array, eta: float, omega: float, beta: Array, pi: Array
    ) -> tuple[Array, Array]:
        """Return β and π of all numbers after a reading.  cross : (numbers,) g_cᵀ C g; reach : g_cᵀ C W C g"""
        pis = pis - eta * np.outer(cross, pi) + np.outer(eta**2 * omega * cross - eta * reach, beta)
        return betas - eta * np.outer(cross, beta), pis

    def _entering(self, standing: Standing, eta: float, omega: float, beta: Array, pi: Array) -> Standing:
        first, second = self._pair(beta)
        return Standing(
            standing.promise - eta * omega,
            standing.own + eta * beta**2,
            standing.across + eta * first * second,
            np.maximum(standing.wrong - 2 * eta * beta * pi + eta**2 * omega * beta**2, self.watched.beside),
        )

    def _after(self, standing: Standing, below: Array, above: Array, beta: Array, pi: Array) -> Array:
        """Return the objective after each of many readings, (m,).  below : v; above : N; beta, pi : (m, k)"""
        eta = (1.0 / below)[:, None]
        first, second = self._pair(beta)
        scaled = eta * beta
        wrong = scaled * above[:, None]  # in place from here: these tables are what a search spends its time on
        wrong -= 2 * pi
        wrong *= scaled
        wrong += standing.wrong
        np.maximum(wrong, self.watched.beside, out=wrong)
        across = standing.across + eta * first * second
        scaled *= beta
        scaled += standing.own
        return self._objective(Standing(standing.promise - above / below, scaled, across, wrong))

    def _pair(self, beta: Array) -> tuple[Array, Array]:
        """Return the first and the second columns of departures that have two."""
        pairs = beta[..., self.watched.single :]
        return pairs[..., 0::2], pairs[..., 1::2]

    def _objective(self, at: Standing) -> Array:
        singles, pairs = slice(0, self.watched.single), slice(self.watched.single, None)
        one = self._damage(at.own[..., singles], at.wrong[..., singles], singles, 1)
        (own, other), (near, far) = self._pair(at.own), self._pair(at.wrong)
        least = (own + other) / 2 - np.sqrt(((own - other) / 2) ** 2 + at.across**2)
        two = self._damage(np.maximum(least, 0.0), (near + far) / 2, pairs, 2)
        scale = max(float(np.min(at.promise)), _SMALLEST)
        summed = self._raised(np.maximum(at.promise, _SMALLEST) / scale)
        for damages, which in ((one, singles), (two, pairs)):
            with np.errstate(over="ignore"):  # against a promise of nothing: hopeless
                shares = damages / scale
            summed = summed + self._raised(shares) @ self.watched.weights[which]
        total: Array = scale * summed ** (0.5**self._squarings)
        return total

    def _damage(self, information: Array, wrong: Array, which: slice, degrees: int) -> Array:
        """Return D² of departures.  information, wrong : (..., h), of those of one column or of two"""
        damages = needed(degrees) / (KAPPA**2 - 1) / np.maximum(information, _SMALLEST)
        np.minimum(damages, self.watched.most[which] ** 2, out=damages)
        damages *= wrong
        result: Array = damages
        return result

    def _raised(self, values: Array) -> Array:
        """Return values to the power p; hopeless ones are as hopeless as a float can say."""
        values = np.minimum(values, _HOPELESS ** (0.5**self._squarings))
        for _ in range(self._squarings):
            values = np.square(values)
        return values
