"""Whether every place on a way through a chart can be taken: proven, not looked at.

Between two places h apart on a way a function with |f''| ≤ M is nowhere below min(f₀, f₁) − M h²/8, and the tool is
nowhere further than half of its fastest way from where it is at one of them. Pieces for which that does not do are
halved; what is not proven at last is not gone.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.inverse import linear_axes
from axiscal.machine.kinematics import Frames, frames
from axiscal.measurement.charts.room import Room
from axiscal.measurement.charts.swing import Slides, Swing, Swinging, stem_rate
from axiscal.numerics import Array

_LIMIT = 1e-9
"""m or rad: a nanometre, by which a way may leave a travel or enter a box."""
_FIRST = np.radians(20.0)
"""Turn of the first pieces; any size does, for pieces that are too long are halved."""
_MOST = 20_000
"""Pieces of one way: of time. Only a way that grazes a limit for a long time needs more, and it is not gone."""


def clear(chart: Swinging, room: Room, legs: Array) -> bool:
    """Return whether every place on a way can be taken, to a nanometre.  legs : (k, size)"""
    return all(_clear(chart, room, start, stop) for start, stop in pairwise(legs))


def _clear(chart: Swinging, room: Room, start: Array, stop: Array) -> bool:
    proof = _Proof(room, chart.swing(start, stop))
    edges = np.linspace(0.0, 1.0, 2 + int(proof.swing.turns.sum() / _FIRST))
    left, right, tried = edges[:-1], edges[1:], 0
    while len(left):
        tried += len(left)
        ends = np.concatenate([left, right])
        poses = chart.poses(start + ends[:, None] * (stop - start))
        if tried > _MOST or not np.all(chart.feasible(poses)):
            return False
        open_ = ~proof.of(poses, right - left)
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

    def of(self, poses: Array, widths: Array) -> NDArray[np.bool_]:
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
