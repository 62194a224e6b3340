"""Charts of every kind: lines, what a tracker sees, balls, and bars about a centre.

A straight line through the workspace: diagonals of ISO 230-6, several linear axes together. The axes that move, each as
far as it can be read, where a tracker or tracer sees the tool. The tool point held at a ball while the rotary axes
turn: R-test, spheres that are probed, fixed-point tests. A ball bar free in space about a centre, anywhere on a sphere,
with the rotary axes fixed or free, or on a circle.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.kinematics import drawn_back, tip_at
from axiscal.measurement.charts.room import Chart, Coordinate, Room, within_cone
from axiscal.numerics import Array
from axiscal_core.axes import Frames

FINEST_PLACE = 1e-6
"""m: what a person can dial in."""


class TipChart(Chart):
    """A chart whose coordinates say where the tool point is, then how some rotary axes stand, by their indices."""

    turning: tuple[int, ...] = ()

    def points(self, places: Array) -> Array:
        """Return where the tool point is, (m, 3) m, workpiece frame."""
        raise NotImplementedError

    def poses(self, places: Array) -> Array:
        """Return the poses (m, q) with the tool point there."""
        return tip_at(self.room.machine, self.turned(places), self.points(places))

    def turned(self, places: Array) -> Array:
        """Return poses (m, q) whose linear axes stand anywhere."""
        turned = np.tile(self.park, (len(places), 1))
        turned[:, list(self.turning)] = places[:, places.shape[1] - len(self.turning) :]
        return turned


@dataclass(frozen=True, eq=False)
class Line(TipChart):
    """u : how far along, m from the first end.  ends : (2, 3) m, workpiece frame"""

    ends: Array

    @classmethod
    def between_ends(cls, room: Room, ends: Array, park: Array, step: float, overrun: float) -> Line:
        """Return all of a line.  step : m, 0 continuous; overrun : m, over which a side is come from"""
        length = float(np.linalg.norm(ends[1] - ends[0]))
        return cls(room, park, (Coordinate(0.0, length, step, overrun, finest=FINEST_PLACE),), ends)

    def at_its_end(self) -> Line:
        """Return its second end alone."""
        far = self.coordinates[0].high
        return replace(self, coordinates=(Coordinate(far, far, far),))

    @property
    def direction(self) -> Array:
        """The unit vector from the first end to the second, (3,)."""
        along: Array = self.ends[1] - self.ends[0]
        return along / np.linalg.norm(along)

    def points(self, places: Array) -> Array:
        """Return the points on the line."""
        return np.asarray(self.ends[0] + places * self.direction)

    def places(self, poses: Array) -> Array:
        """Return how far along the line poses are."""
        along: Array = (self.room.machine.frames(poses).tcp - self.ends[0]) @ self.direction
        return along[:, None]


_SLACK = 1e-10
"""Share of a travel: rounding."""


@dataclass(frozen=True, eq=False)
class Sight(Chart):
    """u : the axes that move, without what cannot be seen.

    moves : their indices; stations : (k, 3) m, workpiece frame: all of them see the tool
    range : from how near to how far, m
    faces : (3,) where the reflector looks, in the frame of the workpiece; None looks to the station
    cone : rad, half the angle in which it is seen
    """

    moves: tuple[int, ...]
    stations: Array
    range: tuple[float, float]
    faces: Array | None
    cone: float

    def poses(self, places: Array) -> Array:
        """Return the poses (m, q)."""
        result = np.tile(self.park, (len(places), 1))
        result[:, list(self.moves)] = places
        return result

    def places(self, poses: Array) -> Array:
        """Return the coordinates of the axes that move."""
        return poses[:, list(self.moves)]

    def feasible(self, poses: Array) -> NDArray[np.bool_]:
        """Return which poses are within reach, with nothing in the way, and seen."""
        low, high = np.array([each[:2] for each in self.coordinates]).T
        slack, moved = _SLACK * (high - low), self.places(poses)
        within: NDArray[np.bool_] = np.all((moved >= low - slack) & (moved <= high + slack), axis=1)
        return within & super().feasible(poses)

    def free(self, at: Frames) -> NDArray[np.bool_]:
        """Return at which places all stations see the tool."""
        found = np.ones(len(at.tcp), dtype=bool)
        for towards in (station - at.tcp for station in self.stations):
            far = np.linalg.norm(towards, axis=1)
            found &= (far >= self.range[0]) & (far <= self.range[1])
            if self.faces is not None:
                found &= within_cone(towards @ self.faces / np.maximum(far, 1e-12), self.cone)
        return found


@dataclass(frozen=True, eq=False)
class Balls(TipChart):
    """u : the number of the ball, where there are several or nothing turns; then the rotary axes that turn.

    spots : (n, 3) the balls, m, workpiece frame; rooms : about each of them
    away : (3,) where balls are free; cone : rad, that the tool keeps within; turning : indices of the rotary axes
    back : m, by which the tool must be able to draw back along itself, from where it comes to the ball
    overrun : (q,) m, by which the axes must be able to go on from there either way, for they come from a side
    touching : poses (m, q) -> where the axes go to touch the ball, (stops, m, q); None where nobody says
    """

    spots: Array
    rooms: tuple[Room, ...]
    away: Array
    cone: float
    turning: tuple[int, ...]
    back: float = 0.0
    overrun: Array | float = 0.0
    touching: Callable[[Array], Array] | None = None

    @property
    def numbered(self) -> bool:
        """Whether the number of the ball is a coordinate."""
        return len(self.coordinates) > len(self.turning)

    def each(self) -> list[Balls]:
        """Return the chart of every ball alone."""
        turns, pairs = self.coordinates[self.numbered :], zip(self.spots, self.rooms, strict=True)
        return [replace(self, room=at, rooms=(at,), spots=spot[None], coordinates=turns) for spot, at in pairs]

    def points(self, places: Array) -> Array:
        """Return the balls."""
        numbers = np.rint(places[:, 0]) if self.numbered else np.zeros(len(places))
        return np.asarray(self.spots[np.clip(numbers, 0, len(self.spots) - 1).astype(np.intp)])

    def places(self, poses: Array) -> Array:
        """Return the nearest ball and the rotary coordinates of poses."""
        turned = poses[:, list(self.turning)]
        return np.column_stack([self._nearest(poses).astype(np.float64), turned]) if self.numbered else turned

    def feasible(self, poses: Array) -> NDArray[np.bool_]:
        """Return which poses are on the free side of the ball next to them, with room to come to it and to touch it."""
        found, which = np.zeros(len(poses), dtype=bool), self._nearest(poses)
        for ball, room in enumerate(self.rooms):
            found[which == ball] = self._reached(room, poses[which == ball])
        return found

    def _reached(self, room: Room, poses: Array) -> NDArray[np.bool_]:
        found = room.holds(poses)
        if found.any():
            found[found] = within_cone(room.machine.frames(poses[found]).stem @ self.away, self.cone)
        if self.back > 0 and found.any():
            drawn = drawn_back(room.machine, poses[found], self.back)
            before, behind = (room.in_travel(drawn + way) for way in (-self.overrun, self.overrun))
            found[found] = room.holds(drawn) & before & behind
        if self.touching is not None and found.any():
            found[found] = np.all([room.holds(each) for each in self.touching(poses[found])], axis=0)
        return found

    def _nearest(self, poses: Array) -> NDArray[np.intp]:
        if len(self.spots) == 1:
            return np.zeros(len(poses), dtype=np.intp)
        tips = self.room.machine.frames(np.where(np.isfinite(poses), poses, 0.0)).tcp
        nearest: NDArray[np.intp] = np.linalg.norm(tips - self.spots[:, None], axis=2).argmin(axis=0)
        return nearest


@dataclass(frozen=True, eq=False)
class Bar(TipChart):
    """u : azimuth about z from x, elevation above the xy plane, rad; then the rotary axes that turn.

    centre : (3,) m, workpiece frame; length : m; turning : indices of rotary axes
    away : (3,) where the centre is free, against its stem; cone : rad, of the bar with that, and with the tool
    """

    centre: Array
    length: float
    away: Array
    cone: float
    turning: tuple[int, ...] = ()

    def directions(self, places: Array) -> Array:
        """Return the unit vectors (m, 3) from the centre to the tool point."""
        azimuth, elevation = places[:, 0], places[:, 1]
        flat = np.cos(elevation)
        return np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)], axis=1)

    def points(self, places: Array) -> Array:
        """Return the points at the bar's length from its centre."""
        return self.centre + self.length * self.directions(places)

    def free(self, at: Frames) -> NDArray[np.bool_]:
        """Return where the bar keeps clear of the tool, and of what bears its centre."""
        bar = at.tcp - self.centre
        bar = bar / np.linalg.norm(bar, axis=1)[:, None]
        return within_cone(np.sum(at.stem * bar, axis=1), self.cone) & within_cone(bar @ self.away, self.cone)

    def places(self, poses: Array) -> Array:
        """Return azimuth, elevation and rotary coordinates of poses."""
        bar = self.room.machine.frames(poses).tcp - self.centre
        azimuth = np.mod(np.arctan2(bar[:, 1], bar[:, 0]), math.tau)
        elevation = np.arctan2(bar[:, 2], np.hypot(bar[:, 0], bar[:, 1]))
        return np.column_stack([azimuth, elevation, poses[:, list(self.turning)]])


