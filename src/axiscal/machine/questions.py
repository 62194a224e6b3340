"""What a description leaves open: which way rotary axes count."""

from __future__ import annotations

from axiscal.language.spoken import counted, joined, listed, said
from axiscal_core.machine import Machine


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
