"""One coordinate of a chart, cut where readings along it stop being smooth or cannot be taken."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.breaks import breaks_along
from axiscal.measurement.charts.arrivals import KNOWN, begun, has_room
from axiscal.measurement.charts.chart import Chart
from axiscal.measurement.charts.crossings import crossings
from axiscal.measurement.observation import Observation
from axiscal.numerics import Array

_LOOKED_AT = 721
"""Places along a coordinate at which it is looked whether they can be taken: every half degree of a turn."""
_PARTS, _ROUNDS = 32, 10
"""An edge is looked for in so many parts at once, so often: to the last bits of a float64."""
_WITHIN = 1e-10
"""Share of a coordinate by which an edge is kept off: a pose there is in travel as written, and computed anew."""
_SHORTEST = 1e-9
"""Share of a coordinate: a piece that is shorter holds nothing that its neighbours do not."""


def places_along(place: Array, number: int, values: Array) -> Array:
    """Return the place (size,) with other values (p,) of one coordinate, (p, size)."""
    places = np.tile(place, (len(values), 1))
    places[:, number] = values
    return places


def pieces(observation: Observation, setup: int, chart: Chart, number: int, place: Array, sides: Array) -> Array:
    """Return the pieces of one coordinate that can be taken and along which rows are smooth, (b, 2) ends.

    place : (size,) u, its own value of the coordinate does not matter; sides : (size,) from which they are come to
    """
    low, high, *_ = chart.bounds(number)
    grid = np.linspace(low, high, _LOOKED_AT)
    taken = _taken(chart, number, place, sides, grid)
    if not taken.any():
        return np.zeros((0, 2))
    knots = tuple(breaks_along(observation, k, setup) for k in range(len(observation.machine.axes)))
    ends = np.concatenate([grid[taken][[0, -1]], _edges(chart, number, place, sides, (grid, taken))])
    turns = _turns_of_sides(observation, chart, number, place, sides)
    everything = np.unique(np.concatenate([ends, chart.breaks(number, place, knots), turns]))
    left, right = everything[:-1], everything[1:]
    inside = _taken(chart, number, place, sides, (left + right) / 2)
    kept = inside & (right - left > _SHORTEST * (high - low))
    return np.stack([left[kept], right[kept]], axis=1)


def _taken(chart: Chart, number: int, place: Array, sides: Array, values: Array) -> NDArray[np.bool_]:
    places = places_along(place, number, values)
    return has_room(chart, places, np.tile(sides, (len(values), 1)))


def _edges(chart: Chart, number: int, place: Array, sides: Array, seen: tuple[Array, NDArray[np.bool_]]) -> Array:
    """Return the last places that can be taken before those that cannot, to a little more than rounding."""
    grid, taken = seen
    change = np.flatnonzero(taken[1:] != taken[:-1])
    inside = np.where(taken[change], grid[change], grid[change + 1])
    outside = np.where(taken[change], grid[change + 1], grid[change])
    every = np.arange(len(change))
    for _ in range(_ROUNDS if len(change) else 0):
        parts = inside[:, None] + (outside - inside)[:, None] * np.linspace(0.0, 1.0, _PARTS + 1)
        good = _taken(chart, number, place, sides, parts[:, 1:-1].ravel()).reshape(len(change), -1)
        last = np.where(good.all(axis=1), _PARTS - 1, good.argmin(axis=1))
        inside, outside = parts[every, last], parts[every, last + 1]
    return np.asarray(inside + np.sign(inside - outside) * _WITHIN * (grid[-1] - grid[0]), dtype=np.float64)


def _turns_of_sides(observation: Observation, chart: Chart, number: int, place: Array, sides: Array) -> Array:
    """Return where it changes from which side an axis comes that follows, or whether anybody knows."""
    low, high, *_ = chart.bounds(number)
    least = KNOWN * np.array([axis.overrun for axis in observation.machine.axes])

    def way(values: Array) -> Array:
        places = places_along(place, number, values)
        return chart.poses(places) - chart.poses(begun(chart, places, np.tile(sides, (len(values), 1))))

    return crossings(way, low, high, tuple(np.array([-each, each]) for each in least))
