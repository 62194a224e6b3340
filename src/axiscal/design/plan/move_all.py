"""All readings of a plan moved at once, off the lattice, to where together they leave least.

J = |Φ|² − tr(Φ Bᵀ (I + B Bᵀ)⁻¹ B Φᵀ) with the whitened rows B of all numbers has the gradient −2 (A Bᵀ)ᵀ A with respect
to B, A = Φ (I + BᵀB)⁻¹; how B changes with the coordinates is differenced. Rests count as noise of each reading's own
here: where two of them would share a cell, the true J decides whether the move is taken.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from axiscal.design.gains.covariance import Covariance, Point
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import lowest

_STEP = 1e-6
_ITERATIONS = 80


class _Free(NamedTuple):
    """A coordinate that may change.  low, high : of a reading of its set-up, m or rad."""

    reading: int
    axis: int
    low: float
    high: float


def moved(state: Covariance, points: list[Point]) -> list[Point]:
    """Return the readings, of the same set-ups and from the same sides, where J is lower; the same where it is not.

    state : before the first.  Coordinates on a raster stay.
    """
    free = _free(state, points)
    if not free:
        return points
    low, high = np.array([f.low for f in free]), np.array([f.high for f in free])
    start = (np.array([points[f.reading].pose[f.axis] for f in free]) - low) / (high - low)

    def placed(shares: Array) -> list[Point]:
        poses = np.array([p.pose for p in points])
        poses[[f.reading for f in free], [f.axis for f in free]] = low + shares * (high - low)
        return [Point(p.setup, pose, p.approach) for p, pose in zip(points, poses, strict=True)]

    def value(shares: Array) -> tuple[float, Array]:
        return _value(state, placed(shares), free)

    ended = placed(np.clip(lowest(value, start, 0.0, 1.0, _ITERATIONS), 0.0, 1.0))
    return ended if state.with_points(ended).value < state.with_points(points).value else points


def _free(state: Covariance, points: list[Point]) -> list[_Free]:
    axes, setups = state.observation.errors.machine.axes, state.observation.setups
    return [
        _Free(i, k, *setups[p.setup].span(axes[k], k))
        for i, p in enumerate(points)
        for k in setups[p.setup].moves
        if setups[p.setup].raster[k] == 0
    ]


def _value(state: Covariance, points: list[Point], free: list[_Free]) -> tuple[float, Array]:
    """Return J over what there was before, and its gradient with respect to shares of the free coordinates."""
    target = state.weighted
    rows, owner = state.whitened(points)
    crossed = target @ rows.T
    information = np.eye(len(rows)) + rows @ rows.T
    left = target - np.linalg.solve(information, crossed.T).T @ rows
    total = float(np.sum(target**2))
    slope = -2 * (left @ rows.T).T @ left / total
    changes = _changes(state, points, free)
    gradient = np.array([np.sum(slope[owner == f.reading] * change) for f, change in zip(free, changes, strict=True)])
    return float(np.sum(left * target)) / total, gradient


def _changes(state: Covariance, points: list[Point], free: list[_Free]) -> list[Array]:
    """Return the derivative of the rows of its reading with respect to the share of each free coordinate."""
    aside = []
    for sign in (1, -1):
        for f in free:
            pose = points[f.reading].pose.copy()
            pose[f.axis] = np.clip(pose[f.axis] + sign * _STEP * (f.high - f.low), f.low, f.high)
            aside.append(Point(points[f.reading].setup, pose, points[f.reading].approach))
    rows, owner = state.whitened(aside)
    count, first = len(free), np.searchsorted(owner, np.arange(2 * len(free) + 1))
    changes = []
    for i, f in enumerate(free):
        apart = (aside[i].pose[f.axis] - aside[count + i].pose[f.axis]) / (f.high - f.low)
        more, less = (rows[first[k] : first[k + 1]] for k in (i, count + i))
        changes.append((more - less) / apart)
    return changes
