"""Ways through a chart: straight in u, or one coordinate after the other, where all of it can be taken.

Whether every place on a way through a chart can be taken: proven, not looked at.

A function with |f''| ≤ M is, between two places h apart, nowhere below min(f₀, f₁) − M h²/8. There the tool is at most
half of its fastest way from one of the two. Pieces that these bounds do not prove are halved; a piece that stays
unproven is not gone.

How fast a straight way through a chart turns, moves and bends at the most: what bounds it between two places on it.

With s from 0 to 1 the rotary axes turn evenly and the tool point goes along p*(s). The linear axes t solve J(ρ) t = r
with r = p* − p₀(ρ). So |t'| ≤ N (|r'| + |J'| |t|) and |t''| ≤ N (|r''| + 2 |J'| |t'| + |J''| |t|), N = ‖J⁻¹‖. Turned at
a rate w about a place d away, a point x has |x'| + w d and |x''| + 2 w |x'| + w² d at the most.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise, permutations
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.description import Machine
from axiscal.machine.kinematics import frames, linear_axes, tool_point
from axiscal.measurement.bodies import lever
from axiscal.measurement.charts.room import Chart, Room
from axiscal.numerics import Array
from axiscal_core.axes import Frames

_SAME_WAY = 1e-12
"""Rounding of two directions that are one."""


class Narrow(NamedTuple):
    """An angle that stays within a cone.

    cosines : of it, (m,), by stems and tips (m, 3); cone : rad; bend : the largest second derivative of the cosine by s
    """

    cosines: Callable[[Array, Array], Array]
    cone: float
    bend: float


class Swing(NamedTuple):
    """A straight way through a chart.

    turns : (q,) rad, by how much each axis turns; speed, bend : m, the largest |p*'| and |p*''|; angles : what stays
    within cones
    """

    turns: Array
    speed: float
    bend: float
    angles: tuple[Narrow, ...]


class Slides:
    """The largest second derivative of the linear axes by s, over pieces of a way."""

    def __init__(self, machine: Machine, swing: Swing) -> None:
        self._machine, self._swing, self._axes = machine, swing, list(linear_axes(machine))
        rotary = [k for k, axis in enumerate(machine.axes) if axis.rotary]
        before = [k for k in rotary if k < max(self._axes)]
        alike = all(k < min(self._axes) for k in before)  # all linear axes turn together
        self._rate = float(swing.turns[before].sum()) * (1.0 if alike else np.sqrt(len(self._axes)))
        self._loosened = 0.0 if alike else self._rate
        self._middle, self._lever, self._speed, self._bend = _spin(machine, swing.turns)

    def bends(self, at: Frames, widths: Array) -> Array:
        """Return them of pieces that begin at frames, (m,) m; without end where the linear axes may fall together."""
        ways = np.stack([at.rotations[k] @ np.array(self._machine.axes[k].direction) for k in self._axes], axis=2)
        least = np.linalg.svd(ways, compute_uv=False)[:, -1] - self._loosened * widths
        swing = self._swing
        far = np.linalg.norm(at.tcp - self._middle, axis=1) + swing.speed * widths + self._lever
        with np.errstate(divide="ignore"):
            inverse = np.where(least > 0, 1.0 / np.maximum(least, 0.0), np.inf)
        slides = inverse * far
        fast = inverse * (swing.speed + self._speed + self._rate * slides)
        bends: Array = inverse * (swing.bend + self._bend + 2 * self._rate * fast + self._rate**2 * slides)
        return bends


def _spin(machine: Machine, turns: Array) -> tuple[Array, float, float, float]:
    """Return bounds of p₀(ρ), the tool point with all linear axes at zero, where axes turn by so much, (q,) rad.

    What it turns about last, (3,) m, how far from there at most, its speed and its bend, m; from tool to workpiece.
    """
    about, lever, speed, bend = tool_point(machine), 0.0, 0.0, 0.0
    for axis, rate in reversed(list(zip(machine.axes, turns.tolist(), strict=True))):
        if axis.rotary:
            origin = np.array(axis.origin)
            lever, about = lever + float(np.linalg.norm(about - origin)), origin
            speed, bend = speed + rate * lever, bend + 2 * rate * speed + rate**2 * lever
    return about, lever, speed, bend


def stem_rate(machine: Machine, turns: Array, against: Array | None = None) -> float:
    """Return how fast the tool turns at the most, rad by s.

    against : (3,) a direction of the workpiece, about which a turn next to the workpiece does not change the angle
    """
    rotary = [k for k, axis in enumerate(machine.axes) if axis.rotary]
    while rotary and _parallel(machine, rotary[-1], np.array([0.0, 0.0, 1.0])):
        rotary.pop()
    while against is not None and rotary and _parallel(machine, rotary[0], against):
        rotary.pop(0)
    return float(turns[rotary].sum())


def _parallel(machine: Machine, axis: int, direction: Array) -> bool:
    return abs(abs(float(np.array(machine.axes[axis].direction) @ direction)) - 1.0) <= _SAME_WAY


def bar_angles(
    machine: Machine, turns: Array, centre: Array, free: Array, cone: float, rate: float
) -> tuple[Narrow, ...]:
    """Return the angles of a bar with the tool and with where its centre is free.  rate : rad by s, of the bar"""

    def bars(tips: Array) -> Array:
        away = tips - centre
        return np.asarray(away / np.linalg.norm(away, axis=1)[:, None], dtype=np.float64)

    with_tool = Narrow(
        lambda stems, tips: np.asarray(np.sum(stems * bars(tips), axis=1), dtype=np.float64),
        cone,
        (stem_rate(machine, turns) + rate) ** 2,
    )
    return with_tool, Narrow(lambda _, tips: bars(tips) @ free, cone, rate**2)


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
        self._fastest = swing.speed + lever(machine) * stem_rate(machine, swing.turns)

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
        if self._room.occupied and found.any():
            nearer = np.tile(self._fastest * widths / 2 - _LIMIT, 2)
            hit = self._room.hit(at.tcp, at.stem, nearer)
            found &= ~(hit[:count] | hit[count:])
        return np.asarray(found, dtype=np.bool_)


def _lesser(values: Array) -> Array:
    """Return the lesser one of both ends of each piece.  values : (2 m,)"""
    lesser: Array = values.reshape(2, -1).min(axis=0)
    return lesser
