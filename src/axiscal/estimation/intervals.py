"""Readings that say no more than an interval: those of a coarse display, of steps q.

    p(y | s) = Φ((y + q/2 − s)/σ) − Φ((y − q/2 − s)/σ)

Up to q = 3σ a variance of q²/12 beside σ² says as much. Above, readings repeated in one cell of the display would pass
for independent ones. Expectation propagation (Minka 2001) replaces each interval by a normal site ỹ, ṽ. The estimate
then agrees with each interval in mean and variance, given all the others:

    α, β = (y ∓ q/2 − μ)/√(v + σ²),   Z = Φ(β) − Φ(α),   d₁ = (φ(α) − φ(β))/Z,   d₂ = (αφ(α) − βφ(β))/Z
    mean μ + v d₁/√(v + σ²),   variance v + v² (d₂ − d₁²)/(v + σ²)

with μ, v what all others say there. The interval is log-concave, so sites have positive variances (Rasmussen and
Williams 2006, section 3.6).

All numbers of all readings are estimated at once, each with its own precision. The model is y = Φ z + v, z ~ N(0, 1), v
~ N(0, 1/d). Let D = diag(d) and M = 1 + Φᵀ D Φ. The estimate of Φ z is Φ M⁻¹ Φᵀ D y, its variance diag(Φ M⁻¹ Φᵀ).
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace

import numpy as np

from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import FINEST, Setup
from axiscal.numerics import Array
from axiscal.numerics.displays import step_of
from axiscal_core.eigen import of_rank
from axiscal_core.from_scipy import log_normal_share
from axiscal_core.problem import Problem

_SWEEPS, _DAMPING, _SETTLED = 30, 0.5, 1e-4
"""Sweeps end where the intervals settle; half steps keep them from swinging."""
_MOST = 1e3
"""Noises: values in larger steps are in another unit, and no display is so coarse."""
_PASSED = 0.1
"""Of a step: what is rounded off spreads over ten times as much."""
_TAIL = 1e-300
"""The smallest that has a logarithm."""


def as_shown(setups: Sequence[Setup], readings: Sequence[Reading]) -> tuple[Setup, ...]:
    """Return set-ups with the step that their values show, or those of their instrument, where it is not stated."""
    found, of = list[Setup](), defaultdict[str, list[Reading]](list)
    for reading in readings:
        if reading.std is None:
            of[reading.setup].append(reading)
    for setup in setups:
        alike = [of[each.name] for each in setups if each.instrument == setup.instrument and of[setup.name]]
        step = _step_shown([of[setup.name]], setup.noise) or _step_shown(alike, setup.noise)
        variance = max(setup.noise**2 - setup.rounding**2, 0.0) + step**2 / 12.0
        coarser = setup.resolution + FINEST < step < _MOST * setup.noise
        found.append(replace(setup, resolution=step, noise=math.sqrt(variance)) if coarser else setup)
    return tuple(found)


def _step_shown(of_setups: Iterable[Sequence[Reading]], noise: float) -> float:
    """Return the step in which the values of set-ups move, m or rad; 0 for none, and where their places make it."""
    every = [each for each in of_setups if each]
    step = step_of(np.array([number for own in every for each in own for number in each.values]), noise)
    return 0.0 if step is None or all(_passed(own, step) for own in every) else step


def _passed(readings: Sequence[Reading], step: float) -> bool:
    """Return whether a line along the axes passes all values far within a step: equal ways then give equal steps."""
    along = np.array([[1.0, *each.pose, *each.approach] for each in readings])
    values = np.array([each.values for each in readings])
    line, _, rank, _ = np.linalg.lstsq(along, values)
    return len(readings) > rank and bool(np.abs(values - along @ line).max() < _PASSED * step)


def sited(
    posed: Problem, rows: Array, setups: Sequence[Setup], readings: Sequence[Reading], left_out: Collection[int] = ()
) -> Sequence[Reading]:
    """Return readings with the normal ones in the place of those of coarse set-ups; themselves where none is.

    posed : the readings, at sizes that do not vary; rows : (m, p) of unknowns of variance one, over the noise
    left_out : that do not count
    Readings of three values, and those that state a std of their own, stay as they are.
    """
    coarse = {setup.name for setup in setups if setup.coarse}
    mine = [index for index, r in enumerate(readings) if len(r.values) == 1 and r.std is None and r.setup in coarse]
    mine = [index for index in mine if index not in left_out]
    if not mine:
        return readings
    kept = ~np.isin(posed.reading, [*left_out])
    which, noise = np.isin(posed.reading[kept], mine), posed.noise[kept]
    owners, shown = [setups[index] for index in posed.setup[kept]], posed.values[kept] * noise
    steps = np.where(which, [setup.resolution for setup in owners], 0.0)
    soft = np.where(steps > 0, [setup.scatter for setup in owners], FINEST)
    features, scatter = of_rank(rows[kept] * noise[:, None]), np.maximum(noise**2 - steps**2 / 12.0, soft**2)
    found = sites(features, noise**2, shown, steps, scatter)
    each = np.array([*found, shown])[:, which].T.tolist()
    instead = {index: _moved(readings[index], *by) for index, by in zip(mine, each, strict=True)}
    return [instead.get(index, reading) for index, reading in enumerate(readings)]


def _moved(reading: Reading, value: float, variance: float, before: float) -> Reading:
    return replace(reading, value=reading.value + value - before, std=float(np.sqrt(variance)))


def sites(features: Array, noise: Array, shown: Array, steps: Array, scatter: Array) -> tuple[Array, Array]:
    """Return the sites of all numbers: their values and variances, (m,) each.

    features : (m, r) Φ; noise : (m,) variances as stated; shown : (m,) what was read
    steps : (m,) widths of intervals, 0 where there is none; scatter : (m,) σ²
    """
    which, values, precisions = steps > 0, shown.copy(), 1.0 / noise
    for _ in range(_SWEEPS):
        mean, spread = at_precisions(features, values, precisions)
        cavity = 1.0 / np.maximum(1.0 / spread - precisions, 1.0 / (WIDEST * noise))
        centre = cavity * (mean / spread - precisions * values)
        wanted_mean, wanted = _moments(shown, steps, scatter, centre, cavity)
        fresh = np.maximum(1.0 / wanted - 1.0 / cavity, 1.0 / (WIDEST * noise))
        pull = wanted_mean / wanted - centre / cavity
        change = np.where(which, fresh - precisions, 0.0)
        target = (1 - _DAMPING) * precisions * values + _DAMPING * pull
        precisions = precisions + _DAMPING * change
        values = np.where(which, target / precisions, values)
        if float(np.max(np.abs(change) / precisions)) < _SETTLED:
            break
    return values, 1.0 / precisions


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


WIDEST = 1e8
"""Times the noise: so wide a site says nothing."""


def at_precisions(features: Array, values: Array, precisions: Array) -> tuple[Array, Array]:
    """Return mean and variance of the numbers without noise, (m,), if these values had these precisions 1/σ²."""
    information = np.eye(features.shape[1]) + (features.T * precisions) @ features
    spread = features @ np.asarray(np.linalg.inv(information), dtype=float)
    return np.asarray(spread @ (features.T @ (precisions * values))), np.einsum("mr,mr->m", spread, features)
