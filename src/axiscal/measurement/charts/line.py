"""A straight line through the workspace: diagonals of ISO 230-6, several linear axes together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.inverse import tip_at
from axiscal.machine.kinematics import frames
from axiscal.measurement.charts.chart import Coordinate
from axiscal.measurement.charts.room import Room
from axiscal.measurement.charts.swing import Swing
from axiscal.measurement.charts.ways import SmoothChart
from axiscal.numerics import Array

_FINEST = 1e-6
"""m: what a person can dial in."""


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Line(SmoothChart):
    """u : how far along, m from the first end.

    ends : (2, 3) m, workpiece frame; park : (q,) of the rotary axes; step : m, 0 continuous
    overrun : m, over which a side is come from
    """

    room: Room
    ends: Array
    park: Array
    step: float
    overrun: float

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return 1

    @property
    def direction(self) -> Array:
        """The unit vector from the first end to the second, (3,)."""
        along: Array = self.ends[1] - self.ends[0]
        return along / np.linalg.norm(along)

    def bounds(self, number: int) -> Coordinate:
        """Return from where to where it goes, m."""
        length = float(np.linalg.norm(self.ends[1] - self.ends[0]))
        return Coordinate(0.0, length, self.step, self.overrun, finest=_FINEST)

    def poses(self, places: Array) -> Array:
        """Return the poses (m, q) with the tool point on the line."""
        points = self.ends[0] + places * self.direction
        return tip_at(self.room.machine, np.tile(self.park, (len(places), 1)), points)

    def feasible(self, poses: Array) -> NDArray[np.bool_]:
        """Return which poses are in travel, with nothing in the way."""
        return self.room.holds(poses)

    def swing(self, start: Array, stop: Array) -> Swing:
        """Return what bounds a straight way: the linear axes go straight."""
        return Swing(np.zeros(len(self.park)), float(np.abs(stop - start)[0]), 0.0, ())

    def places(self, poses: Array) -> Array:
        """Return how far along the line poses are."""
        tips = frames(self.room.machine, poses).tcp
        along: Array = (tips - self.ends[0]) @ self.direction
        return along[:, None]
