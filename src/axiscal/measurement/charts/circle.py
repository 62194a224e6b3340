"""A ball bar in a plane about a centre (ISO 230-4), and with a rotary axis that turns in step (ISO 10791-6 K tests)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.inverse import tip_at
from axiscal.machine.kinematics import frames
from axiscal.measurement.charts.chart import Coordinate
from axiscal.measurement.charts.crossings import crossings
from axiscal.measurement.charts.room import Room
from axiscal.measurement.charts.swing import Swing, bar_angles
from axiscal.measurement.charts.ways import way
from axiscal.numerics import Array


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Circle:
    """u : the angle of the bar in its plane, rad.

    centre : (3,) m, workpiece frame; first, second : (3,) unit vectors that span the plane; length : m
    free, cone : as of a ball, and the same between the bar and the tool; arc : from where to where, rad
    park : (q,) of the rotary axes at the angle 0; turning : (q,) rad of each per rad of arc; step : rad, 0 continuous
    """

    room: Room
    centre: Array
    first: Array
    second: Array
    length: float
    free: Array
    cone: float
    arc: tuple[float, float]
    park: Array
    turning: Array
    step: float
    overrun: float

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return 1

    def bounds(self, number: int) -> Coordinate:
        """Return the arc."""
        low, high = self.arc
        whole = abs(high - low - math.tau) <= 1e-9 and not np.any(self.turning)
        return Coordinate(low, high, self.step, self.overrun / self.length, whole, whole)

    def directions(self, places: Array) -> Array:
        """Return the unit vectors (m, 3) from the centre to the tool point."""
        pointing: Array = np.cos(places[:, :1]) * self.first + np.sin(places[:, :1]) * self.second
        return pointing

    def poses(self, places: Array) -> Array:
        """Return the poses (m, q) with the tool point on the circle."""
        points = self.centre + self.length * self.directions(places)
        return tip_at(self.room.machine, self.park + places * self.turning, points)

    def breaks(self, number: int, place: Array, levels: tuple[Array, ...]) -> Array:
        """Return where an axis is at one of its levels."""
        return crossings(lambda values: self.poses(values[:, None]), *self.arc, levels)

    def feasible(self, poses: Array) -> NDArray[np.bool_]:
        """Return which poses are in travel, with the bar clear of the tool and of the stem of its centre."""
        return self.room.holds_bar(poses, self.centre, self.free, self.cone)

    def between(self, start: Array, stop: Array) -> Array | None:
        """Return the way along the circle."""
        return way(self, self.room, start, stop)

    def swing(self, start: Array, stop: Array) -> Swing:
        """Return what bounds a way along the circle."""
        far = float(np.abs(stop - start)[0])
        turns = np.abs(self.turning) * far
        angles = bar_angles(self.room.machine, turns, self.centre, self.free, self.cone, far)
        return Swing(turns, self.length * far, self.length * far**2, angles)

    def places(self, poses: Array) -> Array:
        """Return the angles of poses, within the arc as far as whole turns allow."""
        bar = frames(self.room.machine, poses).tcp - self.centre
        angle = np.arctan2(bar @ self.second, bar @ self.first)
        around = self.arc[0] + np.mod(angle - self.arc[0], math.tau)
        beyond = around - self.arc[0] > math.tau - 1e-9
        folded: Array = np.where(beyond & (around > self.arc[1] + 1e-12), around - math.tau, around)
        return folded[:, None]
