"""A ball bar free in space about a centre: anywhere on a sphere, with the rotary axes fixed or free."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.inverse import tip_at
from axiscal.machine.kinematics import frames
from axiscal.measurement.charts.chart import Coordinate
from axiscal.measurement.charts.crossings import along_one
from axiscal.measurement.charts.room import Room
from axiscal.measurement.charts.swing import Swing, bar_angles
from axiscal.measurement.charts.ways import way
from axiscal.numerics import Array


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Bar:
    """u : azimuth about z from x, elevation above the xy plane, rad; then the rotary axes that turn.

    centre : (3,) m, workpiece frame; length : m; free, cone : as of a ball, and the same between bar and tool
    turning : indices of rotary axes; park : (q,); steps : (size,) rad, 0 continuous
    """

    room: Room
    centre: Array
    length: float
    free: Array
    cone: float
    turning: tuple[int, ...]
    park: Array
    steps: tuple[float, ...]
    overrun: float

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return 2 + len(self.turning)

    def bounds(self, number: int) -> Coordinate:
        """Return a full turn, from pole to pole, or the travel of a rotary axis."""
        if number == 0:
            return Coordinate(0.0, math.tau, self.steps[0], self.overrun / self.length, True, True)
        if number == 1:
            return Coordinate(-math.pi / 2, math.pi / 2, self.steps[1], self.overrun / self.length)
        axis = self.room.machine.axes[self.turning[number - 2]]
        return Coordinate(*axis.travel, self.steps[number], axis.overrun, axis.cyclic)

    def poses(self, places: Array) -> Array:
        """Return the poses (m, q) with the tool point on the sphere."""
        azimuth, elevation = places[:, 0], places[:, 1]
        flat = np.cos(elevation)
        bar = np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)], axis=1)
        turned = np.tile(self.park, (len(places), 1))
        turned[:, list(self.turning)] = places[:, 2:]
        return tip_at(self.room.machine, turned, self.centre + self.length * bar)

    def breaks(self, number: int, place: Array, levels: tuple[Array, ...]) -> Array:
        """Return where an axis is at one of its levels along one coordinate."""
        low, high, *_ = self.bounds(number)
        return along_one(self.poses, number, place, (low, high), levels)

    def feasible(self, poses: Array) -> NDArray[np.bool_]:
        """Return which poses are in travel, with the bar clear of the tool and of the stem of its centre."""
        return self.room.holds_bar(poses, self.centre, self.free, self.cone)

    def between(self, start: Array, stop: Array) -> Array | None:
        """Return a way on the sphere."""
        return way(self, self.room, start, stop)

    def swing(self, start: Array, stop: Array) -> Swing:
        """Return what bounds a way even in azimuth, elevation and rotary axes: n(φ, θ) turns by |φ'| + |θ'| at most."""
        turns, far = np.zeros(len(self.park)), np.abs(stop - start)
        turns[list(self.turning)] = far[2:]
        rate = float(far[0] + far[1])
        angles = bar_angles(self.room.machine, turns, self.centre, self.free, self.cone, rate)
        return Swing(turns, self.length * rate, self.length * rate**2, angles)

    def places(self, poses: Array) -> Array:
        """Return azimuth, elevation and rotary coordinates of poses."""
        bar = frames(self.room.machine, poses).tcp - self.centre
        azimuth = np.mod(np.arctan2(bar[:, 1], bar[:, 0]), math.tau)
        elevation = np.arctan2(bar[:, 2], np.hypot(bar[:, 0], bar[:, 1]))
        return np.column_stack([azimuth, elevation, poses[:, list(self.turning)]])
