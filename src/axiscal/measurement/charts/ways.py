"""Ways through a chart: straight in u, or one coordinate after the other, where all of it can be taken.

Whether every place on a way through a chart can be taken: proven, not looked at.

A function with |f''| ≤ M is, between two places h apart, nowhere below min(f₀, f₁) − M h²/8. There the tool is at most
half of its fastest way from one of the two. Pieces that these bounds do not prove are halved; a piece that stays
unproven is not gone.
"""

from __future__ import annotations

from itertools import pairwise, permutations
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.kinematics import Frames, frames, linear_axes
from axiscal.measurement.charts.room import Chart, Room, along_one
from axiscal.measurement.charts.swing import Slides, Swing, stem_rate
from axiscal.numerics import Array

_LIMIT = 1e-9
"""m or rad: a nanometre, by which a way may leave a travel or enter a box."""
_FIRST = np.radians(20.0)
"""Turn of the first pieces; any size does, for pieces that are too long are halved."""
_MOST_TRIED = 20_000
"""Pieces of one way: of time. Only a way that grazes a limit for a long time needs more, and it is not gone."""

_MOST_LEGS = 3
"""Coordinates up to which all orders of going one after the other are tried."""


class SmoothChart(Chart, Protocol):
    """The common part of charts whose tool point follows their coordinates smoothly.  room : what may not be"""

    __slots__ = ()
    room: Room

    def swing(self, start: Array, stop: Array) -> Swing:
        """Return what bounds a straight way from place to place."""

    def breaks(self, number: int, place: Array, levels: tuple[Array, ...]) -> Array:
        """Return where an axis is at one of its levels along one coordinate."""
        low, high, *_ = self.coordinates[number]
        return along_one(self.poses, number, place, (low, high), levels)

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


def clear(chart: SmoothChart, legs: Array) -> bool:
    """Return whether every place on a way can be taken, to a nanometre.  legs : (k, size)"""
    return all(_clear(chart, start, stop) for start, stop in pairwise(legs))


def _clear(chart: SmoothChart, start: Array, stop: Array) -> bool:
    proof = _Proof(chart.room, chart.swing(start, stop))
    edges = np.linspace(0.0, 1.0, 2 + int(proof.swing.turns.sum() / _FIRST))
    left, right, tried = edges[:-1], edges[1:], 0
    while len(left):
        tried += len(left)
        ends = np.concatenate([left, right])
        poses = chart.poses(start + ends[:, None] * (stop - start))
        if tried > _MOST_TRIED or not np.all(chart.feasible(poses)):
            return False
        open_ = ~proof.of_pieces(poses, right - left)
        middle = (left[open_] + right[open_]) / 2
        left, right = np.concatenate([left[open_], middle]), np.concatenate([middle, right[open_]])
    return True


class _Proof:
    """Says of which pieces of a way everything is proven."""

    def __init__(self, room: Room, swing: Swing) -> None:
        self.swing, self._room, machine = swing, room, room.machine
        self._slides, self._follow = Slides(machine, swing), list(linear_axes(machine))
        self._low, self._high = np.array([axis.travel for axis in machine.axes]).T
        self._fastest = swing.speed + machine.tool * stem_rate(machine, swing.turns)

    def of_pieces(self, poses: Array, widths: Array) -> NDArray[np.bool_]:
        """Return it of pieces, (m,).  poses : (2 m, q) of their beginnings, then of their ends; widths : (m,) of s"""
        at, count = frames(self._room.machine, poses), len(widths)
        begin = Frames(at.rotations[:, :count], at.origins[:, :count], at.tcp[:count], at.tool[:count])
        sunk = self._slides.bends(begin, widths) * widths**2 / 8
        room = np.minimum(poses - self._low, self._high - poses)[:, self._follow].min(axis=1)
        found = _lesser(room) - sunk >= -_LIMIT
        for angle in self.swing.angles:
            least = np.cos(min(angle.cone + _LIMIT, np.pi))
            found &= _lesser(angle.cosines(at.stem, at.tcp)) - angle.bend * widths**2 / 8 >= least
        if len(self._room.keep_out) and found.any():
            nearer = np.tile(self._fastest * widths / 2 - _LIMIT, 2)
            hit = self._room.hit(at.tcp, at.stem, nearer)
            found &= ~(hit[:count] | hit[count:])
        return np.asarray(found, dtype=np.bool_)


def _lesser(values: Array) -> Array:
    """Return the lesser one of both ends of each piece.  values : (2 m,)"""
    lesser: Array = values.reshape(2, -1).min(axis=0)
    return lesser
