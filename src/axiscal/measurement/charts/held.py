"""The tool point held at a ball while the rotary axes turn: R-test, spheres that are probed, fixed-point tests."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.kinematics import drawn_back, frames, tip_at
from axiscal.measurement.charts.room import Coordinate, Room, within_cone
from axiscal.measurement.charts.swing import Swing, stem_to
from axiscal.measurement.charts.ways import SmoothChart
from axiscal.numerics import Array


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

    def feasible(self, poses: Array) -> NDArray[np.bool_]:
        """Return which poses are in travel, on the free side of the ball, with room to come to it and to touch it."""
        machine, found = self.room.machine, self.room.holds(poses)
        if found.any():
            found[found] = within_cone(frames(machine, poses[found]).stem, self.free, self.cone)
        if self.back > 0 and found.any():
            drawn = drawn_back(machine, poses[found], self.back)
            found[found] = self.room.holds(drawn) & self._all_in_travel([drawn - self.overrun, drawn + self.overrun])
        if self.touching is not None and found.any():
            found[found] = self._all_in_travel(self.touching(poses[found]))
        return found

    def _all_in_travel(self, poses: Iterable[Array]) -> NDArray[np.bool_]:
        within: NDArray[np.bool_] = np.all([self.room.in_travel(each) for each in poses], axis=0)
        return within

    def swing(self, start: Array, stop: Array) -> Swing:
        """Return what bounds a straight way: the tool point stands."""
        turns = np.zeros(len(self.park))
        turns[list(self.turning)] = np.abs(stop - start)
        return Swing(turns, 0.0, 0.0, (stem_to(self.room.machine, turns, self.free, self.cone),))

    def places(self, poses: Array) -> Array:
        """Return the rotary coordinates of poses."""
        return poses[:, list(self.turning)]


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Balls:
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

    def breaks(self, number: int, place: Array, levels: tuple[Array, ...]) -> Array:
        """Return where an axis is at one of its levels while a rotary axis turns at one ball."""
        if number == 0:
            return np.arange(len(self.each), dtype=np.float64)
        return self.each[int(self._which(place[:1])[0])].breaks(number - 1, place[1:], levels)

    def feasible(self, poses: Array) -> NDArray[np.bool_]:
        """Return which poses can be taken at the ball next to them."""
        found, which = np.zeros(len(poses), dtype=bool), self._nearest(poses)
        for ball, chart in enumerate(self.each):
            found[which == ball] = chart.feasible(poses[which == ball])
        return found

    def between(self, start: Array, stop: Array) -> Array | None:
        """Return a way at one ball; None from ball to ball."""
        if start[0] != stop[0]:
            return None
        legs = self.each[int(self._which(start[:1])[0])].between(start[1:], stop[1:])
        return None if legs is None else np.column_stack([np.full(len(legs), start[0]), legs])

    def places(self, poses: Array) -> Array:
        """Return the nearest ball and the rotary coordinates of poses."""
        return np.column_stack([self._nearest(poses).astype(np.float64), self.each[0].places(poses)])

    def _nearest(self, poses: Array) -> NDArray[np.intp]:
        finite = np.where(np.isfinite(poses), poses, 0.0)
        tips = frames(self.each[0].room.machine, finite).tcp
        apart = np.stack([np.linalg.norm(tips - chart.point, axis=1) for chart in self.each])
        nearest: NDArray[np.intp] = apart.argmin(axis=0)
        return nearest

    def _which(self, numbers: Array) -> NDArray[np.intp]:
        return np.clip(np.rint(numbers), 0, len(self.each) - 1).astype(np.intp)
