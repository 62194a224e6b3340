"""ISG kernel (TwinCAT CNC): with no kinematics, offset or tool, coordinates are the machine's; #TIME waits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NoReturn

from axiscal.exceptions import ProgramError
from axiscal.gcode.dialect import Dialect, Words
from axiscal.gcode.steps import Touched
from axiscal.machine.axis import Axis


class Isg(Dialect):
    """Programs for controls with the ISG kernel, such as TwinCAT CNC (TF5200)."""

    title = "ISG"
    suffix = "nc"
    notes = (
        "Never tried on a control: run it in the simulation first, then block by block at reduced feed.",
        "G53 takes out zero offsets, D0 the tool and #TRAFO OFF the kinematics: then coordinates are those of the "
        "axes. No #CS, #ACS, #PSET, mirroring or scaling may be in force.",
        "The feed of a block in which only rotary axes move is taken to be in deg/min.",
    )
    tip_decimals = 6
    from_zero = True
    timed = None
    tip_needs = ("IN TOUCH - TOOL POINT ON THE WORKPIECE BY TRAFO ON", "NEEDS NO ZERO OFFSET AND THE TOOL IN D1")
    tip_notes = (
        "#TRAFO ON switches to the kinematics that the channel has by default, an option: it must be that of the "
        "machine, incomplete (RTCP), with places on the workpiece as the table stands when it begins, which "
        "is at zero.",
        "D1 must hold the length of the tool as the machine description has it; G53 takes out the zero offsets.",
    )
    log_notes = ()

    def log_on(self, code: str) -> list[str]:
        """Refuse: how such a control writes what it measured was not to be found out."""
        _no_log()

    def log_off(self, code: str, readings: int) -> list[str]:
        """Refuse."""
        _no_log()

    def touched(self, code: str, touch: Touched) -> list[str]:
        """Refuse."""
        _no_log()

    def tip_on(self, tool: str, tip: Words) -> list[str]:
        """Return the tool's length, and the kinematics."""
        return ["G53", "D1", "#TRAFO ON"]

    def tip_off(self, axes: Words) -> list[str]:
        """Return no kinematics, no tool."""
        return ["#TRAFO OFF", "D0"]

    def tip_move(self, words: Words, feed: int) -> str:
        """Return G1 on the workpiece."""
        return f"G1 {_named(words)} F{feed}"

    def framed(self, name: str, number: int, axes: Sequence[Axis], lines: Sequence[str], logs: bool = False) -> str:
        """Return the program behind a name, without which it would be nameless in the control's messages."""
        return f"%AXISCAL{number}\n{super().framed(name, number, axes, lines, logs)}"

    def opening(self, number: int, axes: Sequence[Axis]) -> list[str]:
        """Return no kinematics, metric, absolute, mm/min, no compensation, no offset, exact stop, spindle off."""
        return ["#TRAFO OFF", "G71 G90 G94 G17 G40 G53 G60 D0", "M5 M9"]

    @property
    def closing(self) -> list[str]:
        """M30."""
        return ["M30"]

    def move(self, words: Words, feed: int) -> str:
        """Return G1: nothing is in force that would make it another place than the machine's."""
        return f"G1 {_named(words)} F{feed}"

    def dwell_s(self, seconds: float) -> list[str]:
        """Return #TIME, in seconds."""
        return [f"#TIME {seconds:.3f}"]


def _named(words: Words) -> str:
    return " ".join(axis + value for axis, value in words)


def _no_log() -> NoReturn:
    what = "ISG programs write no log"
    raise ProgramError(what, "Leave --log out: the program stops at each sphere for the control's own cycle")
