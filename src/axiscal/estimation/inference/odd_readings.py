"""Readings that are not normal: those that say no more than an interval, and those that chips shift to one side.

A display of steps q, or a bound ±q/2 on what a reading may be off beside its noise:

    p(y | s) = Φ((y + q/2 − s)/σ) − Φ((y − q/2 − s)/σ)

Up to q = 3σ a variance of q²/12 beside σ² says as much. Above, readings repeated in one cell of the display would pass
for independent ones. Expectation propagation (Minka 2001) replaces each interval by a normal site ỹ, ṽ. The estimate
then agrees with each interval in mean and variance, given all the others:

    α, β = (y ∓ q/2 − μ)/√(v + σ²),   Z = Φ(β) − Φ(α),   d₁ = (φ(α) − φ(β))/Z,   d₂ = (αφ(α) − βφ(β))/Z
    mean μ + v d₁/√(v + σ²),   variance v + v² (d₂ − d₁²)/(v + σ²)

with μ, v what all others say there. The interval is log-concave, so sites have positive variances (Rasmussen and
Williams 2006, section 3.6).

A chip or burr under the stylus shifts one reading in fifty to one side, by b and as much again:

    p(y | s) = (1 − π) N(y − s; 0, σ²) + π N(y − s; b, b² + σ²),   π = 0.02

Its moments are those of two normal ones, weighted by how well each predicted y. It is not log-concave: a site is then
as wide as `WIDEST` at most, where an exact one would have no width at all. Which of two readings that contradict each
other is right is then weighed over every way in which chips may have fallen.

All numbers of all readings are estimated at once, each with its own precision. The model is y = Φ z + v, z ~ N(0, 1), v
~ N(0, 1/d). Let D = diag(d) and M = 1 + Φᵀ D Φ. The estimate of Φ z is Φ M⁻¹ Φᵀ D y, its variance diag(Φ M⁻¹ Φᵀ).

Expectation propagation ends at one side where the density has two humps. It then trusts one of two contradicting
readings, because the site of the other one was there first. So of the readings that stand out the most, up to `_MOST`,
all 2ᵏ ways h are weighed,

    p(h | y) ∝ π^|h| (1 − π)^(k−|h|) N(y; m + b h, P + D_h),   D_h = σ² + b² h,

with m, P the mean and covariance there from the sites of all others. These readings get sites that leave mean and
variance of that mixture at each of them. Precisions Λ of sites that leave variances v are where the concave

    log|1 + Fᵀ Λ F| − Σ λ v,    P = F Fᵀ,

is the largest; with them, values μ + α/λ leave the mean μ = m + P α, whatever Λ is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.description.sizes import NONE_VARY
from axiscal.estimation.promise.problem import Inherited, problem
from axiscal.estimation.promise.spaces import turned
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import FINEST, Setup
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import log_normal_share, solution
from axiscal.numerics.gaussian import lower_root, positive_root

COARSE = 3.0
"""Steps of so many standard deviations of the scatter are taken as intervals."""
_SWEEPS, _DAMPING, _SETTLED = 30, 0.5, 1e-4
"""Sweeps end where the intervals settle; half steps keep them from swinging."""
_TAIL = 1e-300
"""The smallest that has a logarithm."""


def is_coarse(setup: Setup) -> bool:
    """Whether readings of a set-up say no more than an interval that is coarse beside their scatter."""
    return setup.interval > COARSE * setup.scatter


def is_odd(setup: Setup) -> bool:
    """Whether readings of a set-up are far from normal: of coarse intervals, or shifted to one side."""
    return is_coarse(setup) or setup.one_sided != 0


def sited(
    observation: Observation, readings: Sequence[Reading], prior: tuple[Array, Array] | None = None
) -> list[Reading]:
    """Return readings with the normal ones in the place of those of odd set-ups.

    prior : mean and covariance of the errors, where they are not the stated ones
    Readings of three values, and those that state a std of their own, stay as they are.
    """
    setups = {setup.name: setup for setup in observation.setups}
    odd = [len(r.values) == 1 and r.std is None and is_odd(setups[r.setup]) for r in readings]
    if not any(odd):
        return list(readings)
    fitted = Fitted.of(observation, readings, prior)
    which = np.array(odd)[fitted.reading]
    owners = [setups[readings[int(i)].setup] for i in fitted.reading]
    chips = np.where(which, [setup.one_sided for setup in owners], 0.0)
    steps = np.where(which & (chips == 0), [setup.interval for setup in owners], 0.0)
    soft = np.where(steps > 0, [setup.scatter for setup in owners], FINEST)
    scatter = np.maximum(fitted.noise - steps**2 / 12.0, soft**2)
    found = sites(fitted, steps, scatter, chips)
    shift = dict(zip(fitted.reading.tolist(), zip(*found, fitted.values, strict=True), strict=False))
    return [_moved(reading, *shift[index]) if odd[index] else reading for index, reading in enumerate(readings)]


def _moved(reading: Reading, value: float, variance: float, before: float) -> Reading:
    return replace(reading, value=reading.value + value - before, std=float(np.sqrt(variance)))


def sites(fitted: Fitted, steps: Array, scatter: Array, chips: Array | None = None) -> Sites:
    """Return the sites of all numbers.

    fitted : the numbers, with their priors; steps : (m,) widths of intervals, 0 where there is none
    scatter : (m,) σ²; chips : (m,) b with its sign, 0 where none shifts a reading
    Readings that chips may have shifted begin with little weight, that a few of them do not put all others in doubt.
    """
    beside = np.zeros(len(steps)) if chips is None else chips
    which = (steps > 0) | (beside != 0)
    values, precisions = fitted.values.copy(), 1.0 / (fitted.noise + beside**2)
    for _ in range(_SWEEPS):
        mean, spread = fitted.estimate(values, precisions)
        cavity = 1.0 / np.maximum(1.0 / spread - precisions, 1.0 / (WIDEST * fitted.noise))
        centre = cavity * (mean / spread - precisions * values)
        inside = _moments(fitted.values, steps, scatter, centre, cavity)
        shifted = _shifted(fitted.values, beside, scatter, centre, cavity)
        wanted_mean, wanted = (np.where(beside != 0, one, other) for one, other in zip(shifted, inside, strict=True))
        fresh = np.maximum(1.0 / wanted - 1.0 / cavity, 1.0 / (WIDEST * fitted.noise))
        pull = wanted_mean / wanted - centre / cavity
        change = np.where(which, fresh - precisions, 0.0)
        target = (1 - _DAMPING) * precisions * values + _DAMPING * pull
        precisions = precisions + _DAMPING * change
        values = np.where(which, target / precisions, values)
        if float(np.max(np.abs(change) / precisions)) < _SETTLED:
            break
    found = Sites(values, 1.0 / precisions)
    return every_way(fitted, found, scatter, beside) if np.any(beside) else found


def _moments(shown: Array, steps: Array, scatter: Array, centre: Array, cavity: Array) -> tuple[Array, Array]:
    """Return mean and variance of what was read, given its interval and what all others say, each (m,)."""
    width = np.sqrt(cavity + scatter)
    low, high = (shown - steps / 2 - centre) / width, (shown + steps / 2 - centre) / width
    mirrored = low > 0  # in the left tail both are small and their difference keeps its digits
    low, high = np.where(mirrored, -high, low), np.where(mirrored, -low, high)
    log_high, log_low = log_normal_share(high), log_normal_share(low)
    log_share = log_high + np.log(np.maximum(-np.expm1(log_low - log_high), _TAIL))
    at_low, at_high = (np.exp(-(x**2) / 2 - 0.5 * np.log(2 * np.pi) - log_share) for x in (low, high))
    first, second = at_low - at_high, low * at_low - high * at_high
    first = np.where(mirrored, -first, first)
    mean = centre + cavity * first / width
    variance = cavity + cavity**2 * (second - first**2) / width**2
    return mean, np.maximum(variance, np.finfo(float).tiny)


def _shifted(shown: Array, chips: Array, scatter: Array, centre: Array, cavity: Array) -> tuple[Array, Array]:
    """Return mean and variance of what was read where a chip may have shifted it, each (m,).  chips : (m,) b"""
    wide = np.stack([cavity + scatter, cavity + scatter + chips**2])
    off = np.stack([shown - centre, shown - centre - chips])
    odds = np.log([[1 - SHARE], [SHARE]]) - off**2 / (2 * wide) - np.log(wide) / 2
    share = np.exp(odds - odds.max(axis=0))
    share /= share.sum(axis=0)
    means, variances = centre + cavity * off / wide, cavity - cavity**2 / wide
    mean = np.sum(share * means, axis=0)
    return mean, np.sum(share * (variances + (means - mean) ** 2), axis=0)


WIDEST = 1e8
"""Times the noise: so wide a site says nothing."""
SHARE = 0.02
"""Share of the readings that chips or burrs shift: an assumption."""


class Fitted:
    """Numbers before any of them was read, and their estimate.

    features : (m, r) Φ; noise : (m,) σ²; values : (m,); reading : (m,) index of the reading of each number
    """

    def __init__(self, features: Array, noise: Array, values: Array, reading: NDArray[np.intp]) -> None:
        self._features, self.noise, self.values, self.reading = _short(features), noise, values, reading

    @classmethod
    def of(
        cls, observation: Observation, readings: Sequence[Reading], prior: tuple[Array, Array] | None = None
    ) -> Fitted:
        """Return the numbers of readings, by the stated model or another prior of the errors (mean, covariance)."""
        posed = problem(observation, readings, NONE_VARY, None if prior is None else Inherited(*prior), usual=False)
        stated = np.zeros(0)
        features = turned(posed, posed.rows, stated, [curves.roots(stated) for curves in posed.curves])
        return cls(features * posed.noise[:, None], posed.noise**2, posed.values * posed.noise, posed.reading)

    def covariance(self) -> Array:
        """Return the covariance of the numbers before any was read, noise included, (m, m)."""
        return self._features @ self._features.T + np.diag(self.noise)

    def estimate(self, values: Array, precisions: Array) -> tuple[Array, Array]:
        """Return mean and variance of the numbers without noise, (m,), if these values had these precisions 1/σ²."""
        information = np.eye(self._features.shape[1]) + (self._features.T * precisions) @ self._features
        spread = self._features @ np.asarray(np.linalg.inv(information), dtype=float)
        mean: Array = spread @ (self._features.T @ (precisions * values))
        return mean, np.einsum("mr,mr->m", spread, self._features)


def _short(features: Array) -> Array:
    """Return features with the same products of rows, no more of them than there are rows."""
    if features.shape[1] <= len(features):
        return features
    triangle: Array = np.asarray(np.linalg.qr(features.T, mode="r"))
    return triangle.T


class Sites(NamedTuple):
    """Normal readings in the place of others.  values, variances : (m,)"""

    values: Array
    variances: Array


_MOST = 8
"""Readings of which every way is weighed: 256 ways take a hundredth of a second."""
_ALL_SWEEPS, _ALL_SETTLED = 400, 1e-6
"""Of the precisions; they end where none changes by more than that share. Few need a hundred."""


def every_way(fitted: Fitted, found: Sites, scatter: Array, chips: Array) -> Sites:
    """Return sites with the moments of every way in which chips may have fallen.

    found : sites of all numbers; scatter : (m,) σ²; chips : (m,) b with its sign, 0 where none shifts a reading
    """
    mine = _standing_out(fitted, found, scatter, chips)
    if len(mine) < 2:
        return found
    centre, prior = _of_the_others(fitted, found, mine)
    pull, variance = _over_ways(fitted.values[mine] - centre, prior, scatter[mine], chips[mine])
    least = 1.0 / (WIDEST * fitted.noise[mine])
    own = _precisions(prior, variance, 1.0 / found.variances[mine], least)
    values, variances = found.values.copy(), found.variances.copy()
    values[mine], variances[mine] = centre + prior @ pull + pull / own, 1.0 / own
    return Sites(values, variances)


def _precisions(prior: Array, variances: Array, start: Array, least: Array) -> Array:
    """Return the precisions (k,) of sites that leave these variances of a prior (k, k), none below the least.

    Each alone has its best in closed form. All at once they overshoot where they see the same. The function is concave,
    so the mean of k single steps is never worse than their start.
    """
    root, own = positive_root(prior, np.diag(prior)), np.maximum(start, least)
    for _ in range(_ALL_SWEEPS):
        inner = np.eye(root.shape[1]) + (root.T * own) @ root
        left = np.einsum("kr,kr->k", root @ np.linalg.inv(inner), root)
        change = (np.maximum(own + 1.0 / variances - 1.0 / left, least) - own) / len(own)
        own = own + change
        if float(np.max(np.abs(change) / own)) < _ALL_SETTLED:
            break
    return own


def _standing_out(fitted: Fitted, found: Sites, scatter: Array, chips: Array) -> NDArray[np.intp]:
    """Return the indices of those readings that the others leave in doubt the most, at most `_MOST` of them.

    What the others say is taken without the sites of all that chips may have shifted: with their plain noise.
    """
    precisions = np.where(chips != 0, 1.0 / (scatter + chips**2), 1.0 / found.variances)
    values = np.where(chips != 0, fitted.values, found.values)
    mean, spread = fitted.estimate(values, precisions)
    open_part = np.maximum(1.0 - spread * precisions, np.finfo(float).eps)
    away = np.abs(values - mean) / open_part / np.sqrt(spread / open_part + scatter)
    which = np.flatnonzero(chips != 0)
    order = which[np.argsort(-away[which], kind="stable")]
    return np.sort(order[:_MOST])


def _over_ways(shown: Array, prior: Array, scatter: Array, chips: Array) -> tuple[Array, Array]:
    """Return α and the variances (k,) of what was read, over every way in which chips fell; the mean is P α.

    shown : (k,) values less what the others predict; prior : (k, k) what these leave open; scatter, chips : (k,)
    """
    logs, pulls, variances = [], [], []
    for hit in product((0.0, 1.0), repeat=len(shown)):
        fallen = np.array(hit)
        lower = lower_root(prior + np.diag(scatter + fallen * chips**2))
        white, half = solution(lower, shown - fallen * chips), solution(lower, prior)
        odds = fallen.sum() * np.log(SHARE) + (1 - fallen).sum() * np.log1p(-SHARE)
        logs.append(odds - 0.5 * float(white @ white) - float(np.log(np.diag(lower)).sum()))
        pulls.append(np.linalg.solve(lower.T, white))
        variances.append(np.diag(prior) - np.sum(half**2, axis=0))
    share = np.exp(np.array(logs) - max(logs))
    share /= share.sum()
    each = np.array(pulls)
    pull: Array = share @ each
    variance: Array = share @ (np.array(variances) + ((each - pull) @ prior) ** 2)
    return pull, variance


def _of_the_others(fitted: Fitted, found: Sites, mine: NDArray[np.intp]) -> tuple[Array, Array]:
    """Return mean (k,) and covariance (k, k) that all other sites leave of what was read here."""
    others = np.setdiff1d(np.arange(len(found.values)), mine)
    prior = fitted.covariance() - np.diag(fitted.noise)
    lower = lower_root(prior[np.ix_(others, others)] + np.diag(found.variances[others]))
    half = solution(lower, prior[np.ix_(others, mine)])
    mean: Array = half.T @ solution(lower, found.values[others])
    return mean, prior[np.ix_(mine, mine)] - half.T @ half
