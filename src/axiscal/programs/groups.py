"""Axes that move together: never linear and rotary ones at once, so that a feed has one meaning."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from axiscal.exceptions import ProgramError
from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.machine.motion import FAMILIES, Driving, move_groups
from axiscal.units import to_unit

FASTEST = 99_999
"""mm/min or deg/min; not every control is known to read a longer number."""


@dataclass(frozen=True, slots=True)
class Group:
    """Some axes by index, in the order X Y Z, A B C; their speeds (mm/s, deg/s) and accelerations (mm/s², deg/s²).

    near : mm/min or deg/min that are not exceeded near a reading; None where nothing is slow
    """

    names: tuple[str, ...]
    axes: tuple[int, ...]
    speeds: tuple[float, ...]
    accelerations: tuple[float, ...]
    near: int | None = None

    def feed(self, ways: Sequence[float] | None, slow: bool = False) -> int:
        """Return the fastest feed (mm/min, deg/min) of a straight move at which no axis exceeds its speed.

        ways : how far each axis goes, mm or deg; None where that is not known.  slow : the move is near a reading
        Raises ProgramError below 1.
        """
        fastest = min(self.speeds) if ways is None else _along(self.speeds, ways)
        most = self.near if slow and self.near is not None else FASTEST
        feed = min(math.floor(fastest * 60 * (1 + 1e-12)), most)
        if feed < 1:
            remedy = "Give these axes a higher speed, or programs a higher feed near the place"
            raise ProgramError("{axes} would move at less than 1 mm/min or deg/min", remedy, axes=" ".join(self.names))
        return feed

    def seconds(self, ways: Sequence[float], feed: int) -> float:
        """Return the time of a straight move that begins and ends at rest."""
        length, speed = math.hypot(*ways), feed / 60
        acceleration = _along(self.accelerations, ways)
        short = length < speed**2 / acceleration
        return 2 * math.sqrt(length / acceleration) if short else length / speed + speed / acceleration


def groups(machine: Machine, driving: Driving) -> tuple[Group, ...]:
    """Return the groups in the order they move; raises DescriptionError for an order that cannot be."""
    return tuple(_group(machine, axes, driving.feed) for axes in move_groups(machine, driving))


def _group(machine: Machine, members: Sequence[int], near: float | None) -> Group:
    axes = tuple(sorted(members, key=lambda k: _place(machine.axes[k])))
    speeds = tuple(_written(machine.axes[k], machine.axes[k].speed) for k in axes)
    accelerations = tuple(_written(machine.axes[k], machine.axes[k].acceleration) for k in axes)
    slow = None if near is None else math.floor(to_unit(near, "mm/min") * (1 + 1e-12))
    return Group(tuple(machine.axes[k].name for k in axes), axes, speeds, accelerations, slow)


def _place(axis: Axis) -> tuple[int, str]:
    return "".join(FAMILIES).index(axis.letter), axis.name


def _written(axis: Axis, value: float) -> float:
    """Return a speed or acceleration in mm or deg instead of m or rad."""
    return to_unit(value, axis.unit)


def _along(limits: Sequence[float], ways: Sequence[float]) -> float:
    """Return the most along a straight way that keeps within the limits of all axes."""
    length = math.hypot(*ways)
    return min(limit * length / way for limit, way in zip(limits, ways, strict=True) if way)
