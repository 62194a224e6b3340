"""How large the parts of a drawn machine are, from what its tool reaches: all of it a matter of taste."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from axiscal.numerics import Array
from axiscal.present.drawing.scene import EYE, Arrow, Part
from axiscal.present.machine_drawing.standing_machine import StandingMachine

Laid = tuple[int, Part]
"""A shape with the part of the machine that it belongs to."""


@dataclass(frozen=True, eq=False)
class Measures:
    """Measures that the rules share, m in the room at home."""

    room: StandingMachine

    @property
    def whole(self) -> float:
        """The largest side of what the tool reaches."""
        return self.room.size

    @cached_property
    def spindle(self) -> float:
        """What spindle and ram are measured by: six lengths of the tool, within reason."""
        return float(np.clip(6 * self.room.machine.tool, 0.4 * self.whole, self.whole))

    @property
    def pad(self) -> float:
        """By how much tables and beds are larger than what is reached."""
        return 0.07 * self.whole

    @property
    def step(self) -> float:
        """Length of an arrow."""
        return 0.13 * self.whole

    @property
    def ram(self) -> float:
        """Half the thickness of a ram."""
        return 0.08 * self.spindle

    @property
    def plate(self) -> float:
        """Depth of a carriage."""
        return 0.09 * self.whole

    @property
    def table(self) -> float:
        """Height of the top of the table."""
        return float(self.room.tip[2] - self.room.half[2]) - 0.03 * self.whole

    @cached_property
    def tops(self) -> dict[int, float]:
        """Height of the top of every part that carries the workpiece, by its axis."""
        tops, level = dict[int, float](), self.table
        for axis in self.room.work:
            tops[axis] = level
            level -= self._high(axis)
        return tops

    @cached_property
    def floor(self) -> float:
        """Height of the top of the bed."""
        if not self.room.work:
            return self.table - 0.07 * self.whole
        last = self.room.work[-1]
        return self.tops[last] - self._high(last)

    @cached_property
    def framed(self) -> bool:
        """Whether a gantry runs in a frame of four posts over a table that goes up and down."""
        axes, ways = self.room.machine.axes, self.room.way
        level = [k for k in self.room.tool if not axes[k].rotary and ways(k) < 2]
        return len(level) > 1 and any(not axes[k].rotary and ways(k) == 2 for k in self.room.work)

    def _high(self, axis: int) -> float:
        upright = self.room.way(axis) == 2
        if self.room.machine.axes[axis].rotary:
            return (0.09 if upright else 0.17) * self.whole
        return (0.3 if upright else 0.06) * self.whole


def up(height: float) -> Array:
    """Return a way up, (3,) m."""
    return np.array([0.0, 0.0, height])


def name_of(room: StandingMachine, axis: int) -> str:
    """Return the name of an axis as it is drawn, primed where it carries the workpiece."""
    own = room.machine.axes[axis]
    return own.name + ("′" if own.workpiece_side else "")


def under(room: StandingMachine, axis: int) -> int:
    """Return the part that carries the one of an axis."""
    order = room.work[::-1] if axis in room.work else room.tool
    at = order.index(axis)
    return order[at - 1] if at else -1


def straight(sizes: Measures, axis: int, start: Array) -> Laid:
    """Return the arrow of a linear axis: how the part itself moves as its coordinate grows.  start : (3,) m"""
    along = sizes.step * sizes.room.growing(axis)
    return axis, Arrow(np.array([start - 0.6 * along, start + along]), name_of(sizes.room, axis))


def turning(sizes: Measures, axis: int, centre: Array, radius: float, span: float = 110.0) -> Laid:
    """Return the arc of a rotary axis, on the side that is seen: how the part itself turns as its coordinate grows.

    centre : (3,) m; radius : m; span : deg
    """
    along = sizes.room.growing(axis)
    u = EYE - (EYE @ along) * along
    u /= np.linalg.norm(u)
    turns = np.radians(np.linspace(-span / 2, span / 2, 30))
    arc = centre + radius * (np.outer(np.cos(turns), u) + np.outer(np.sin(turns), np.cross(along, u)))
    return under(sizes.room, axis), Arrow(arc, name_of(sizes.room, axis), "gold")


def across(ends: Array) -> Iterator[tuple[int, Array]]:
    """Yield −1 and +1 with the vector to that end, of something that is as long as twice a vector, (3,) m."""
    for side in (-1, 1):
        yield side, side * ends
