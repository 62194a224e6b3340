"""The questions that every chart answers, and the code that charts share."""

from __future__ import annotations

from itertools import product
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array

_SLACK = 1e-9
"""Share of a coordinate: rounding."""
KNOWN = 0.1
"""An axis that moves by less than this share of its overrun on the way in comes from a side that nobody knows."""


class Coordinate(NamedTuple):
    """One coordinate of a chart: from low to high, in multiples of a step; 0 is continuous.

    overrun : over how much of it a side is come from
    endless : high is low again, after a full turn, and one may go on past it
    finest : what can be dialled in, where it is continuous
    """

    low: float
    high: float
    step: float = 0.0
    overrun: float = 0.0
    endless: bool = False
    finest: float = np.radians(1e-4)

    @property
    def values(self) -> Array:
        """All values of a coordinate that has steps; of a full turn both ends, each is come to from its own side."""
        first, last = int(np.ceil(self.low / self.step - 1e-9)), int(np.floor(self.high / self.step + 1e-9))
        if self.endless and abs(last * self.step - first * self.step - (self.high - self.low)) <= 1e-9:
            last -= 1
        return self.step * np.arange(first, last + 1, dtype=np.float64)


class Chart(Protocol):
    """Where a set-up can be read: a map from coordinates u to poses."""

    @property
    def size(self) -> int:
        """Number of coordinates."""

    def bounds(self, number: int) -> Coordinate:
        """Return one coordinate's ends and steps."""

    def poses(self, places: Array) -> Array:
        """Return the poses (m, q) of places u (m, size), whether they can be taken or not; NaN where there are none."""

    def breaks(self, number: int, place: Array, levels: tuple[Array, ...]) -> Array:
        """Return where along one coordinate an axis that follows is at one of its levels, sorted, ends included.

        place : (size,) the other coordinates; levels : per axis in chain order, m or rad
        """

    def feasible(self, poses: Array) -> NDArray[np.bool_]:
        """Return which poses (m, q) can be taken."""

    def between(self, start: Array, stop: Array) -> Array | None:
        """Return the places (k, size) that a way goes over straight, its ends included; None where there is none."""

    def places(self, poses: Array) -> Array:
        """Return the coordinates (m, size) of the places nearest to poses (m, q)."""


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
