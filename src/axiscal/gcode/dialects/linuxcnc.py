"""LinuxCNC: RS-274/NGC. G53 goes with G1 and holds for its block only; G4 P is in seconds."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.exceptions import ProgramError
from axiscal.gcode.dialect import Dialect, Words
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
        offsets = "+".join(f"ABS[#{number}]" for number in (5210, *range(5221, 5227)))
        stop = [f"O100 IF [{offsets} GT 0.00005]", "(MSG, G54 OR G92 IS NOT ZERO)", "M2", "O100 ENDIF"]
        return ["G54", *stop, f"G43.1 Z{tool}", "M428"]

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
