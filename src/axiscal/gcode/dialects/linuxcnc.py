"""LinuxCNC: RS-274/NGC. G53 goes with G1 and holds for its block only; G4 P is in seconds."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.exceptions import ProgramError
from axiscal.gcode.dialect import Dialect, Words, head
from axiscal.gcode.steps import Touched
from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine


class LinuxCNC(Dialect):
    """Programs for LinuxCNC 2.8 or later, set up in mm or in inches: G21 holds for machine coordinates too."""

    title = "LinuxCNC"
    suffix = "ngc"
    notes = (
        "Tried on LinuxCNC's own interpreter (rs274), not on a machine.",
        "Coordinates are in mm (G21) and deg, whatever LINEAR_UNITS says: tried with mm and with inch.",
        "Rotary axes must not be WRAPPED_ROTARY, and a five-axis kinematics must be in its joint (identity) mode.",
    )

    tip_decimals = 6
    tip_needs = ("IN TOUCH - TOOL POINT ON THE WORKPIECE BY M428", "NEEDS G54 AND G92 AT ZERO")
    tip_notes = (
        "M428 must switch to the kinematics of the swivelling table and M429 back to identity, as in LinuxCNC's own "
        "configurations of trt-kins (sparm=identityfirst); rotation points and offsets are those of the machine.",
        "The tool's length is put in force by G43.1; the pin tool-offset must follow motion.tooloffset.z.",
    )

    log_notes = (
        "Tried on a running LinuxCNC without motors. The log is a file of the name in the first lines of the program, "
        "in the folder from which LinuxCNC was started; it is written on at its end.",
        "G54, G92 and the rotation of G54 must be zero: the program looks. The probe is on motion.probe-input.",
    )

    def log_on(self, code: str) -> list[str]:
        """Return the check that no offset is in force, what one touch is, and the log with its first line."""
        return [*_at_zero("O101", range(5221, 5231)), *_TOUCH, f"(LOGAPPEND,axiscal_{code}.txt)", f"(LOG,{head(code)})"]

    def log_off(self, code: str, readings: int) -> list[str]:
        """Return the last line and the end of the log."""
        return [f"(LOG,END {readings})", "(LOGCLOSE)"]

    def touched(self, code: str, touch: Touched) -> list[str]:
        """Return the call of one touch."""
        places = (*touch.into, *touch.back, *touch.beside)
        feeds = map(str, (touch.fast, touch.slow, touch.travel))
        given = [str(touch.reading), str(touch.touch), *places, *feeds]
        return [f"O<axiscal_touch> CALL {' '.join(f'[{value}]' for value in given)}"]

    def refuse_no_tip(self, machine: Machine) -> None:
        """Raise ProgramError for a table that LinuxCNC brings no kinematics for: C on A or B is what it has."""
        rotary = [axis for axis in machine.axes if axis.rotary]
        above = machine.axes[: len(rotary)]
        if "".join(axis.name for axis in above) not in ("CA", "CB") or not all(axis.workpiece_side for axis in above):
            what = f"LinuxCNC has no kinematics for the chain {machine.chain}"
            raise ProgramError(what, "xyzac- and xyzbc-trt-kins are for w-C'-A'- and w-C'-B'-; choose another control")

    def tip_on(self, tool: str, tip: Words) -> list[str]:
        """Return the check that no offset is in force, the length of the tool, and M428.

        The length comes first: with M428 in force a new one would move the axes by tens of millimetres.
        """
        return [*_at_zero("O100", range(5221, 5227)), f"G43.1 Z{tool}", "M428"]

    def tip_off(self, axes: Words) -> list[str]:
        """Return M429, and then no tool."""
        return ["M429", "G49"]

    def tip_move(self, words: Words, feed: int) -> str:
        """Return G1: a feed is that of X Y Z, and of the rotary axes where these stay."""
        return f"G1 {' '.join(axis + value for axis, value in words)} F{feed}"

    def opening(self, number: int, axes: Sequence[Axis]) -> list[str]:
        """Return the safety line, spindle and coolant off, and exact stop."""
        return ["G21 G90 G94 G17 G40 G49 G80", "M5 M9", "G61"]

    @property
    def closing(self) -> list[str]:
        """M2."""
        return ["M2"]

    def move(self, words: Words, feed: int) -> str:
        """Return G53 G1: a feed move in machine coordinates."""
        return f"G53 G1 {' '.join(axis + value for axis, value in words)} F{feed}"

    def dwell_s(self, seconds: float) -> list[str]:
        """Return G4 P in seconds."""
        return [f"G4 P{seconds:.3f}"]


def _at_zero(label: str, numbers: range) -> list[str]:
    """Return what ends a program where an offset is in force; numbers : of the parameters of G54."""
    offsets = "+".join(f"ABS[#{number}]" for number in (5210, *numbers))
    return ["G54", f"{label} IF [{offsets} GT 0.00005]", "(MSG, G54 OR G92 IS NOT ZERO)", "M2", f"{label} ENDIF"]


def _missed(label: str) -> list[str]:
    """Return what ends a program where nothing was met."""
    said = ["(LOG,MISS R#1 T#2)", "(LOGCLOSE)", "(MSG, THE PROBE MET NOTHING)", "M2"]
    return [f"{label} IF [#5070 EQ 0]", *said, f"{label} ENDIF"]


_TOUCH = (
    "O<axiscal_touch> SUB",
    "G38.3 X#3 Y#4 Z#5 F#12",
    *_missed("O102"),
    "G91 G1 X#6 Y#7 Z#8",
    "G90 G38.3 X#3 Y#4 Z#5 F#13",
    *_missed("O103"),
    "(LOG,R#1 T#2 X#5061 Y#5062 Z#5063)",
    "G53 G1 X#9 Y#10 Z#11 F#14",
    "O<axiscal_touch> ENDSUB",
)
"""#1 reading, #2 touch, #3 where it ends if nothing is met, #6 step back, #9 beside the sphere, #12 feeds."""
