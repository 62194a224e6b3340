"""SINUMERIK 840D: SUPA takes every offset out of its block; G4 F is in seconds."""

from __future__ import annotations

import re
from collections.abc import Sequence

from axiscal.gcode.dialect import Dialect, Words, head
from axiscal.gcode.steps import Touched
from axiscal.machine.axis import Axis


class Sinumerik(Dialect):
    """Programs for SINUMERIK 840D/828D in its own language, not in ISO mode."""

    title = "SINUMERIK"
    suffix = "MPF"
    letters = "XYZABCUVW"
    notes = (
        "Never tried on a control: run it dry first (program test, DRY), then at reduced feed.",
        "Written for the Siemens language (G291 off). SUPA leaves out every frame, also the handwheel's; D0 takes out "
        "the tool, TRAFOOF the five-axis transformation.",
        "FGROUP names all axes, so that the feed of a turning axis is in deg/min; FGREF is taken to be as delivered.",
    )

    tip_decimals = 6
    tip_needs = ("IN TOUCH - TOOL POINT ON THE WORKPIECE BY TRAORI", "NEEDS BASE FRAME AT ZERO AND THE TOOL IN D1")
    tip_notes = (
        "TRAORI is the five-axis transformation of the machine, an option; ORIAXES lets rotary axes turn evenly, "
        "which needs $MC_ORI_IPO_WITH_G_CODE = TRUE.",
        "G500 takes out the settable frames: the base frame must be zero, so that coordinates count from the "
        "machine's zero with the table at zero. D1 of the tool in the spindle holds its length.",
    )

    declared = ("DEF INT AXERR",)
    log_notes = (
        "The probing blocks were never tried on a control. MEAS = 1 takes the first measuring input; $AA_MM is in the "
        "machine's coordinates, without the tool.",
        "WRITE writes the log on at its end: _N_AX and its eight digits in the folder of part programs. It must have "
        "room (MD 11420 LEN_PROTOCOL_FILE, in kB); the program ends with a message where it has none.",
    )

    def log_on(self, code: str) -> list[str]:
        """Return the first line of the log."""
        return _written(code, f'"{head(code)}"')

    def log_off(self, code: str, readings: int) -> list[str]:
        """Return the last line of the log; behind it stands what is done where something is amiss."""
        ends = ['AXMISS: MSG("THE PROBE MET NOTHING")', "M0", "M30", 'AXFULL: MSG("THE LOG CANNOT BE WRITTEN")', "M0"]
        return [*_written(code, f'"END {readings}"'), "GOTOF AXEND", *ends, "M30", "AXEND: MSG()"]

    def touched(self, code: str, touch: Touched) -> list[str]:
        """Return MEAS = 1 twice, fast and then slowly from a short way off, the line of the log, and the way back."""
        into, back = _named(touch.words(touch.into)), _named(touch.words(touch.back))
        missed = ["STOPRE", "IF $AC_MEA[1]==0 GOTOF AXMISS"]
        shown = "".join(f'<<" {axis}"<<$AA_MM[{axis}]' for axis in touch.letters)
        return [
            *[f"MEAS=1 G1 SUPA {into} F{touch.fast}", *missed],
            f"G91 G1 {back} F{touch.fast}",
            *[f"G90 MEAS=1 G1 SUPA {into} F{touch.slow}", *missed],
            *_written(code, f'"R{touch.reading} T{touch.touch}"{shown}'),
            self.move(touch.words(touch.beside), touch.travel),
        ]

    def tip_on(self, tool: str, tip: Words) -> list[str]:
        """Return no settable frame, the tool's length, and the transformation."""
        return ["G500", "D1", "TRAORI", "ORIMKS ORIAXES"]

    def tip_off(self, axes: Words) -> list[str]:
        """Return no transformation, no tool."""
        return ["TRAFOOF", "D0"]

    def tip_move(self, words: Words, feed: int) -> str:
        """Return G1; the feed is that of all axes of FGROUP."""
        return f"G1 {_named(words)} F{feed}"

    def knows(self, name: str) -> bool:
        """Return whether an axis may have that name; A2= to C7= are directions of the tool there."""
        return super().knows(name) or re.fullmatch("[XYZUVW][1-9]", name) is not None

    def comment(self, text: str) -> str:
        """Return a comment after a semicolon."""
        return f"; {text}"

    def opening(self, number: int, axes: Sequence[Axis]) -> list[str]:
        """Return metric, absolute, mm/min, no compensation, exact stop, no transformation, spindle off."""
        names = ",".join(axis.name for axis in axes)
        return ["TRAFOOF", "G710 G90 G94 G17 G40 G60 D0", "M5 M9", f"FGROUP({names})"]

    @property
    def closing(self) -> list[str]:
        """M30."""
        return ["M30"]

    def move(self, words: Words, feed: int) -> str:
        """Return G1 SUPA: a feed move in machine coordinates; the name of an axis with a digit takes a =."""
        return f"G1 SUPA {_named(words)} F{feed}"

    def dwell_s(self, seconds: float) -> list[str]:
        """Return G4 F in seconds; it does not touch the feed of moves."""
        return [f"G4 F{seconds:.3f}"]


def _named(words: Words) -> str:
    return " ".join(axis + "=" * (len(axis) > 1) + value for axis, value in words)


def _written(code: str, text: str) -> list[str]:
    """Return what writes a line into the log, and what happens where it cannot."""
    return [f'WRITE(AXERR,"_N_AX{code}_MPF",{text})', "IF AXERR<>0 GOTOF AXFULL"]
