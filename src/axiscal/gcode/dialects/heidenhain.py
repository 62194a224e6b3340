"""HEIDENHAIN Klartext: M91 in each block means the machine datum; cycle 9 dwells in seconds."""

from __future__ import annotations

import math
from collections.abc import Sequence

from axiscal.gcode.dialect import Dialect, Words, head
from axiscal.gcode.steps import Touched
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

    log_notes = (
        "The probing blocks were never tried on a control. TCH PROBE 4 (measuring in 3-D) measures in the machine's "
        "own system (REF) without the probe's length and radius, into Q1 to Q3; Q4 is -1 where nothing was met. "
        "Q1 to Q6 are used.",
        "FN 16 writes the log on at its end. The masks, the files .A beside the program, must lie in TNC:\\AXISCAL; "
        "the log is written there.",
    )

    def log_on(self, code: str) -> list[str]:
        """Return the first line of the log."""
        return [_printed(f"AXHEAD_{code}", code)]

    def log_off(self, code: str, readings: int) -> list[str]:
        """Return the last line of the log; behind it stands what is done where nothing is met."""
        last = [f"FN 0: Q5 = +{readings}", _printed("AXEND", code)]
        return [*last, "FN 9: IF +0 EQU +0 GOTO LBL 98", "LBL 99", "; THE PROBE MET NOTHING", "STOP", "M30", "LBL 98"]

    def touched(self, code: str, touch: Touched) -> list[str]:
        """Return cycle 4 twice, fast and then slowly from a short way off, the line of the log, and the way back."""
        far = [float(into) - float(beside) for into, beside in zip(touch.into, touch.beside, strict=True)]
        back = math.hypot(*map(float, touch.back))
        reach = math.hypot(*far)
        along = " ".join(f"I{axis}{way / reach:+.6f}" for axis, way in zip(touch.letters, far, strict=True))
        lines = [*_measured(along, reach, touch.fast, back), *_measured(along, reach, touch.slow, back)]
        numbers = [f"FN 0: Q5 = +{touch.reading}", f"FN 0: Q6 = +{touch.touch}"]
        away = self.move(touch.words(touch.beside), touch.travel)
        return [*lines, *numbers, _printed("AXTOUCH", code), away]

    def log_files(self, code: str) -> dict[str, str]:
        """Return the masks of FN 16."""
        touch = '"R %6.0LF T %3.0LF X %12.5LF Y %12.5LF Z %12.5LF",Q5,Q6,Q1,Q2,Q3;'
        texts = {f"AXHEAD_{code}": f'"{head(code)}";', "AXTOUCH": touch, "AXEND": '"END %6.0LF",Q5;'}
        return {f"{name}.A": f"{text}\nM_APPEND;\n" for name, text in texts.items()}

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

    def framed(self, name: str, number: int, axes: Sequence[Axis], lines: Sequence[str], logs: bool = False) -> str:
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


def _measured(along: str, reach: float, feed: int, back: float) -> list[str]:
    """Return cycle 4: measuring in 3-D along a vector, result from Q1 on, drawn back by MB afterwards."""
    far = f"TCH PROBE 4.3 DIST{reach:+.3f} F{feed} MB{back:.3f} REFERENCE SYSTEM: 1"
    lines = ["TCH PROBE 4.0 MEASURING IN 3-D", "TCH PROBE 4.1 Q1", f"TCH PROBE 4.2 {along}", far]
    return [*lines, "FN 9: IF +Q4 EQU -1 GOTO LBL 99"]


def _printed(mask: str, code: str) -> str:
    """Return the output of a mask into the log."""
    return f"FN 16: F-PRINT TNC:\\AXISCAL\\{mask}.A / TNC:\\AXISCAL\\{code}.TXT"
