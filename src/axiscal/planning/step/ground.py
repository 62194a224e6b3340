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
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.exceptions import PlanError
from axiscal.language.spoken import later
from axiscal.measurement.candidates import (
    arrivals_of,
    breaks_along,
    chart_sides,
    raster_positions,
    smoothness_along,
    turned_to,
)
from axiscal.measurement.charts.room import KNOWN, Chart, has_room, starts_of_ways
from axiscal.measurement.instrument import values_of
from axiscal.measurement.observation import Observation
from axiscal.measurement.travel import sides_of
from axiscal.numerics import Array
from axiscal.numerics.bernstein import misfit, patches
from axiscal_core.roots import node_count

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


_AXES, _ON_CHART = 3, 1
"""Axes that move together, and coordinates of a chart without steps, up to which boxes are cut till a gap is closed."""
_PLACES = 5_000_000
"""Places from which polynomials are found: of time."""
_CUTS, _DEGREE = 72, 12
"""Pieces of a chart's coordinate are no longer than a part of it, 5 deg of a turn; rows have four harmonics at most,
and cubics: their squares are polynomials of this degree to rounding."""
_EXACT = 1e-8
"""Rounding of a polynomial of degree 18, with room; a wrong degree is off by thousandths."""
_COMPARED = 16
"""Boxes at which it is compared with the rows; what is no polynomial shows in almost all."""
_REMEDY = later("Leave --prove out, then the bound holds for the candidates")


class Region(NamedTuple):
    """Boxes of places that are come to from the same sides.

    low, high : (b, size) u, the same where a coordinate has steps; sides : (size,)
    degree : (size,) of the square of what a reading sees, along each coordinate
    """

    ground: Ground
    sides: Array
    low: Array
    high: Array
    degree: tuple[int, ...]

    def as_poses(self, places: Array) -> tuple[Array, Array]:
        """Return poses and approaches, (m, q) each.  places : (m, size) u"""
        return self.ground.as_poses(places, np.tile(self.sides, (len(places), 1)))

    def rows(self, places: Array) -> Array:
        """Return the rows of all numbers of readings at places (m, size), (m, k, n)."""
        return self.ground.observation.numbers(self.ground.setup, *self.as_poses(places)).rows


def regions(observation: Observation, setup: int) -> list[Region]:
    """Return the boxes of a set-up, for all sides that differ in what is seen.

    Raises PlanError where they are too many, or what is seen is no polynomial in them.
    """
    mounted, ground = observation.setups[setup], ground_of(observation, setup)
    charted, most = mounted.chart is not None, _AXES if mounted.chart is None else _ON_CHART
    free = ground.continuous if charted else list(range(len(ground.ends)))
    if len(free) > most:
        what = 'no proof for readings anywhere: "{setup}" has {count} coordinates without steps, more than {most}'
        raise PlanError(what, _REMEDY, setup=mounted.name, count=len(free), most=most)
    degree = tuple(_degree(observation, setup, k) if k in free else 0 for k in range(len(ground.ends)))
    found = [Region(ground, sides, *_boxes(ground, sides, free, charted), degree) for sides in ground.choices]
    found = [region for region in found if len(region.low)]
    if sum(len(region.low) for region in found) * np.prod(np.array(degree) + 1.0) > _PLACES:
        what = 'no proof for readings anywhere: "{setup}" has too many knots along its axes together'
        raise PlanError(what, _REMEDY, setup=mounted.name)
    if not all(map(_follows, found)):
        what = 'no proof for readings anywhere: what "{setup}" sees is no polynomial of where it is'
        raise PlanError(what, _REMEDY, setup=mounted.name)
    return found


def _degree(observation: Observation, setup: int, number: int) -> int:
    mounted = observation.setups[setup]
    if mounted.chart is not None:
        return _DEGREE
    (degree, phase), times = smoothness_along(observation, mounted.moves[number], setup), values_of(mounted)
    return node_count(degree // times, phase / times) - 1


def _boxes(ground: Ground, sides: Array, free: list[int], charted: bool) -> tuple[Array, Array]:
    """Return the ends of boxes that can be taken, (b, size) each."""
    size, cut = len(ground.ends), np.diff(ground.ends).ravel() / _CUTS
    values = [ground.ends[k, :1] if k in free else ground.looks(k) for k in range(size)]
    low, high = [np.zeros((0, size))], [np.zeros((0, size))]
    for place in map(np.array, product(*values)):
        each = [ground.pieces(k, place, sides) if k in free else place[[[k, k]]] for k in range(size)]
        if charted:
            each = [_parts(ends, cut[k]) if k in free else ends for k, ends in enumerate(each)]
        if not free and not np.all(ground.approachable(place[None], sides[None])):
            continue
        for into, end in ((low, 0), (high, 1)):
            grids = np.meshgrid(*(ends[:, end] for ends in each), indexing="ij")
            into.append(np.stack([grid.ravel() for grid in grids], axis=1))
    return np.concatenate(low), np.concatenate(high)


def _parts(pieces: Array, longest: float) -> Array:
    """Return pieces (b, 2) cut into even parts no longer than this."""
    counts = [1 + int(np.ceil((right - left) / longest)) for left, right in pieces]
    cut = [np.linspace(float(left), float(right), n) for (left, right), n in zip(pieces, counts, strict=True)]
    return np.array([part for at in cut for part in pairwise(at)]).reshape(-1, 2)


def _follows(region: Region) -> bool:
    """Return whether polynomials are the squares of what readings see."""

    def lengths(places: Array) -> Array:
        return np.asarray(np.sum(region.rows(places) ** 2, axis=(1, 2)))

    few = np.unique(np.linspace(0, len(region.low) - 1, _COMPARED).astype(np.intp))
    return misfit(lengths, patches(lengths, region.low[few], region.high[few], region.degree)) < _EXACT
