"""Whether every place on a way through a chart can be taken."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from axiscal.measurement.charts.chart import Chart
from axiscal.measurement.charts.room import Room
from axiscal.numerics import Array

_FINE = np.radians(0.25)
"""A way is looked at every quarter of a degree, as fine as what stands in it is described."""
_LIMIT = 1e-9
"""m or rad, by which rounding and what lies between samples may leave a travel."""


def clear(chart: Chart, room: Room, legs: Array) -> bool:
    """Return whether every place on a way can be taken.  legs : (k, size)"""
    for start, stop in pairwise(legs):
        poses = chart.poses(along(start, stop))
        if not np.all(chart.feasible(poses)) or not _stays(room, poses):
            return False
    return True


def along(start: Array, stop: Array) -> Array:
    """Return places close to each other on the straight way between two, (p, size)."""
    count = 3 + int(np.max(np.abs(stop - start)) / _FINE)
    return start + np.linspace(0.0, 1.0, count)[:, None] * (stop - start)


def _stays(room: Room, poses: Array) -> bool:
    """Whether the axes stay within their travels between samples as well, by parabolas through three of them."""
    low, high = np.array([axis.travel for axis in room.machine.axes]).T
    before, here, after = poses[:-2], poses[1:-1], poses[2:]
    slope, bend = (after - before) / 2, after - 2 * here + before
    turned = np.divide(-slope, bend, out=np.zeros_like(slope), where=np.abs(bend) > 0)
    peak = here + np.where(np.abs(turned) <= 1, slope * turned + bend * turned**2 / 2, 0.0)
    return bool(np.all((peak >= low - _LIMIT) & (peak <= high + _LIMIT)))
