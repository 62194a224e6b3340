"""Progressive Bayes: the likelihood comes in shares, its exponent γ going from 0 to 1 (Hanebeck and Feiermann 2003).

    Δ = min(1 − γ, κ²/max_i(q_i/σ_i²)),   the readings with variance σ²/Δ, about the mean, and again about the new one

q_i the second order of a reading under what is left open (see `BentReadings.second_order`): κ bounds it against the
noise that the share leaves, so that every share is nearly linear. Shares grow by themselves as the belief sharpens. The
belief is held in whitened unknowns as R with RᵀR its information: a share is one QR of [R; √Δ A] (Bierman 1977, ch. V).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from axiscal.estimation.progressive.bent_readings import BentReadings
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import transposed_solution

_KAPPA = 0.5
"""Half of the noise of a share; what it costs is the number of shares, for the polish ends at the mode anyway."""
_HALVINGS, _MOST = 6, 60
"""A share whose index is above one at its second look is halved, at most so often; shares end after so many."""
_WHOLE = 1.0 - 1e-12
"""γ is one up to rounding."""


class Waypoint(NamedTuple):
    """gamma : the exponent after it; z, point : (k,) the mean, whitened and not; triangle : (k, k) R

    worst : the largest √(q_i)/σ_i that it leaves
    """

    gamma: float
    z: Array
    point: Array
    triangle: Array
    worst: float


def shares(problem: BentReadings) -> list[Waypoint]:
    """Return the way from the prior to all readings, the prior first."""
    size = problem.root.shape[1]
    way = [_after(problem, 0.0, np.zeros(size), np.eye(size))]
    while way[-1].gamma < 1.0 and len(way) < _MOST:
        here = way[-1]
        step = min(1.0 - here.gamma, _KAPPA**2 / max(here.worst**2, 1e-300))
        for _ in range(_HALVINGS):
            once, _ = _taken(problem, here, here.point, step)
            z, triangle = _taken(problem, here, problem.start + problem.root @ once, step)
            after = _after(problem, here.gamma + step, z, triangle)
            if after.worst * np.sqrt(step) <= 1.0:
                break
            step /= 2
        way.append(after)
    return way


def _after(problem: BentReadings, gamma: float, z: Array, triangle: Array) -> Waypoint:
    point = problem.start + problem.root @ z
    spread = transposed_solution(triangle, problem.root.T).T
    index = float(np.sqrt(np.max(problem.second_order(point, spread), initial=0.0)))
    return Waypoint(1.0 if gamma > _WHOLE else gamma, z, point, triangle, index)


def _taken(problem: BentReadings, here: Waypoint, about: Array, step: float) -> tuple[Array, Array]:
    """Return z and R after a share of the readings, linearised about a point.  step : Δ"""
    numbers, size = problem.at(about), len(here.z)
    weights = np.sqrt(step / numbers.variances)
    slopes = weights[:, None] * (numbers.rows @ problem.root)
    left = weights * (numbers.values - numbers.rows @ here.point)
    stacked = np.zeros((size + len(left), size + 1))
    stacked[:size, :size], stacked[size:, :size], stacked[size:, size] = here.triangle, slopes, left
    done = np.asarray(np.linalg.qr(stacked, mode="r"))[:size]
    return here.z + np.linalg.solve(done[:, :size], done[:, size]), done[:, :size]
