"""Where along one coordinate of a chart an axis crosses a level: in closed form where it can be had.

Along one coordinate an axis goes as a + b u, or as a + c cos u + s sin u: then u = φ ± arccos((level − a)/R). A rotary
axis in step adds a second harmonic: then exp(iu) are roots of a quartic on the unit circle. What follows neither is
sampled and bisected.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from axiscal.numerics import Array

Curve = Callable[[Array], Array]
"""(p,) coordinates -> (p, q) poses."""

_NODES: Array = 2 * math.pi / 5 * np.arange(5.0)
"""Mathematics: five even angles give mean and two harmonics."""
_PROBES: Array = np.array([0.37, 2.9])
"""Two angles that are none of the nodes, where the harmonics are compared with the curve itself."""
_FITS = 1e-11
"""Rounding of a curve that is as its harmonics say; one that is not is off by more."""
_HARMONIC = 1e-9
"""Rounding of a second harmonic that is none."""
_CLOSE = 1e-9
"""Share of the interval: crossings nearer than this are one."""
_STEPS = 1440
"""A quarter of a degree: two crossings that are nearer touch the level, and the end is the same."""
_HALVINGS = 60
"""To the last bit of a float64."""


def along_one(poses: Curve, number: int, place: Array, ends: tuple[float, float], levels: tuple[Array, ...]) -> Array:
    """Return the crossings along one coordinate of a chart.

    poses : (p, size) places -> (p, q); place : (size,) the other coordinates; ends : of this one
    """

    def curve(values: Array) -> Array:
        places = np.tile(place, (len(values), 1))
        places[:, number] = values
        return poses(places)

    return crossings(curve, *ends, levels)


def crossings(curve: Curve, low: float, high: float, levels: tuple[Array, ...]) -> Array:
    """Return where any axis of a curve is at one of its levels, sorted, with the ends.  levels : per axis, m or rad"""
    at, tried = curve(low + _NODES), curve(low + _PROBES)
    found = [np.array([low, high])]
    for k, wanted in enumerate(levels):
        if len(wanted):
            found.append(_of_axis(k, curve, (low, high), (at[:, k], tried[:, k]), wanted))
    everything = np.unique(np.concatenate(found))
    inside = everything[(everything >= low) & (everything <= high)]
    apart = np.diff(inside, prepend=-np.inf) > _CLOSE * max(high - low, 1e-12)
    return inside[apart]


def _of_axis(k: int, curve: Curve, ends: tuple[float, float], seen: tuple[Array, Array], levels: Array) -> Array:
    low, high = ends
    at, tried = seen
    size = max(float(np.ptp(at)), 1.0)
    rise = float(at[-1] - at[0]) / float(_NODES[-1])
    if np.all(np.abs(at - at[0] - rise * _NODES) <= _FITS * size):
        return low + (levels - at[0]) / rise if abs(rise) > _FITS else np.zeros(0)
    waves: Array = np.asarray(np.linalg.solve(_waves(_NODES), at), dtype=np.float64)
    if np.all(np.abs(_waves(_PROBES) @ waves - tried) <= _FITS * size * 10):
        return _folded(np.concatenate([_angles(waves, level) for level in levels]), low, high)
    return _bisected(lambda u: curve(u)[:, k], low, high, levels)


def _waves(angles: Array) -> Array:
    columns = [np.ones_like(angles), np.cos(angles), np.sin(angles), np.cos(2 * angles), np.sin(2 * angles)]
    return np.stack(columns, axis=1)


def _angles(waves: Array, level: float) -> Array:
    """Return the angles at which a₀ + c₁ cos + s₁ sin + c₂ cos 2· + s₂ sin 2· is at a level."""
    mean, c1, s1, c2, s2 = waves
    radius = math.hypot(c1, s1)
    if math.hypot(c2, s2) <= _HARMONIC * max(radius, 1e-6):
        share = (level - mean) / radius if radius > 0 else 2.0
        if abs(share) > 1:
            return np.zeros(0)
        turn, phase = math.acos(share), math.atan2(s1, c1)
        return np.array([phase - turn, phase + turn])
    first, second = complex(c1, -s1) / 2, complex(c2, -s2) / 2
    roots = np.roots([second, first, mean - level, first.conjugate(), second.conjugate()])
    on_circle = roots[np.abs(np.abs(roots) - 1) < 1e-7]
    return np.asarray(np.angle(on_circle), dtype=np.float64)


def _folded(angles: Array, low: float, high: float) -> Array:
    """Return every u in [low, high] with u − low the same as an angle but for whole turns."""
    turns = np.arange(math.ceil((high - low) / (2 * math.pi)) + 1)
    first = low + np.mod(angles, 2 * math.pi)
    folded: Array = (first[:, None] + 2 * math.pi * turns).ravel()
    return folded


def _bisected(value: Callable[[Array], Array], low: float, high: float, levels: Array) -> Array:
    grid = np.linspace(low, high, _STEPS + 1)
    at = value(grid)
    found = []
    for level in levels:
        sign = np.sign(at - level)
        found.append(grid[sign == 0])
        change = np.flatnonzero(sign[1:] * sign[:-1] < 0)
        left, right = grid[change], grid[change + 1]
        begun = sign[change]
        for _ in range(_HALVINGS if len(change) else 0):
            middle = (left + right) / 2
            same = np.sign(value(middle) - level) == begun
            left, right = np.where(same, middle, left), np.where(same, right, middle)
        found.append((left + right) / 2)
    return np.concatenate(found)
