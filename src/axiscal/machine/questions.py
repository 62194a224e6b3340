"""Sizes that can be written but can hardly be meant: a slip of unit makes a machine of half a kilometre."""

from __future__ import annotations

from collections.abc import Iterator

from axiscal.machine.description import Machine
from axiscal.machine.names import parse_error_name
from axiscal.units import format_quantity

_LONGEST, _SHORTEST, _TOOL = 50.0, 1e-3, 2.0
"""m: travels of machine tools, and lengths of tools, lie between."""
_FASTEST = 10.0
"""m/s."""
_LARGEST_LENGTH, _LARGEST_ANGLE, _LARGEST_OFFSET = 1e-3, 1e-2, 5e-3
"""Standard deviations: of displacements, m; of angles, rad; of where a rotary axis lies, m."""
_SMALLEST = 1e-9
"""m or rad: nobody knows an error to the atom before it is measured."""


def questions(machine: Machine) -> tuple[str, ...]:
    """Return what somebody should look at again, one sentence each."""
    return (*_axes(machine), *_errors(machine))


def uncounted(machine: Machine) -> str:
    """Return the axes of which nobody said which way they count: "B and C"; "" where there are none."""
    return " and ".join(axis.name for axis in machine.axes if axis.rotary and axis.counting is None)


def which_way(machine: Machine) -> tuple[str, ...]:
    """Return the question which way rotary axes count, where nobody said."""
    names = uncounted(machine)
    if not names:
        return ()
    verb = "do" if " " in names else "does"
    return (
        f"Which way {verb} {names} count? Nothing is said, and ISO 841 is supposed: counting up, the tool turns by the "
        "right hand about the axis relative to the workpiece, a table the other way. Where the control counts against "
        'that (as LinuxCNC\'s xyzac- and xyzbc-trt-kins do), write direction = "reversed" in the table of the axis, '
        'else "iso".',
    )


def _axes(machine: Machine) -> Iterator[str]:
    for axis in machine.axes:
        if not axis.rotary and not _SHORTEST <= axis.length <= _LONGEST:
            travel = format_quantity(axis.length, "m", 3)
            yield f"The travel of {axis.name} is {travel}: is that the unit that is meant?"
        if not axis.rotary and axis.speed > _FASTEST:
            yield f"{axis.name} moves at {format_quantity(axis.speed, 'm/min', 3)}: is that the unit that is meant?"
    if machine.tool > _TOOL:
        yield f"The tool is {format_quantity(machine.tool, 'm', 3)} long: is that the unit that is meant?"


def _errors(machine: Machine) -> Iterator[str]:
    for entry in machine.errors:
        name = parse_error_name(entry.name)
        most = _LARGEST_ANGLE if name.angular else _LARGEST_OFFSET if name.kind == "location" else _LARGEST_LENGTH
        if not _SMALLEST <= entry.std <= most:
            unit = "mrad" if name.angular else "mm"
            yield (
                f"The std of {entry.name} is {format_quantity(entry.std, unit, 3)}: one machine in three lies beyond "
                "that. Is it the unit that is meant?"
            )
    for plane in machine.planes:
        most, unit = (_LARGEST_ANGLE, "mrad") if plane.angular else (_LARGEST_LENGTH, "mm")
        if plane.std and not _SMALLEST <= plane.std <= most:
            size = format_quantity(plane.std, unit, 3)
            yield f"The std of {plane.name} is {size}: one machine in three lies beyond that. Is the unit meant so?"
