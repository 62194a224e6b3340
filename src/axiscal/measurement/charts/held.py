"""The tool point held at a ball while the rotary axes turn: R-test, spheres that are probed, fixed-point tests."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.inverse import drawn_back, tip_at
from axiscal.machine.kinematics import frames
from axiscal.measurement.charts.chart import Coordinate
from axiscal.measurement.charts.crossings import along_one
from axiscal.measurement.charts.room import Room, within_cone
from axiscal.measurement.charts.swing import Swing, stem_to
from axiscal.measurement.charts.ways import way
from axiscal.numerics import Array


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Held:
    """u : the rotary axes that turn.

    point : (3,) the ball, m, workpiece frame; free : (3,) where it is free; cone : rad, that the tool keeps within
    turning : indices of the rotary axes; park : (q,); steps : (turning,) rad, 0 continuous
    back : m, by which the tool must be able to draw back along itself, from where it comes to the ball
    """

    room: Room
    point: Array
    free: Array
    cone: float
    turning: tuple[int, ...]
    park: Array
    steps: tuple[float, ...]
    back: float = 0.0

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return len(self.turning)

    def bounds(self, number: int) -> Coordinate:
        """Return the travel of a rotary axis."""
        axis = self.room.machine.axes[self.turning[number]]
        return Coordinate(*axis.travel, self.steps[number], axis.overrun, axis.cyclic)

    def poses(self, places: Array) -> Array:
        """Return the poses (m, q) with the tool point at the ball."""
        turned = np.tile(self.park, (len(places), 1))
        turned[:, list(self.turning)] = places
        return tip_at(self.room.machine, turned, np.broadcast_to(self.point, (len(places), 3)))

    def breaks(self, number: int, place: Array, levels: tuple[Array, ...]) -> Array:
        """Return where an axis is at one of its levels while one of the rotary axes turns."""
        low, high, *_ = self.bounds(number)
        return along_one(self.poses, number, place, (low, high), levels)

    def feasible(self, poses: Array) -> NDArray[np.bool_]:
        """Return which poses are in travel, with the tool on the free side of the ball and nothing in the way."""
        found = self.room.holds(poses)
        if found.any():
            found[found] = within_cone(frames(self.room.machine, poses[found]).stem, self.free, self.cone)
        if self.back > 0 and found.any():
            found[found] = self.room.holds(drawn_back(self.room.machine, poses[found], self.back))
        return found

    def between(self, start: Array, stop: Array) -> Array | None:
        """Return a way with the tool point held."""
        return way(self, self.room, start, stop)

    def swing(self, start: Array, stop: Array) -> Swing:
        """Return what bounds a straight way: the tool point stands."""
        turns = np.zeros(len(self.park))
        turns[list(self.turning)] = np.abs(stop - start)
        return Swing(turns, 0.0, 0.0, (stem_to(self.room.machine, turns, self.free, self.cone),))

    def places(self, poses: Array) -> Array:
        """Return the rotary coordinates of poses."""
        turned: Array = poses[:, list(self.turning)]
        return turned
