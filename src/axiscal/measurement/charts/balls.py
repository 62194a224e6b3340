"""Several balls, one after another: a ball plate, or three spheres on the table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.kinematics import frames
from axiscal.measurement.charts.chart import Coordinate
from axiscal.measurement.charts.held import Held
from axiscal.numerics import Array


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Balls:
    """u : the number of the ball, then the rotary axes that turn.  each : the chart of every ball"""

    each: tuple[Held, ...]

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return 1 + self.each[0].size

    def bounds(self, number: int) -> Coordinate:
        """Return the numbers of the balls, or the travel of a rotary axis."""
        return Coordinate(0.0, len(self.each) - 1.0, 1.0) if number == 0 else self.each[0].bounds(number - 1)

    def poses(self, places: Array) -> Array:
        """Return the poses (m, q) with the tool point at each ball."""
        result = np.empty((len(places), len(self.each[0].park)))
        which = self._which(places[:, 0])
        for ball, chart in enumerate(self.each):
            result[which == ball] = chart.poses(places[which == ball, 1:])
        return result

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
