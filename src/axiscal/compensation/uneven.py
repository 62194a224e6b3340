"""Where to set the points of a table so that its line is near the curve, on a control that takes them anywhere.

A line between two points is off by about h² |f''| / 8: points belong where the curve bends. They are set one by one
where the line is farthest from the curve, from the ends on or from the knots of the errors on, which are the only
places where a spline bends otherwise on both sides.
"""

from __future__ import annotations

import numpy as np

from axiscal.numerics import Array

_SAMPLES = 1025
"""Places at which curve and line are compared; a table has some tens of points."""
_DECIMALS, _APART = 9, 1e-6
"""m or rad: knots nearer than rounding are one, and one that is as near to an end is that end."""
_NOTHING = 1e-10
"""m or rad: nearer than this no point is needed."""


def closest(curves: Array, at: Array, knots: Array, even: Array) -> Array:
    """Return no more positions than `even` has, whose line is nearest to curves; `even` where no others are nearer.

    curves : (s, n) forward and reverse, m or rad; at : (n,) increasing, from the first to the last position of a table
    knots : of the errors
    """
    distinct = np.unique(np.round(knots, _DECIMALS))
    inner = distinct[(distinct > at[0] + _APART) & (distinct < at[-1] - _APART)]
    starts = [at[[0, -1]], np.concatenate([at[:1], inner, at[-1:]])]
    found = [_grown(curves, at, start, len(even)) for start in starts if len(start) <= len(even)]
    return min([even, *found], key=lambda points: _farthest(curves, at, points)[0])


def places(start: float, stop: float) -> Array:
    """Return where curves are to be compared."""
    return np.linspace(start, stop, _SAMPLES)


def _grown(curves: Array, at: Array, points: Array, most: int) -> Array:
    """Return the positions with others between them, each where the line so far is farthest from the curve."""
    while len(points) < most:
        apart, place = _farthest(curves, at, points)
        if apart < _NOTHING or np.min(np.abs(points - place)) < (at[-1] - at[0]) / _SAMPLES:
            break
        points = np.sort(np.append(points, place))
    return points


def _farthest(curves: Array, at: Array, points: Array) -> tuple[float, float]:
    """Return how far the line through points of the curves is from them at the most, and where."""
    lines = np.stack([np.interp(at, points, np.interp(points, at, curve)) for curve in curves])
    apart = np.abs(curves - lines).max(axis=0)
    worst = int(np.argmax(apart))
    return float(apart[worst]), float(at[worst])