@dataclass(frozen=True, eq=False)
class Circle(Bar):
    """u : the angle of the bar in its plane, rad.

    plane : (2, 3) unit vectors that span it; rates : (q,) rad of each rotary axis per rad of arc; park : at angle 0
    """

    plane: Array = field(kw_only=True)
    rates: Array = field(kw_only=True)

    def over(self, low: float, high: float) -> Circle:
        """Return it over another arc, rad; a full turn on which no axis turns has no end."""
        whole = abs(high - low - math.tau) <= 1e-9 and not np.any(self.rates)
        return replace(self, coordinates=(self.coordinates[0]._replace(low=low, high=high, endless=whole),))

    def directions(self, places: Array) -> Array:
        """Return the unit vectors (m, 3) from the centre to the tool point."""
        return np.asarray(np.cos(places) * self.plane[0] + np.sin(places) * self.plane[1])

    def turned(self, places: Array) -> Array:
        """Return poses (m, q) whose linear axes stand anywhere."""
        return self.park + places * self.rates

    def places(self, poses: Array) -> Array:
        """Return the angles of poses, within the arc as far as whole turns allow."""
        first, second = self.plane @ (self.room.machine.frames(poses).tcp - self.centre).T
        angle, (low, high, *_) = np.arctan2(second, first), self.coordinates[0]
        around = low + np.mod(angle - low, math.tau)
        beyond = around - low > math.tau - 1e-9
        folded: Array = np.where(beyond & (around > high + 1e-12), around - math.tau, around)
        return folded[:, None]
