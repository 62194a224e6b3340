"""How a machine is driven to its readings by a program, as far as a person has a say in it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import said
from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine

FAMILIES = ("XYZ", "UVW", "PQR", "ABC")
"""Letters that one feed counts for; LinuxCNC takes a feed for XYZ alone when U moves too."""
_NEAR = {False: 2e-3, True: math.radians(2.0)}
"""The last millimetres: 2 mm, or 2 deg, are slow where a feed near the place is asked for."""


@dataclass(frozen=True, slots=True)
class Driving:
    """The content of `[programs]` in a campaign; left out, everything is quick and nothing goes clear.

    clearance : name of the axis that goes clear before others move, with its coordinate, m or rad
    order : names of axes that move together, group after group; None: linear axes first, then rotary ones
    feed : m/s, for the last millimetres to a place; a group of rotary axes takes its number of mm/min as deg/min
    dwell : at a reading the program waits the reading time, instead of stopping until somebody presses start
    tcp : the control holds the tool point where it must stay in touch while rotary axes turn
    """

    clearance: tuple[str, float] | None = None
    order: tuple[tuple[str, ...], ...] | None = None
    feed: float | None = None
    dwell: bool = False
    tcp: bool = True

    def feed_of(self, rotary: bool) -> float:
        """Return the feed near a place, m/s or rad/s; infinite where none is stated."""
        if self.feed is None:
            return math.inf
        return math.radians(self.feed * 1000) if rotary else self.feed


USUAL = Driving()


def near(axis: Axis) -> float:
    """Return how near to a place an axis goes slow, m or rad: all of its overrun, at least."""
    return max(_NEAR[axis.rotary], axis.overrun)


def move_groups(machine: Machine, driving: Driving = USUAL) -> tuple[tuple[int, ...], ...]:
    """Return the axes that move together, by index, group after group; raises DescriptionError for what cannot be."""
    if driving.order is not None:
        _check(driving.order, machine)
        return tuple(tuple(machine.index(name) for name in group) for group in driving.order)
    groups = [tuple(k for k, axis in enumerate(machine.axes) if axis.letter in family) for family in FAMILIES]
    return tuple(group for group in groups if group)


def _check(order: Sequence[Sequence[str]], machine: Machine) -> None:
    named = [name for group in order for name in group]
    if sorted(named) != sorted(axis.name for axis in machine.axes):
        known = " ".join(axis.name for axis in machine.axes)
        axes, remedy = " ".join(named) or said("no axis"), "Name each of {known} once"
        raise DescriptionError("the order of moves names {axes}", remedy, axes=axes, known=known)
    for group in order:
        if len({family for name in group for family in FAMILIES if machine.axis(name).letter in family}) > 1:
            what = "{axes} are to move together"
            raise DescriptionError(what, "Let X Y Z, U V W and A B C move in groups of their own", axes=" ".join(group))
