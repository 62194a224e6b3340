"""Axes that move together: never linear and rotary ones at once, so that a feed has one meaning."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from axiscal.exceptions import ProgramError
from axiscal.gcode.program_options import ProgramOptions
from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.machine.motion import FAMILIES, family_groups
from axiscal.units import to_unit

FASTEST = 99_999
"""mm/min or deg/min; not every control is known to read a longer number."""


@dataclass(frozen=True, slots=True)
class Group:
    """Some axes by index, in the order X Y Z, A B C; their speeds (mm/s, deg/s) and accelerations (mm/s², deg/s²)."""

    names: tuple[str, ...]
    axes: tuple[int, ...]
    speeds: tuple[float, ...]
    accelerations: tuple[float, ...]

    def feed(self, ways: Sequence[float] | None) -> int:
        """Return the fastest feed (mm/min, deg/min) of a straight move at which no axis exceeds its speed.

        ways : how far each axis goes, mm or deg; None where that is not known.  Raises ProgramError below 1.
        """
        fastest = min(self.speeds) if ways is None else _along(self.speeds, ways)
        feed = min(math.floor(fastest * 60 * (1 + 1e-12)), FASTEST)
        if feed < 1:
            what = f"{' '.join(self.names)} would move at less than 1 mm/min or deg/min"
            raise ProgramError(what, "Give these axes a higher speed, or choose a larger share of it as the feed")
        return feed

    def seconds(self, ways: Sequence[float], feed: int) -> float:
        """Return the time of a straight move that begins and ends at rest."""
        length, speed = math.hypot(*ways), feed / 60
        acceleration = _along(self.accelerations, ways)
        short = length < speed**2 / acceleration
        return 2 * math.sqrt(length / acceleration) if short else length / speed + speed / acceleration


def groups(machine: Machine, options: ProgramOptions) -> tuple[Group, ...]:
    """Return the groups in the order they move; raises ProgramError for an order that cannot be."""
    order = _usual(machine) if options.order is None else options.order
    _check(order, machine)
    return tuple(_group(machine, names, options.feed) for names in order)


def _usual(machine: Machine) -> tuple[tuple[str, ...], ...]:
    return tuple(tuple(machine.axes[k].name for k in group) for group in family_groups(machine))


def _check(order: Sequence[Sequence[str]], machine: Machine) -> None:
    named = [name for group in order for name in group]
    if sorted(named) != sorted(axis.name for axis in machine.axes):
        known = " ".join(axis.name for axis in machine.axes)
        raise ProgramError(f"the order of moves names {' '.join(named) or 'no axis'}", f"Name each of {known} once")
    for group in order:
        if len({family for name in group for family in FAMILIES if machine.axis(name).letter in family}) > 1:
            what = f"{' '.join(group)} are to move together"
            raise ProgramError(what, "Let X Y Z, U V W and A B C move in groups of their own")


def _group(machine: Machine, names: Sequence[str], share: float) -> Group:
    axes = tuple(sorted((machine.index(name) for name in names), key=lambda k: _place(machine.axes[k])))
    speeds = tuple(share * _written(machine.axes[k], machine.axes[k].speed) for k in axes)
    accelerations = tuple(_written(machine.axes[k], machine.axes[k].acceleration) for k in axes)
    return Group(tuple(machine.axes[k].name for k in axes), axes, speeds, accelerations)


def _place(axis: Axis) -> tuple[int, str]:
    return "".join(FAMILIES).index(axis.letter), axis.name


def _written(axis: Axis, value: float) -> float:
    """Return a speed or acceleration in mm or deg instead of m or rad."""
    return to_unit(value, axis.unit)


def _along(limits: Sequence[float], ways: Sequence[float]) -> float:
    """Return the most along a straight way that keeps within the limits of all axes."""
    length = math.hypot(*ways)
    return min(limit * length / way for limit, way in zip(limits, ways, strict=True) if way)
