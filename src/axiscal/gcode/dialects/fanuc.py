"""FANUC: G53 is always a rapid there, so moves are G1 in G54, and the program proves that G54 is the machine's zero."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.gcode.dialect import Dialect, Words, head
from axiscal.gcode.steps import Touched
from axiscal.machine.axis import Axis

_FIRST = 1000
"""Programs are called O1001, O1002 …"""
_OPEN = "POPEN"
_ARRIVED = "0.003"
"""mm: a G31 that ends so near to its end has met nothing; a touch is a millimetre and more before it."""
_GENTLE = 500
"""mm/min, for a block that is not to move at all."""


class Fanuc(Dialect):
    """Programs for FANUC milling controls (G-code of the M series) with custom macro B.

    #4008 is the tool length offset in force (B-63944EN, system variables), #5021… the machine position of each axis,
    #5041… its position in the work coordinates in force; where they agree for every axis, G54 is the machine's zero.
    """

    title = "FANUC"
    suffix = "NC"
    decimals = 3
    notes = (
        "Never tried on a control: run it with machine lock and dry run first, then at reduced feed.",
        "G53 would be a rapid here, so moves are G1 in G54. Set G54 and the external offset to zero for every axis "
        "first; custom macro B must be there. The program compares machine and work position after each of "
        "its stops, and ends with alarm 3001 if they differ or if a tool length offset is in force.",
        "The comparison takes the control's first axes, as many as the machine description has: they must be these.",
        "No rotation, scaling, mirror image, tilted plane or tool centre point control may be in force.",
        "Coordinates have three decimals (IS-B): a reading is where the list says, which may be 0.0005 off the plan.",
        "G61 (exact stop) is in force while the program runs and G64 (cutting mode) after it.",
        "Programs are O1001, O1002 and so on, one for each set-up: rename them where these numbers are taken.",
    )

    tip_decimals = 3
    from_zero = True
    tip_needs = ("IN TOUCH - TOOL POINT ON THE TABLE BY G43.4", "NEEDS G54 AT THE MACHINE ZERO AND THE TOOL IN H1")
    tip_notes = (
        "G43.4 is an option. The coordinates must be those of the table (parameter 19696 bit 5, WKP = 0) as it stands "
        "when G43.4 comes, which is at zero; bit 6, RFC = 1, makes the feed hold where only rotary axes turn.",
        "H1 must hold the length of the tool as the machine description has it. G43.4 and G49 come with the place "
        "where the machine stands already, so that neither moves an axis.",
    )

    log_notes = (
        "The probing blocks were never tried on a control. G31 takes the skip input; #5061 to #5063 are where it came, "
        "to a thousandth of a millimetre under IS-B, which adds 0.3 um of scatter.",
        "X, Y, Z must be the control's first three axes. DPRNT sends the log to the device of parameter 0020, a "
        "computer on the serial line or a memory card: start receiving before the program.",
    )

    def log_on(self, code: str) -> list[str]:
        """Return the first line of the log."""
        return [_OPEN, _printed(head(code))]

    def log_off(self, code: str, readings: int) -> list[str]:
        """Return the last line of the log; behind it stands what is done where nothing is met."""
        missed = ["N9001 PCLOS", "#3000=2(THE PROBE MET NOTHING)", "N9002"]
        return [_printed(f"END {readings}"), "PCLOS", "GOTO9002", *missed]

    def touched(self, code: str, touch: Touched) -> list[str]:
        """Return G31 twice, fast and then slowly from a short way off, the line of the log, and the way back."""
        into, back = _joined(touch.words(touch.into)), _joined(touch.words(touch.back))
        apart = "+".join(f"ABS[#{5061 + k}-[{value}]]" for k, value in enumerate(touch.into))
        missed = f"IF[{apart}LT{_ARRIVED}]GOTO9001"
        shown = "".join(f"*{axis}#{5061 + k}[54]" for k, axis in enumerate(touch.letters))
        return [
            *[f"G31 {into} F{touch.fast}", missed],
            f"G91 G1 {back} F{touch.fast}",
            *[f"G90 G31 {into} F{touch.slow}", missed],
            f"DPRNT[R{touch.reading}*T{touch.touch}{shown}]",
            self.move(touch.words(touch.beside), touch.travel),
        ]

    def tip_on(self, tool: str, tip: Words) -> list[str]:
        """Return G43.4 with the place of the tool point, at which it is."""
        return [f"G1 G43.4 {' '.join(axis + value for axis, value in tip)} H1 F{_GENTLE}"]

    def tip_off(self, axes: Words) -> list[str]:
        """Return G49 with the place of the machine, at which it is."""
        return [f"G1 G49 {' '.join(axis + value for axis, value in axes)} F{_GENTLE}"]

    def tip_move(self, words: Words, feed: int) -> str:
        """Return G1 on the table."""
        return f"G1 {_joined(words)} F{feed}"

    def opening(self, number: int, axes: Sequence[Axis]) -> list[str]:
        """Return number, check, safety line, spindle and coolant off, exact stop.

        G49 alone may move an axis, so it must be in force. In cutting mode (G64) a block begins while the one before
        still brakes: an overrun would be cut short.
        """
        return [
            "%",
            f"O{_FIRST + number}",
            "IF[#4008NE49]GOTO9000",
            "G21 G90 G94 G17 G40 G49 G80",
            "M5",
            "M9",
            "G54",
            "G61",
        ]

    def stop(self, axes: Sequence[Axis]) -> list[str]:
        """Return M0, which also ends reading ahead, and then the proof that G54 is the machine's zero.

        Offsets may have been changed at the stop, and jogging with manual absolute off shifts them.
        """
        return ["M0", *(f"IF[ABS[#{5021 + k}-#{5041 + k}]GT0.0005]GOTO9000" for k in range(len(axes)))]

    def framed(self, name: str, number: int, axes: Sequence[Axis], lines: Sequence[str], logs: bool = False) -> str:
        """Return the program; where the log is open, the alarm of the checks closes it first."""
        if not logs:
            return super().framed(name, number, axes, lines)
        at = list(lines).index(_OPEN)
        closes = [*lines[:at], *(line.replace("GOTO9000", "GOTO9003") for line in lines[at:])]
        return super().framed(name, number, axes, closes, logs).replace("\nN9000 ", "\nN9003 PCLOS\nN9000 ")

    @property
    def closing(self) -> list[str]:
        """The usual cutting mode, M30, and the alarm that the checks lead to."""
        return ["G64", "M30", "N9000 #3000=1(NOT IN MACHINE COORDINATES)", "%"]

    def move(self, words: Words, feed: int) -> str:
        """Return G1 in G54, which has been proven to be the machine's zero."""
        return f"G1 {_joined(words)} F{feed}"

    def dwell_s(self, seconds: float) -> list[str]:
        """Return G4 P, which is a whole number of milliseconds."""
        return [f"G4 P{round(seconds * 1000)}"]


def _joined(words: Words) -> str:
    return " ".join(axis + value for axis, value in words)


def _printed(text: str) -> str:
    """Return what sends a line of text; a star is a blank."""
    return f"DPRNT[{text.replace(' ', '*')}]"
