"""What a set-up may change between readings: the axes that it moves, or the coordinates of its chart."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.candidates import breaks_along, chart_sides
from axiscal.measurement.charts.room import Chart, arrivals, has_room
from axiscal.measurement.observation import Observation
from axiscal.measurement.travel import sides_of
from axiscal.numerics import Array

_LOOKS = np.array([1, 3, 5]) / 6
"""Shares of each stretch between breaks that are looked at."""
_EVEN = 73
"""Places along a coordinate of a chart that are looked at: every five degrees of a turn."""


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
        return np.array([each[:2] for each in self.observation.setups[self.setup].coordinates])

    @cached_property
    def spans(self) -> Array:
        """The travel of every axis of the machine, (q,)."""
        return np.array([axis.length for axis in self.observation.machine.axes])

    @cached_property
    def continuous(self) -> list[int]:
        """The coordinates without steps."""
        coordinates = self.observation.setups[self.setup].coordinates
        return [number for number, each in enumerate(coordinates) if each.step == 0]

    @cached_property
    def sided(self) -> NDArray[np.intp]:
        """The coordinates that may be come to from either side, where it shows in what is read from which."""
        both = len(self.observation.setups[self.setup].sides) > 1
        reversing = self.observation.errors.reversing
        return np.flatnonzero([both and axis in reversing for axis in self._moves])

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
        end = self.observation.setups[self.setup].coordinates[number]
        if end.step > 0:
            return end.values
        breaks = breaks_along(self.observation, self._moves[number], self.setup)
        inside: Array = breaks[:-1, None] + np.diff(breaks)[:, None] * _LOOKS
        return inside.ravel()


@dataclass(frozen=True, eq=False)
class _OnChart(Ground):
    """The same on a chart; what lies outside the travels, or has no room to come from its side, is not taken."""

    chart: Chart

    @cached_property
    def sided(self) -> NDArray[np.intp]:
        sides = chart_sides(self.observation.machine, self.observation.setups[self.setup], self.chart)
        return np.flatnonzero(np.ptp(sides, axis=0) > 0)

    def as_places(self, poses: Array, approaches: Array) -> tuple[Array, Array]:
        places = self.chart.places(poses)
        found = sides_of(self.chart, places, self.observation.setups[self.setup].coming(approaches))
        return places, np.where(found == 0, 1.0, found)

    def approachable(self, places: Array, sides: Array) -> NDArray[np.bool_]:
        return has_room(self.chart, places, sides)

    def as_poses(self, places: Array, sides: Array) -> tuple[Array, Array]:
        coming = self.observation.setups[self.setup].coming(arrivals(self.chart, places, sides))
        return self.chart.poses(places), coming

    def looks(self, number: int) -> Array:
        end = self.chart.coordinates[number]
        return end.values if end.step > 0 else np.linspace(end.low, end.high, _EVEN)


def ground_of(observation: Observation, setup: int) -> Ground:
    """Return what a set-up may change."""
    chart = observation.setups[setup].chart
    return Ground(observation, setup) if chart is None else _OnChart(observation, setup, chart)
