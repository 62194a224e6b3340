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
other is right is then weighed over every way in which chips may have fallen (`chips`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from axiscal.estimation.inference.chips import every_way
from axiscal.estimation.inference.weighted_fit import SHARE, WIDEST, Fitted, Sites
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import FINEST, Setup
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import log_normal_share

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
