"""Ways through a chart: straight in u, or one coordinate after the other, where all of it can be taken.

Both ends and the middle of each piece of a way are looked at. Over two degrees a function f that must not be negative
is a parabola to a micrometre. It is nowhere below min(f₀, f₁) − |f₀ − 2 f½ + f₁|/2, and twice that fall has to fit. The
tool is within half of its way from one of both ends: there it meets by so much sooner what stands in its way. Pieces
that are not free by that are halved; a piece that stays so is not gone.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise, permutations
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.kinematics import frames
from axiscal.measurement.bodies import lever
from axiscal.measurement.charts.room import Chart, Room, within_cone
from axiscal.numerics import Array
from axiscal_core.axes import Frames

_FIRST = np.radians(2.0)
"""Turn of the first pieces."""
_MOST_TRIED = 20_000
"""Pieces of one way: of time. Only a way that grazes a limit for a long time needs more, and it is not gone."""
_LONGER = 1.001
"""Of an arc than its chords; over two degrees it is far less."""
_LIMIT = 1e-9
"""m or rad, by which a way in touch may leave a travel or enter a box."""
_MOST_LEGS = 3
"""Coordinates up to which all orders of going one after the other are tried."""

Margins = Callable[[Array, Frames], Array]
"""Poses (m, q) and their frames -> (m, k), none of which may be negative."""


def free_way(
    room: Room, poses: Callable[[Array], Array], turn: float, limit: float, margins: Margins | None = None
) -> bool:
    """Return whether every place on a way can be taken.

    poses : shares of the way (m,) -> poses (m, q); turn : rad, at the most, over all of it
    limit : by which it may enter what stands there, m, and fall short of margins
    """
    edges, longest = np.linspace(0.0, 1.0, 2 + int(turn / _FIRST)), lever(room.machine)
    left, right, tried = edges[:-1], edges[1:], 0
    while len(left):
        tried += len(left)
        middle, found = (left + right) / 2, np.ones(len(left), dtype=bool)
        at = poses(np.concatenate([left, middle, right]))
        seen = frames(room.machine, at)
        if margins is not None:
            start, amid, stop = over = margins(at, seen).reshape(3, len(left), -1)
            if not np.all(over >= -limit):  # or no numbers
                return False
            found = np.all(np.minimum(start, stop) - np.abs(start - 2 * amid + stop) >= -limit, axis=1)
        if tried > _MOST_TRIED or (room.occupied and room.hit(seen.tcp, seen.stem, -limit).any()):
            return False
        if room.occupied:
            tips, stems = (each.reshape(3, -1, 3) for each in (seen.tcp, seen.stem))
            gone, turned = (np.linalg.norm(np.diff(each, axis=0), axis=2).sum(axis=0) for each in (tips, stems))
            far = _LONGER * (gone + longest * turned) / 2
            met = [room.hit(*each, far - limit) for each in ((tips[0], stems[0]), (tips[2], stems[2]))]
            found &= (far <= limit) | ~np.any(met, axis=0)
        left, right = np.concatenate([[left, middle], [middle, right]], axis=1)[:, np.tile(~found, 2)]
    return True


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
            angles = self.angles(frames(self.room.machine, poses[found]))
            found[found] = np.all([within_cone(*each) for each in angles], axis=0)
        return found

    def between(self, start: Array, stop: Array) -> Array | None:
        """Return a way that holds the tool point on the chart, (k, size), ends included; None where there is none."""
        straight = np.stack([start, stop])
        if clear(self, straight):
            return straight
        turning = np.flatnonzero(start != stop)
        if not 1 < len(turning) <= _MOST_LEGS:
            return None
        for order in permutations(turning.tolist()):
            legs = [start]
            for number in order:
                legs.append(np.where(np.arange(len(start)) == number, stop, legs[-1]))
            if clear(self, np.array(legs)):
                return np.array(legs)
        return None


def bar_angles(at: Frames, centre: Array, free: Array, cone: float) -> tuple[tuple[Array, float], ...]:
    """Return the angles of a bar with the tool, and with where its centre (3,) m is free, as of a chart.

    free : (3,) away from the stem of the centre; cone : rad, of both
    """
    bar = at.tcp - centre
    bar = bar / np.linalg.norm(bar, axis=1)[:, None]
    return (np.sum(at.stem * bar, axis=1), cone), (bar @ free, cone)


def clear(chart: SmoothChart, legs: Array) -> bool:
    """Return whether every place on a way can be taken, to a micrometre.  legs : (k, size)"""
    low, high = np.array([axis.travel for axis in chart.room.machine.axes]).T

    def margins(poses: Array, at: Frames) -> Array:
        angles = [cosines - np.cos(min(cone + _LIMIT, np.pi)) for cosines, cone in chart.angles(at)]
        return np.column_stack([poses - low, high - poses, *angles])

    def gone(start: Array, stop: Array) -> bool:
        turn = float(np.abs(stop - start).sum())
        return free_way(chart.room, lambda s: chart.poses(start + s[:, None] * (stop - start)), turn, _LIMIT, margins)

    return all(gone(*each) for each in pairwise(legs))
