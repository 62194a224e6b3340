"""The axes that move, each as far as it can be read, and where a tracker or tracer sees the tool.

A straight line through the workspace: diagonals of ISO 230-6, several linear axes together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.kinematics import frames, tip_at
from axiscal.measurement.charts.room import Coordinate, Room, crossings, within_cone
from axiscal.measurement.charts.swing import Swing
from axiscal.measurement.charts.ways import SmoothChart
from axiscal.numerics import Array

FINEST_PLACE = 1e-6
"""m: what a person can dial in."""


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

    @property
    def direction(self) -> Array:
        """The unit vector from the first end to the second, (3,)."""
        along: Array = self.ends[1] - self.ends[0]
        return along / np.linalg.norm(along)

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


_SLACK = 1e-10
"""Share of a travel: rounding."""


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Sight:
    """u : the axes that move, without what cannot be seen; on a way where a beam is lost it is found again.

    moves : their indices; coordinates : from where to where each can be read; park : (q,)
    stations : (k, 3) m, workpiece frame: all of them see the tool
    range : from how near to how far, m
    faces : (3,) where the reflector looks, in the frame of the workpiece; None looks to the station
    cone : rad, half the angle in which it is seen
    """

    room: Room
    moves: tuple[int, ...]
    coordinates: tuple[Coordinate, ...]
    park: Array
    stations: Array
    range: tuple[float, float]
    faces: Array | None
    cone: float

    def poses(self, places: Array) -> Array:
        """Return the poses (m, q)."""
        result = np.tile(self.park, (len(places), 1))
        result[:, list(self.moves)] = places
        return result

    def breaks(self, number: int, place: Array, levels: tuple[Array, ...]) -> Array:
        """Return where the axis is at one of its levels."""
        low, high, *_ = self.coordinates[number]

        def curve(values: Array) -> Array:
            return np.repeat(values[:, None], len(self.park), axis=1)

        own = tuple(level if k == self.moves[number] else level[:0] for k, level in enumerate(levels))
        return crossings(curve, low, high, own)

    def feasible(self, poses: Array) -> NDArray[np.bool_]:
        """Return which poses are within reach, with nothing in the way, and seen."""
        low, high = np.array([each[:2] for each in self.coordinates]).T
        slack, moved = _SLACK * (high - low), poses[:, list(self.moves)]
        within: NDArray[np.bool_] = np.all((moved >= low - slack) & (moved <= high + slack), axis=1)
        found = within & self.room.holds(poses)
        if found.any():
            tcp = frames(self.room.machine, poses[found]).tcp
            found[found] = np.all([self._seen(station - tcp) for station in self.stations], axis=0)
        return found

    def between(self, start: Array, stop: Array) -> Array | None:
        """Return the straight way: a box of axes holds all of it."""
        return np.stack([start, stop])

    def places(self, poses: Array) -> Array:
        """Return the coordinates of the axes that move."""
        return poses[:, list(self.moves)]

    def _seen(self, towards: Array) -> NDArray[np.bool_]:
        """Return which poses one station sees.  towards : (m, 3) from the tool to it, m"""
        far = np.linalg.norm(towards, axis=1)
        seen: NDArray[np.bool_] = (far >= self.range[0]) & (far <= self.range[1])
        if self.faces is not None:
            seen &= within_cone(towards / np.maximum(far, 1e-12)[:, None], self.faces, self.cone)
        return seen
