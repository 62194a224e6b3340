"""To the mode with the original prior and all readings at full weight: damped Gauss-Newton (Levenberg, Marquardt)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from axiscal.estimation.progressive.bent_readings import BentReadings
from axiscal.numerics import Array

_STEPS, _SETTLED = 80, 1e-7
"""Steps end where the whitened unknowns stay, RMS."""
_FIRST, _SOFTER, _HARDER, _HARDEST = 1e-3, 0.1, 10.0, 1e12
"""Damping, of the diagonal: any start does, for it is a tenth after each step and ten times as much until one helps."""


class Optimum(NamedTuple):
    """point : (k,) errors and unknowns; cost : ½ zᵀz + ½ Σ(r/σ)² there"""

    point: Array
    cost: float


def polished(problem: BentReadings, start: Array) -> Optimum:
    """Return the optimum that a start leads to.  start : (k,)"""
    z = problem.whitened(start)
    point = problem.start + problem.root @ z
    left = problem.left(point)
    cost, damping = _cost(z, left), _FIRST
    for _ in range(_STEPS):
        slopes = (problem.at(point).rows @ problem.root) / np.sqrt(problem.variances)[:, None]
        normal = np.eye(len(z)) + slopes.T @ slopes
        pull = slopes.T @ left - z
        while True:
            step = np.linalg.solve(normal + damping * np.diag(np.diagonal(normal)), pull)
            tried = problem.start + problem.root @ (z + step)
            left_there = problem.left(tried)
            there = _cost(z + step, left_there)
            if there <= cost or damping > _HARDEST:
                break
            damping *= _HARDER
        if not there <= cost:  # nor where it is not a number
            break
        z, point, left, cost, damping = z + step, tried, left_there, there, damping * _SOFTER
        if float(np.sqrt(np.mean(step**2))) < _SETTLED:
            break
    return Optimum(point, cost)


def _cost(z: Array, left: Array) -> float:
    return float(z @ z + left @ left) / 2
