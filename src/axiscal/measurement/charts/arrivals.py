"""From which sides the axes come to places of a chart that is come to from chosen sides of its coordinates."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.charts.chart import Chart
from axiscal.numerics import Array

_SLACK = 1e-9
"""Share of a coordinate: rounding."""
KNOWN = 0.1
"""An axis that moves by less than this share of its overrun on the way in comes from a side that nobody knows."""


def begun(chart: Chart, places: Array, sides: Array) -> Array:
    """Return where the ways into places begin, an overrun away.  places, sides : (m, size) u and +1, −1, 0"""
    away = np.array([chart.bounds(number).overrun for number in range(chart.size)])
    begin: Array = places - sides * away
    return begin


def has_room(chart: Chart, places: Array, sides: Array) -> NDArray[np.bool_]:
    """Return which places can be come to from their sides, over the whole overrun and within the chart, (m,)."""
    begin = begun(chart, places, sides)
    found = chart.feasible(chart.poses(begin)) & chart.feasible(chart.poses(places))
    for number in range(chart.size):
        end, at = chart.bounds(number), begin[:, number]
        slack = _SLACK * (end.high - end.low)
        found &= end.endless | ((at >= end.low - slack) & (at <= end.high + slack))
    return found


def arrivals(chart: Chart, overruns: Array, places: Array, sides: Array) -> Array:
    """Return from where each axis comes, (m, q) +1, −1, or 0 where nobody knows.  overruns : (q,) of the axes"""
    way = chart.poses(places) - chart.poses(begun(chart, places, sides))
    known = np.abs(way) >= KNOWN * overruns
    return np.where(known, np.sign(way), 0.0)


def side_choices(allowed: str, size: int, count: NDArray[np.bool_]) -> Array:
    """Return the sides that places may be come to from, (choices, size).

    allowed : "both", "+", "-"; count : of which coordinates the side counts; the others come from above
    """
    if allowed != "both":
        return np.full((1, size), 1.0 if allowed == "+" else -1.0)
    each = [(1.0, -1.0) if counts else (1.0,) for counts in count]
    return np.array(list(product(*each)))
