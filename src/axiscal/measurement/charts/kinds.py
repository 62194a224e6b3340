"""Charts of every kind: lines, what a tracker sees, balls, and bars about a centre.

A straight line through the workspace: diagonals of ISO 230-6, several linear axes together. The axes that move, each as
far as it can be read, where a tracker or tracer sees the tool. The tool point held at a ball while the rotary axes
turn: R-test, spheres that are probed, fixed-point tests. A ball bar free in space about a centre, anywhere on a sphere,
with the rotary axes fixed or free, or on a circle.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.kinematics import drawn_back, tip_at
from axiscal.measurement.charts.room import Chart, Coordinate, Room, within_cone
from axiscal.numerics import Array
from axiscal_core.axes import Frames

FINEST_PLACE = 1e-6
"""m: what a person can dial in."""


class SmoothChart(Chart, Protocol):
    """The common part of charts whose tool point follows their coordinates smoothly.  room : what may not be"""

    __slots__ = ()
    room: Room

    def angles(self, at: Frames) -> tuple[tuple[Array, float], ...]:
        """Return the cosines of angles, (m,) each, with the cone within which each stays, rad."""
        return ()

    def feasible(self, poses: Array) -> NDArray[np.bool_]:
        """Return which poses are in travel, with nothing in the way, and every angle within its cone."""
        found = self.room.holds(poses)
        if found.any():
            angles = self.angles(self.room.machine.frames(poses[found]))
            found[found] = np.all([within_cone(*each) for each in angles], axis=0)
        return found


def bar_angles(at: Frames, centre: Array, free: Array, cone: float) -> tuple[tuple[Array, float], ...]:
    """Return the angles of a bar with the tool, and with where its centre (3,) m is free, as of a chart.

    free : (3,) away from the stem of the centre; cone : rad, of both
    """
    bar = at.tcp - centre
    bar = bar / np.linalg.norm(bar, axis=1)[:, None]
    return (np.sum(at.stem * bar, axis=1), cone), (bar @ free, cone)


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Line(SmoothChart):
    """u : how far along, m from the first end.

    ends : (2, 3) m, workpiece frame; park : (q,) of the rotary axes
    """

    room: Room
    ends: Array
    park: Array
    coordinates: tuple[Coordinate]

    @classmethod
    def between_ends(cls, room: Room, ends: Array, park: Array, step: float, overrun: float) -> Line:
        """Return all of a line.  step : m, 0 continuous; overrun : m, over which a side is come from"""
        length = float(np.linalg.norm(ends[1] - ends[0]))
        return cls(room, ends, park, (Coordinate(0.0, length, step, overrun, finest=FINEST_PLACE),))

    def at_its_end(self) -> Line:
        """Return its second end alone."""
        far = self.coordinates[0].high
        return replace(self, coordinates=(Coordinate(far, far, far),))

    @property
    def direction(self) -> Array:
        """The unit vector from the first end to the second, (3,)."""
        along: Array = self.ends[1] - self.ends[0]
        return along / np.linalg.norm(along)

    def poses(self, places: Array) -> Array:
        """Return the poses (m, q) with the tool point on the line."""
        points = self.ends[0] + places * self.direction
        return tip_at(self.room.machine, np.tile(self.park, (len(places), 1)), points)

    def places(self, poses: Array) -> Array:
        """Return how far along the line poses are."""
        tips = self.room.machine.frames(poses).tcp
        along: Array = (tips - self.ends[0]) @ self.direction
        return along[:, None]


_SLACK = 1e-10
"""Share of a travel: rounding."""


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Sight(Chart):
    """u : the axes that move, without what cannot be seen.

    moves : their indices; park : (q,); coordinates : from where to where each can be read
    stations : (k, 3) m, workpiece frame: all of them see the tool
    range : from how near to how far, m
    faces : (3,) where the reflector looks, in the frame of the workpiece; None looks to the station
    cone : rad, half the angle in which it is seen
    """

    room: Room
    moves: tuple[int, ...]
    park: Array
    stations: Array
    range: tuple[float, float]
    faces: Array | None
    cone: float
    coordinates: tuple[Coordinate, ...]

    def poses(self, places: Array) -> Array:
        """Return the poses (m, q)."""
        result = np.tile(self.park, (len(places), 1))
        result[:, list(self.moves)] = places
        return result

    def feasible(self, poses: Array) -> NDArray[np.bool_]:
        """Return which poses are within reach, with nothing in the way, and seen."""
        low, high = np.array([each[:2] for each in self.coordinates]).T
        slack, moved = _SLACK * (high - low), poses[:, list(self.moves)]
        within: NDArray[np.bool_] = np.all((moved >= low - slack) & (moved <= high + slack), axis=1)
        found = within & self.room.holds(poses)
        if found.any():
            tcp = self.room.machine.frames(poses[found]).tcp
            found[found] = np.all([self._seen(station - tcp) for station in self.stations], axis=0)
        return found

    def places(self, poses: Array) -> Array:
        """Return the coordinates of the axes that move."""
        return poses[:, list(self.moves)]

    def _seen(self, towards: Array) -> NDArray[np.bool_]:
        """Return which poses one station sees.  towards : (m, 3) from the tool to it, m"""
        far = np.linalg.norm(towards, axis=1)
        seen: NDArray[np.bool_] = (far >= self.range[0]) & (far <= self.range[1])
        if self.faces is not None:
            seen &= within_cone(towards @ self.faces / np.maximum(far, 1e-12), self.cone)
        return seen


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Held(SmoothChart):
    """u : the rotary axes that turn.

    point : (3,) the ball, m, workpiece frame; free : (3,) where it is free; cone : rad, that the tool keeps within
    turning : indices of the rotary axes; park : (q,); coordinates : (turning,)
    back : m, by which the tool must be able to draw back along itself, from where it comes to the ball
    overrun : (q,) m, by which the axes must be able to go on from there either way, for they come from a side
    touching : poses (m, q) -> where the axes go to touch the ball, (stops, m, q); None where nobody says
    """

    room: Room
    point: Array
    free: Array
    cone: float
    turning: tuple[int, ...]
    park: Array
    coordinates: tuple[Coordinate, ...]
    back: float = 0.0
    overrun: Array | float = 0.0
    touching: Callable[[Array], Array] | None = None

    def poses(self, places: Array) -> Array:
        """Return the poses (m, q) with the tool point at the ball."""
        return self.poses_at(np.broadcast_to(self.point, (len(places), 3)), places)

    def poses_at(self, points: Array, places: Array) -> Array:
        """Return the poses (m, q) with the tool point at balls at points (m, 3) m."""
        turned = np.tile(self.park, (len(places), 1))
        turned[:, list(self.turning)] = places
        return tip_at(self.room.machine, turned, points)

    def angles(self, at: Frames) -> tuple[tuple[Array, float], ...]:
        """Return that of the tool with where the ball is free."""
        return ((at.stem @ self.free, self.cone),)

    def feasible(self, poses: Array) -> NDArray[np.bool_]:
        """Return which poses are in travel, on the free side of the ball, with room to come to it and to touch it."""
        found = SmoothChart.feasible(self, poses)
        if self.back > 0 and found.any():
            drawn = drawn_back(self.room.machine, poses[found], self.back)
            before, behind = (self.room.in_travel(drawn + way) for way in (-self.overrun, self.overrun))
            found[found] = self.room.holds(drawn) & before & behind
        if self.touching is not None and found.any():
            found[found] = np.all([self.room.holds(each) for each in self.touching(poses[found])], axis=0)
        return found

    def places(self, poses: Array) -> Array:
        """Return the rotary coordinates of poses."""
        return poses[:, list(self.turning)]


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Balls(Chart):
    """u : the number of the ball, then the rotary axes that turn.  each : the chart of every ball"""

    each: tuple[Held, ...]

    @property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """The numbers of the balls, and the travel of each rotary axis."""
        return Coordinate(0.0, len(self.each) - 1.0, 1.0), *self.each[0].coordinates

    def poses(self, places: Array) -> Array:
        """Return the poses (m, q) with the tool point at each ball."""
        points = np.array([chart.point for chart in self.each])
        return self.each[0].poses_at(points[self._which(places[:, 0])], places[:, 1:])

    def feasible(self, poses: Array) -> NDArray[np.bool_]:
        """Return which poses can be taken at the ball next to them."""
        found, which = np.zeros(len(poses), dtype=bool), self._nearest(poses)
        for ball, chart in enumerate(self.each):
            found[which == ball] = chart.feasible(poses[which == ball])
        return found

    def places(self, poses: Array) -> Array:
        """Return the nearest ball and the rotary coordinates of poses."""
        return np.column_stack([self._nearest(poses).astype(np.float64), self.each[0].places(poses)])

    def _nearest(self, poses: Array) -> NDArray[np.intp]:
        finite = np.where(np.isfinite(poses), poses, 0.0)
        tips = self.each[0].room.machine.frames(finite).tcp
        apart = np.stack([np.linalg.norm(tips - chart.point, axis=1) for chart in self.each])
        nearest: NDArray[np.intp] = apart.argmin(axis=0)
        return nearest

    def _which(self, numbers: Array) -> NDArray[np.intp]:
        return np.clip(np.rint(numbers), 0, len(self.each) - 1).astype(np.intp)


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

    def angles(self, at: Frames) -> tuple[tuple[Array, float], ...]:
        """Return those of the bar with the tool and with where its centre is free."""
        return bar_angles(at, self.centre, self.free, self.cone)

    def places(self, poses: Array) -> Array:
        """Return azimuth, elevation and rotary coordinates of poses."""
        bar = self.room.machine.frames(poses).tcp - self.centre
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

    def angles(self, at: Frames) -> tuple[tuple[Array, float], ...]:
        """Return those of the bar with the tool and with where its centre is free."""
        return bar_angles(at, self.centre, self.free, self.cone)

    def places(self, poses: Array) -> Array:
        """Return the angles of poses, within the arc as far as whole turns allow."""
        bar = self.room.machine.frames(poses).tcp - self.centre
        angle, (low, high, *_) = np.arctan2(bar @ self.second, bar @ self.first), self.coordinates[0]
        around = low + np.mod(angle - low, math.tau)
        beyond = around - low > math.tau - 1e-9
        folded: Array = np.where(beyond & (around > high + 1e-12), around - math.tau, around)
        return folded[:, None]
