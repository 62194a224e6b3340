"""LinuxCNC: RS-274/NGC. G53 goes with G1 and holds for its block only; G4 P is in seconds."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.gcode.dialect import Dialect, Words
from axiscal.machine.axis import Axis


class LinuxCNC(Dialect):
    """Programs for LinuxCNC 2.8 or later, set up in mm or in inches: G21 holds for machine coordinates too."""

    title = "LinuxCNC"
    suffix = "ngc"
    notes = (
        "Tried on LinuxCNC's own interpreter (rs274), not on a machine.",
        "Coordinates are in mm (G21) and deg, whatever LINEAR_UNITS says: tried with mm and with inch.",
        "Rotary axes must not be WRAPPED_ROTARY, and a five-axis kinematics must be in its joint (identity) mode.",
    )

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
