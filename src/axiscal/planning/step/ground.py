"""What a set-up may change between readings: the axes that it moves, or the coordinates of its chart.

Boxes say where it can be read, over each of which what it sees is one polynomial, to rounding.

A coordinate is an axis that moves, or one of a chart. Rows are polynomials between knots and edges of visited cells.
Along an axis that turns, and along a chart, sines take part: a polynomial of a higher degree follows them to rounding
over pieces that are short enough. On a chart knots of the axes lie on curves. So one coordinate of it may be free; the
others need steps, and each of their values has pieces of its own.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.candidates import (
    arrivals_of,
    breaks_along,
    chart_sides,
    raster_positions,
    turned_to,
)
from axiscal.measurement.charts.room import KNOWN, Chart, has_room, starts_of_ways
from axiscal.measurement.observation import Observation
from axiscal.measurement.travel import sides_of
from axiscal.numerics import Array

_LOOKS = np.array([1, 3, 5]) / 6
"""Shares of each stretch between breaks that are looked at."""
_EVEN = 73
"""Places along a coordinate of a chart that are looked at: every five degrees of a turn."""
_LOOKED_AT = 721
"""Places along a coordinate at which it is looked whether they can be taken: every half degree of a turn."""
_HALVINGS = 60
"""To the last bit of a float64."""
_SAME = 1e-11
"""m or rad, of an axis that stands at a knot: rounding does not pass it."""
_WITHIN = 1e-10
"""Share of a coordinate by which an edge is kept off: a pose there is in travel as written, and computed anew."""
_SHORTEST = 1e-9
"""Share of a coordinate: a piece that is shorter holds nothing that its neighbours do not."""


@dataclass(frozen=True, eq=False)
class Ground:
    """Coordinates u of readings of a set-up, here the axes that move, and the sides +1, −1 from which these come."""

    observation: Observation
    setup: int

    @cached_property
    def _moves(self) -> list[int]:
        return list(self.observation.setups[self.setup].moves)

    @cached_property
    def ends(self) -> Array:
        """From where to where each coordinate goes, (size, 2)."""
        mounted, machine = self.observation.setups[self.setup], self.observation.machine
        return np.array([mounted.span(machine.axes[axis], axis) for axis in mounted.moves])

    @cached_property
    def spans(self) -> Array:
        """The travel of every axis of the machine, (q,)."""
        return np.array([axis.length for axis in self.observation.machine.axes])

    @cached_property
    def continuous(self) -> list[int]:
        """The coordinates without steps."""
        raster = self.observation.setups[self.setup].raster
        return [number for number, axis in enumerate(self._moves) if not raster[axis] > 0]

    @cached_property
    def choices(self) -> Array:
        """The sides from which places are come to and that differ in what is read, (choices, size)."""
        return np.array(sides(self.observation, self.setup))[:, self._moves]

    @cached_property
    def sided(self) -> NDArray[np.intp]:
        """The coordinates that may be come to from either side, where it shows in what is read from which."""
        return np.flatnonzero(np.ptp(self.choices, axis=0) > 0)

    def as_places(self, poses: Array, approaches: Array) -> tuple[Array, Array]:
        """Return places and sides, (m, size) each.  poses, approaches : (m, q)"""
        return poses[:, self._moves], approaches[:, self._moves]

    def approachable(self, places: Array, sides: Array) -> NDArray[np.bool_] | None:
        """Return which places can be come to from their sides, (m,); None where that is all of them."""
        return None

    def as_poses(self, places: Array, sides: Array) -> tuple[Array, Array]:
        """Return poses and approaches, (m, q) each."""
        poses = np.tile(np.array(self.observation.setups[self.setup].park), (len(places), 1))
        approaches = np.zeros_like(poses)
        poses[:, self._moves], approaches[:, self._moves] = places, sides
        return poses, approaches

    def looks(self, number: int) -> Array:
        """Return a few values all along a coordinate, or all that it has, (p,)."""
        axis = self._moves[number]
        mounted = self.observation.setups[self.setup]
        if mounted.raster[axis] > 0:
            return raster_positions(self.observation.machine, mounted, axis)
        breaks = breaks_along(self.observation, axis, self.setup)
        inside: Array = breaks[:-1, None] + np.diff(breaks)[:, None] * _LOOKS
        return inside.ravel()

    def pieces(self, number: int, place: Array, sides: Array) -> Array:
        """Return the pieces of a coordinate that can be taken and are smooth, (b, 2).  place, sides : (size,)"""
        breaks = breaks_along(self.observation, self._moves[number], self.setup)
        return np.stack([breaks[:-1], breaks[1:]], axis=1)


@dataclass(frozen=True, eq=False)
class _OnChart(Ground):
    """The same on a chart; what lies outside the travels, or has no room to come from its side, is not taken."""

    chart: Chart

    @cached_property
    def ends(self) -> Array:
        return np.array([each[:2] for each in self.chart.coordinates])

    @cached_property
    def continuous(self) -> list[int]:
        return [number for number, each in enumerate(self.chart.coordinates) if each.step == 0]

    @cached_property
    def choices(self) -> Array:
        return chart_sides(self.observation.machine, self.observation.setups[self.setup], self.chart)

    def as_places(self, poses: Array, approaches: Array) -> tuple[Array, Array]:
        places = self.chart.places(poses)
        come = turned_to(self.observation.machine, self.observation.setups[self.setup], approaches)
        found = sides_of(self.chart, places, come)
        return places, np.where(found == 0, 1.0, found)

    def approachable(self, places: Array, sides: Array) -> NDArray[np.bool_]:
        return has_room(self.chart, places, sides)

    def as_poses(self, places: Array, sides: Array) -> tuple[Array, Array]:
        mounted = self.observation.setups[self.setup]
        return self.chart.poses(places), arrivals_of(self.observation.machine, mounted, self.chart, places, sides)

    def looks(self, number: int) -> Array:
        end = self.chart.coordinates[number]
        return end.values if end.step > 0 else np.linspace(end.low, end.high, _EVEN)

    def pieces(self, number: int, place: Array, sides: Array) -> Array:
        """Return the pieces; of a place its own value of the coordinate does not matter.

        Between their ends no axis passes a knot, comes from another side, or is where it cannot be.
        """
        chart, machine = self.chart, self.observation.machine
        low, high, *_ = chart.coordinates[number]
        knots = [breaks_along(self.observation, k, self.setup) for k in range(len(machine.axes))]
        least = KNOWN * np.array([axis.overrun for axis in machine.axes])

        def taken(values: Array) -> NDArray[np.bool_]:
            return has_room(chart, places_along(place, number, values), np.tile(sides, (len(values), 1)))

        def beyond(values: Array) -> NDArray[np.bool_]:
            places = places_along(place, number, values)
            poses = chart.poses(places)
            way = poses - chart.poses(starts_of_ways(chart, places, np.tile(sides, (len(values), 1))))
            passed = [poses[:, [k]] > each + _SAME for k, each in enumerate(knots)]
            return np.hstack([*passed, way > least, way > -least])

        grid = np.linspace(low, high, _LOOKED_AT)
        if not taken(grid).any():
            return np.zeros((0, 2))
        left, right = changes(lambda values: taken(values)[:, None], grid).T
        off = np.where(taken(left), -1.0, 1.0) * _WITHIN * (high - low)
        edges = np.where(off < 0, left, right) + off
        outer = grid[taken(grid)][[0, -1]]
        everything = np.unique(np.concatenate([outer, edges, changes(beyond, grid).mean(axis=1)]))
        left, right = everything[:-1], everything[1:]
        kept = taken((left + right) / 2) & (right - left > _SHORTEST * (high - low))
        return np.stack([left[kept], right[kept]], axis=1)


def changes(states: Callable[[Array], NDArray[np.bool_]], grid: Array) -> Array:
    """Return between which values, to the last bits, a state changes, (n, 2).

    states : values (p,) -> (p, s); grid : (g,) values that are looked at, of which changes back and forth lie apart
    """
    seen = states(grid)
    where, which = np.nonzero(seen[1:] != seen[:-1])
    left, right, before, every = grid[where], grid[where + 1], seen[where, which], np.arange(len(where))
    for _ in range(_HALVINGS if len(where) else 0):
        middle = (left + right) / 2
        same = states(middle)[every, which] == before
        left, right = np.where(same, middle, left), np.where(same, right, middle)
    return np.stack([left, right], axis=1)


def ground_of(observation: Observation, setup: int) -> Ground:
    """Return what a set-up may change."""
    chart = observation.setups[setup].chart
    return Ground(observation, setup) if chart is None else _OnChart(observation, setup, chart)


def sides(observation: Observation, setup: int) -> list[Array]:
    """Return the approaches (q,) of the axes of a set-up that differ in what a reading sees."""
    mounted = observation.setups[setup]
    usual = np.zeros(len(mounted.park))
    usual[list(mounted.moves)] = mounted.sides[0]
    reverses = observation.errors.reversing & set(mounted.moves)
    if len(mounted.sides) == 1 or not reverses:
        return [usual]
    flipped = []
    for signs in itertools.product([1.0, -1.0], repeat=len(reverses)):
        approach = usual.copy()
        approach[sorted(reverses)] = signs
        flipped.append(approach)
    return flipped


def places_along(place: Array, number: int, values: Array) -> Array:
    """Return the place (size,) with other values (p,) of one coordinate, (p, size)."""
    places = np.tile(place, (len(values), 1))
    places[:, number] = values
    return places
