"""What trackers and tracers see from their stations: within their range, and within the cone of the reflector."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.kinematics import frames
from axiscal.measurement.charts.box import Box
from axiscal.measurement.charts.chart import Coordinate
from axiscal.measurement.charts.room import within_cone
from axiscal.numerics import Array


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Sight:
    """u : the axes that move.

    box : without what cannot be seen; stations : (k, 3) m, workpiece frame: all of them see the tool
    range : from how near to how far, m
    faces : (3,) where the reflector looks, in the frame of the workpiece; None looks to the station
    cone : rad, half the angle in which it is seen
    """

    box: Box
    stations: Array
    range: tuple[float, float]
    faces: Array | None
    cone: float

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return self.box.size

    def bounds(self, number: int) -> Coordinate:
        """Return from where to where an axis can be read."""
        return self.box.bounds(number)

    def poses(self, places: Array) -> Array:
        """Return the poses (m, q)."""
        return self.box.poses(places)

    def breaks(self, number: int, place: Array, levels: tuple[Array, ...]) -> Array:
        """Return where the axis is at one of its levels."""
        return self.box.breaks(number, place, levels)

    def feasible(self, poses: Array) -> NDArray[np.bool_]:
        """Return which poses are seen."""
        found = self.box.feasible(poses)
        if found.any():
            tcp = frames(self.box.room.machine, poses[found]).tcp
            found[found] = np.all([self._seen(station - tcp) for station in self.stations], axis=0)
        return found

    def _seen(self, towards: Array) -> NDArray[np.bool_]:
        """Return which poses one station sees.  towards : (m, 3) from the tool to it, m"""
        far = np.linalg.norm(towards, axis=1)
        seen: NDArray[np.bool_] = (far >= self.range[0]) & (far <= self.range[1])
        if self.faces is not None:
            seen &= within_cone(towards / np.maximum(far, 1e-12)[:, None], self.faces, self.cone)
        return seen

    def between(self, start: Array, stop: Array) -> Array | None:
        """Return the straight way: where a beam is lost on it, it is found again."""
        return self.box.between(start, stop)

    def places(self, poses: Array) -> Array:
        """Return the coordinates of the axes that move."""
        return self.box.places(poses)
