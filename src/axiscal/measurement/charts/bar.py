"""A ball bar free in space about a centre: anywhere on a sphere, with the rotary axes fixed or free."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.kinematics import frames, tip_at
from axiscal.measurement.charts.room import Coordinate, Room
from axiscal.measurement.charts.swing import Swing, bar_angles
from axiscal.measurement.charts.ways import SmoothChart
from axiscal.numerics import Array


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Bar(SmoothChart):
    """u : azimuth about z from x, elevation above the xy plane, rad; then the rotary axes that turn.

    centre : (3,) m, workpiece frame; length : m; free, cone : as of a ball, and the same between bar and tool
    turning : indices of rotary axes; park : (q,)
    """

    room: Room
    centre: Array
    length: float
    free: Array
    cone: float
    turning: tuple[int, ...]
    park: Array
    coordinates: tuple[Coordinate, ...]

    def poses(self, places: Array) -> Array:
        """Return the poses (m, q) with the tool point on the sphere."""
        azimuth, elevation = places[:, 0], places[:, 1]
        flat = np.cos(elevation)
        bar = np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)], axis=1)
        turned = np.tile(self.park, (len(places), 1))
        turned[:, list(self.turning)] = places[:, 2:]
        return tip_at(self.room.machine, turned, self.centre + self.length * bar)

    def feasible(self, poses: Array) -> NDArray[np.bool_]:
        """Return which poses are in travel, with the bar clear of the tool and of the stem of its centre."""
        return self.room.holds_bar(poses, self.centre, self.free, self.cone)

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


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Circle(SmoothChart):
    """u : the angle of the bar in its plane, rad.

    centre : (3,) m, workpiece frame; first, second : (3,) unit vectors that span the plane; length : m
    free, cone : as of a ball, and the same between the bar and the tool
    park : (q,) of the rotary axes at the angle 0; turning : (q,) rad of each per rad of arc; coordinates : the arc
    """

    room: Room
    centre: Array
    first: Array
    second: Array
    length: float
    free: Array
    cone: float
    park: Array
    turning: Array
    coordinates: tuple[Coordinate]

    def over(self, low: float, high: float) -> Circle:
        """Return it over another arc, rad; a full turn on which no axis turns has no end."""
        whole = abs(high - low - math.tau) <= 1e-9 and not np.any(self.turning)
        return replace(self, coordinates=(self.coordinates[0]._replace(low=low, high=high, endless=whole),))

    def directions(self, places: Array) -> Array:
        """Return the unit vectors (m, 3) from the centre to the tool point."""
        return np.cos(places[:, :1]) * self.first + np.sin(places[:, :1]) * self.second

    def poses(self, places: Array) -> Array:
        """Return the poses (m, q) with the tool point on the circle."""
        points = self.centre + self.length * self.directions(places)
        return tip_at(self.room.machine, self.park + places * self.turning, points)

    def feasible(self, poses: Array) -> NDArray[np.bool_]:
        """Return which poses are in travel, with the bar clear of the tool and of the stem of its centre."""
        return self.room.holds_bar(poses, self.centre, self.free, self.cone)

    def swing(self, start: Array, stop: Array) -> Swing:
        """Return what bounds a way along the circle."""
        far = float(np.abs(stop - start)[0])
        turns = np.abs(self.turning) * far
        angles = bar_angles(self.room.machine, turns, self.centre, self.free, self.cone, far)
        return Swing(turns, self.length * far, self.length * far**2, angles)

    def places(self, poses: Array) -> Array:
        """Return the angles of poses, within the arc as far as whole turns allow."""
        bar = frames(self.room.machine, poses).tcp - self.centre
        angle, (low, high, *_) = np.arctan2(bar @ self.second, bar @ self.first), self.coordinates[0]
        around = low + np.mod(angle - low, math.tau)
        beyond = around - low > math.tau - 1e-9
        folded: Array = np.where(beyond & (around > high + 1e-12), around - math.tau, around)
        return folded[:, None]
