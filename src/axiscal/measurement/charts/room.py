"""What every chart answers, and what may not be: out of travel, against a ball's stem, or in what stands there."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.artefact import Artefact
from axiscal.measurement.bodies import parts, posts
from axiscal.numerics import Array
from axiscal_core.axes import Frames
from axiscal_core.machine import Machine

_OUTSIDE = 1e-9
"""Share of a coordinate: rounding."""
KNOWN = 0.1
"""An axis that moves by less than this share of its overrun on the way in comes from a side that nobody knows."""


class Coordinate(NamedTuple):
    """One coordinate of a chart: from low to high, in multiples of a step; 0 is continuous.

    overrun : over how much of it a side is come from
    endless : high is low again, after a full turn, and one may go on past it
    finest : what can be dialled in, where it is continuous
    """

    low: float
    high: float
    step: float = 0.0
    overrun: float = 0.0
    endless: bool = False
    finest: float = np.radians(1e-4)

    @property
    def values(self) -> Array:
        """All values of a coordinate that has steps; of a full turn both ends, each is come to from its own side."""
        first, last = int(np.ceil(self.low / self.step - 1e-9)), int(np.floor(self.high / self.step + 1e-9))
        if self.endless and abs(last * self.step - first * self.step - (self.high - self.low)) <= 1e-9:
            last -= 1
        return self.step * np.arange(first, last + 1, dtype=np.float64)


_SLACK = 1e-10
"""Share of a travel by which rounding may leave it."""
_ANGLE = 1e-9
"""rad: rounding of an angle."""


@dataclass(frozen=True, eq=False, slots=True)
class Room:
    """Where the machine may stand, in the workpiece frame.

    keep_out : (n, 3, 2) boxes, m, that no part of tool, holder and nose enters
    touched : (k, 3, 2) boxes that all parts keep out of but the first, which touches there
    balls : (j, 4) places and radii of spheres, m, that a stylus goes to, and not into
    """

    machine: Machine
    keep_out: Array
    touched: Array = field(default_factory=lambda: np.zeros((0, 3, 2)))
    balls: Array = field(default_factory=lambda: np.zeros((0, 4)))

    @classmethod
    def empty(cls, machine: Machine) -> Room:
        """Return a room in which nothing stands."""
        return cls.among(machine, None)

    @classmethod
    def among(
        cls, machine: Machine, artefact: Artefact | None, touching: Collection[int] = (), met: bool = True
    ) -> Room:
        """Return the room about an artefact: what it keeps out of, and its balls with their posts.

        touching : the balls that the tool comes to; met : it is at them, not on the way to them
        """
        if artefact is None:
            return cls(machine, np.zeros((0, 3, 2)))
        boxes, each = np.array(artefact.keep_out, dtype=np.float64).reshape(-1, 3, 2), posts(artefact)
        own = [post for ball, post in enumerate(each) if ball in touching]
        others = [post for ball, post in enumerate(each) if ball not in touching]
        at = artefact.points[list(touching)] if own and machine.nose.stylus > 0 and not met else np.zeros((0, 3))
        balls = np.column_stack([at, np.full(len(at), (artefact.diameter or 0.0) / 2)])
        return cls(machine, np.concatenate([boxes, *others]), np.concatenate([np.zeros((0, 3, 2)), *own]), balls)

    @property
    def occupied(self) -> bool:
        """Whether anything stands there."""
        return len(self.keep_out) + len(self.touched) + len(self.balls) > 0

    def in_travel(self, poses: Array) -> NDArray[np.bool_]:
        """Return which poses (m, q) are numbers within the travels."""
        low, high = np.array([axis.travel for axis in self.machine.axes]).T
        slack = _SLACK * (high - low)
        with np.errstate(invalid="ignore"):
            within: NDArray[np.bool_] = np.all((poses >= low - slack) & (poses <= high + slack), axis=1)
        return within

    def holds(self, poses: Array) -> NDArray[np.bool_]:
        """Return at which poses (m, q) nothing is in the way."""
        found = self.in_travel(poses)
        if self.occupied and found.any():
            at = self.machine.frames(poses[found])
            found[found] = ~self.hit(at.tcp, at.stem)
        return found

    def hit(self, tips: Array, stems: Array, nearer: Array | float = 0.0) -> NDArray[np.bool_]:
        """Return where tool, holder or nose, from the tip (m, 3) along the stem, enter what they keep out of, (m,).

        nearer : m, or (m,), by how much what stands there grows, where a place of the tool may move by so much
        """
        hit = np.zeros(len(tips), dtype=bool)
        wider = np.broadcast_to(np.asarray(nearer, dtype=np.float64), (len(tips),))[:, None]
        across = np.sqrt(np.maximum(1.0 - stems**2, 0.0))
        for number, part in enumerate(parts(self.machine)):
            starts, ways = tips + part.start * stems, (part.stop - part.start) * stems
            around = wider + part.radius * across
            boxes = np.concatenate([self.keep_out, self.touched]) if number else self.keep_out
            for low, high in np.swapaxes(boxes, 1, 2):
                hit |= _enters(starts, ways, low - around, high + around)
        touching = parts(self.machine)[0]
        for *place, radius in self.balls.tolist():
            away = np.array(place) - tips
            along = np.clip(np.sum(away * stems, axis=1), touching.start, touching.stop)[:, None]
            hit |= np.linalg.norm(away - along * stems, axis=1) < radius + touching.radius + wider[:, 0]
        return hit


@dataclass(frozen=True, eq=False)
class Chart:
    """Where a set-up can be read: a map from coordinates u (m, size) to poses.

    room : what may not be; park : (q,) where axes stand that do not move; coordinates : ends and steps of each
    """

    room: Room
    park: Array
    coordinates: tuple[Coordinate, ...]

    def poses(self, places: Array) -> Array:
        """Return the poses (m, q) of places u, whether they can be taken or not; NaN where there are none."""
        raise NotImplementedError

    def places(self, poses: Array) -> Array:
        """Return the coordinates of the places nearest to poses (m, q)."""
        raise NotImplementedError

    def free(self, at: Frames) -> NDArray[np.bool_]:
        """Return which places are as free as they have to be; here all."""
        return np.ones(len(at.tcp), dtype=bool)

    def feasible(self, poses: Array) -> NDArray[np.bool_]:
        """Return which poses (m, q) are in travel, with nothing in the way, and free."""
        found = self.room.holds(poses)
        if found.any():
            found[found] = self.free(self.room.machine.frames(poses[found]))
        return found


def starts_of_ways(chart: Chart, places: Array, sides: Array) -> Array:
    """Return where the ways into places begin, an overrun away.  places, sides : (m, size) u and +1, −1, 0"""
    away = np.array([each.overrun for each in chart.coordinates])
    begin: Array = places - sides * away
    return begin


def has_room(chart: Chart, places: Array, sides: Array) -> NDArray[np.bool_]:
    """Return which places can be come to from their sides, over the whole overrun and within the chart, (m,)."""
    begin = starts_of_ways(chart, places, sides)
    at, which = np.unique(places, axis=0, return_inverse=True)  # each from several sides
    found = chart.feasible(chart.poses(begin)) & chart.feasible(chart.poses(at))[which.reshape(-1)]
    for end, at in zip(chart.coordinates, begin.T, strict=True):
        slack = _OUTSIDE * (end.high - end.low)
        found &= end.endless | ((at >= end.low - slack) & (at <= end.high + slack))
    return found


def arrivals(chart: Chart, places: Array, sides: Array) -> Array:
    """Return from where each axis comes, (m, q) +1, −1, or 0 where nobody knows: linear axes from where they follow."""
    way = chart.poses(places) - chart.poses(starts_of_ways(chart, places, sides))
    known = np.abs(way) >= KNOWN * np.array([axis.overrun for axis in chart.room.machine.axes])
    return np.where(known, np.sign(way), 0.0)


def _enters(starts: Array, ways: Array, low: Array, high: Array) -> NDArray[np.bool_]:
    """Return whether straight ways (m, 3) from places (m, 3) enter boxes from low to high (m, 3): by slabs."""
    still = np.abs(ways) < 1e-12
    safe = np.where(still, 1.0, ways)
    into, out = (low - starts) / safe, (high - starts) / safe
    beside = still & ((starts < low) | (starts > high))
    first = np.where(still, 0.0, np.minimum(into, out)).max(axis=1)
    last = np.where(still, 1.0, np.maximum(into, out)).min(axis=1)
    found: NDArray[np.bool_] = ~beside.any(axis=1) & (np.maximum(first, 0.0) < np.minimum(last, 1.0))
    return found


def within_cone(cosines: Array, cone: float) -> NDArray[np.bool_]:
    """Return which angles are no larger than a cone, rad.  cosines : (m,)"""
    inside: NDArray[np.bool_] = np.arccos(np.clip(cosines, -1.0, 1.0)) <= cone + _ANGLE
    return inside
