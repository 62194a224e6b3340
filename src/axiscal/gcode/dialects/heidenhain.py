"""HEIDENHAIN Klartext: M91 in each block means the machine datum; cycle 9 dwells in seconds."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.gcode.dialect import Dialect, Words
from axiscal.machine.axis import Axis


class Heidenhain(Dialect):
    """Programs for iTNC 530, TNC 640 and their kin, in Klartext."""

    title = "HEIDENHAIN"
    suffix = "H"
    longest_name = 16
    notes = (
        "Never tried on a control: run it in the test run first, then block by block at reduced feed.",
        "Call the tool (or tool 0) by hand before: the program has no TOOL CALL. M91 leaves out datum and tool length.",
        "Before it starts, M128 or FUNCTION TCPM, a tilted plane, M116 and M126 must be off: turning axes move in "
        "deg/min and do not take the short way.",
    )

    from_zero = True
    timed = None
    tip_needs = (
        "IN TOUCH - TOOL POINT ON THE WORKPIECE BY TCPM",
        "NEEDS THE PRESET AT THE MACHINE DATUM AND THE TOOL CALLED",
    )
    tip_notes = (
        "FUNCTION TCPM is an option; F CONT makes the feed that of the axes that are programmed, AXIS POS PATHCTRL "
        "AXIS lets rotary axes turn evenly. An older control has M128 instead.",
        "The active preset must be the machine datum with no rotation, and the tool must have been called with its "
        "length, so that coordinates count from the machine's zero with the table at zero.",
    )

    def tip_on(self, tool: str, tip: Words) -> list[str]:
        """Return tool centre point management, with rotary axes at programmed positions."""
        return ["FUNCTION TCPM F CONT AXIS POS PATHCTRL AXIS"]

    def tip_off(self, axes: Words) -> list[str]:
        """Return its end: it must not be in force with M91."""
        return ["FUNCTION RESET TCPM"]

    def tip_move(self, words: Words, feed: int) -> str:
        """Return L in the workpiece's coordinates."""
        return f"L {_named(words)} R0 F{feed}"

    @property
    def pause(self) -> list[str]:
        """A programmed stop."""
        return ["STOP"]

    def comment(self, text: str) -> str:
        """Return a comment after a semicolon."""
        return f"; {text}"

    def framed(self, name: str, number: int, axes: Sequence[Axis], lines: Sequence[str]) -> str:
        """Return the program with its blocks numbered; MM is said in its first and last block."""
        blocks = [f"BEGIN PGM {name} MM", *self.opening(number, axes), *lines, *self.closing, f"END PGM {name} MM"]
        return "".join(f"{place} {block}\n" for place, block in enumerate(blocks))

    def opening(self, number: int, axes: Sequence[Axis]) -> list[str]:
        """Return spindle and coolant off: Klartext is absolute, and the unit is said when it begins."""
        return ["M5", "M9"]

    def stop(self, axes: Sequence[Axis]) -> list[str]:
        """Return a programmed stop."""
        return ["STOP"]

    @property
    def closing(self) -> list[str]:
        """M30."""
        return ["M30"]

    def move(self, words: Words, feed: int) -> str:
        """Return L with M91: a feed move in machine coordinates."""
        return f"L {_named(words)} R0 F{feed} M91"

    def dwell_s(self, seconds: float) -> list[str]:
        """Return cycle 9 in seconds; it acts where it is defined."""
        return ["CYCL DEF 9.0 DWELL TIME", f"CYCL DEF 9.1 DWELL {seconds:.3f}"]


def _named(words: Words) -> str:
    return " ".join(axis + ("" if value.startswith("-") else "+") + value for axis, value in words)
