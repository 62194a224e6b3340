"""The least-squares centre of readings around a turn: r(θ) = r₀ + a cos θ + b sin θ + e(θ)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from axiscal.numerics import Array


class Centred(NamedTuple):
    """radius : r₀; centre : (a, b); left : (m,) e, all m"""

    radius: float
    centre: tuple[float, float]
    left: Array


def centred(angles: Array, deviations: Array) -> Centred:
    """Return deviations (m,) of a radius without what the place of the centre does, by least squares.

    angles : (m,) rad, on at least half a turn or the centre is not told from the radius
    """
    columns = np.column_stack([np.ones_like(angles), np.cos(angles), np.sin(angles)])
    radius, a, b = np.linalg.lstsq(columns, deviations, rcond=None)[0].tolist()
    return Centred(radius, (a, b), deviations - columns @ np.array([radius, a, b]))


def covers_a_turn(angles: Array) -> bool:
    """Whether no gap between neighbouring angles is as large as a quarter of a turn."""
    around = np.sort(np.mod(angles, 2 * np.pi))
    gaps = np.diff(around, append=around[:1] + 2 * np.pi)
    return bool(len(around) >= _FEWEST and gaps.max() < np.pi / 2)


_FEWEST = 8
"""Angles that tell a centre from a lobed circle of two or three lobes."""
