"""Sizes that can be written but can hardly be meant: a slip of unit makes a machine of half a kilometre."""

from __future__ import annotations

from collections.abc import Iterator

from axiscal.language.spoken import counted, joined, later, listed, said
from axiscal.units import format_quantity, said_quantity
from axiscal_core.machine import Machine

_LONGEST, _SHORTEST, _TOOL = 50.0, 1e-3, 2.0
"""m: travels of machine tools, and lengths of tools, lie between."""
_FASTEST = 10.0
"""m/s."""
_LARGEST_LENGTH, _LARGEST_ANGLE, _LARGEST_OFFSET = 1e-3, 1e-2, 5e-3
"""Standard deviations: of displacements, m; of angles, rad; of where a rotary axis lies, m."""
_WIDE = later("The std of {name} is {size}: one machine in three lies beyond that. Is it the unit that is meant?")
_STRAIGHT = later(
    "The length of {name} is longer than the travel of {axis}: the error is taken as nearly straight. A quarter of the "
    'travel is usual: length = "{size}".'
)
_SMALLEST = 1e-9
"""m or rad: nobody knows an error to the atom before it is measured."""


def questions(machine: Machine) -> tuple[str, ...]:
    """Return what somebody should look at again, one sentence each."""
    return (*_axes(machine), *_errors(machine))


def uncounted(machine: Machine) -> list[str]:
    """Return the axes of which nobody said which way they count."""
    return [axis.name for axis in machine.axes if axis.rotary and axis.counting is None]


def which_way(machine: Machine) -> tuple[str, ...]:
    """Return the question which way rotary axes count, where nobody said."""
    names = uncounted(machine)
    if not names:
        return ()
    one, many = "Which way does {names} count?", "Which way do {names} count?"
    supposed = (
        "Nothing is said, so ISO 841 counts: for rising numbers the tool turns by the right hand relative to the "
        "workpiece, a table the other way. If the control counts against that (LinuxCNC's xyzac- and xyzbc-trt-kins "
        'do), write direction = "reversed" in the table of the axis, else "iso".'
    )
    return (listed(" ", [counted(one, many, len(names), names=joined(names)), said(supposed)]),)


def _axes(machine: Machine) -> Iterator[str]:
    for axis in machine.axes:
        if not axis.rotary and not _SHORTEST <= axis.length <= _LONGEST:
            travel = said_quantity(axis.length, "m")
            yield said("The travel of {axis} is {size}: is that the unit that is meant?", axis=axis.name, size=travel)
        if not axis.rotary and axis.speed > _FASTEST:
            speed = said_quantity(axis.speed, "m/min")
            yield said("{axis} moves at {size}: is that the unit that is meant?", axis=axis.name, size=speed)
    if machine.tool_length > _TOOL:
        tool = said_quantity(machine.tool_length, "m")
        yield said("The tool is {size} long: is that the unit that is meant?", size=tool)


def _errors(machine: Machine) -> Iterator[str]:
    for entry in machine.stated:
        most = _LARGEST_ANGLE if entry.angular else _LARGEST_OFFSET if entry.kind == "location" else _LARGEST_LENGTH
        if not _SMALLEST <= entry.std <= most and (entry.std or not entry.sides):
            unit = "mrad" if entry.angular else "mm"
            yield said(_WIDE, name=entry.name, size=said_quantity(entry.std, unit))
        axis = machine.axis(entry.axis)
        if (entry.length or 0.0) > axis.length:
            size = format_quantity(axis.length / 4, axis.unit, 3)
            yield said(_STRAIGHT, name=entry.name, axis=axis.name, size=size)
