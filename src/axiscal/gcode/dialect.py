"""What a control calls the few things that a measuring program does."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar

from axiscal.exceptions import ProgramError
from axiscal.gcode.steps import Touched
from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine


def head(code: str) -> str:
    """Return the first line of a log: lengths are in mm, the plan is that of the code."""
    return f"AXISCAL LOG 1 PLAN {code} MM"


Words = Sequence[tuple[str, str]]
"""Names of axes with where they go, as text in mm or deg."""


class Dialect(ABC):
    """One control's words.

    title : its name for people; suffix : of its files; decimals : of a coordinate; longest_name : of a program
    letters : of the axes that it knows; notes : what must be known of it
    tip_decimals : of a place of the tool point, mm; tip_needs : which mode and zero that needs, for the head
    tip_notes : what must be known of that mode; from_zero : it takes the table as it stands when the mode begins
    declared : lines that a program with a log begins with; log_notes : what must be known of its log
    """

    title: ClassVar[str]
    suffix: ClassVar[str]
    decimals: ClassVar[int] = 4
    longest_name: ClassVar[int] = 24
    letters: ClassVar[str] = "XYZABCUVW"
    notes: ClassVar[tuple[str, ...]]
    tip_decimals: ClassVar[int] = 4
    tip_needs: ClassVar[tuple[str, ...]]
    tip_notes: ClassVar[tuple[str, ...]]
    from_zero: ClassVar[bool] = False
    declared: ClassVar[tuple[str, ...]] = ()
    log_notes: ClassVar[tuple[str, ...]]

    def check(self, axes: Sequence[Axis]) -> None:
        """Raise ProgramError for an axis that the control has no name for."""
        for axis in axes:
            if not self.knows(axis.name):
                what = f"{self.title} programs have no axis {axis.name}"
                raise ProgramError(what, f"Name the axes of the machine by the letters {' '.join(self.letters)}")

    def knows(self, name: str) -> bool:
        """Return whether an axis may have that name."""
        return len(name) == 1 and name in self.letters

    def comment(self, text: str) -> str:
        """Return a comment of its own line; `text` is of plain words."""
        return f"({text})"

    def framed(self, name: str, number: int, axes: Sequence[Axis], lines: Sequence[str], logs: bool = False) -> str:
        """Return the whole text of a program; number : 1 for the first of a plan; logs : whether it writes a log."""
        declared = self.declared if logs else ()
        return "\n".join([*declared, *self.opening(number, axes), *lines, *self.closing]) + "\n"

    @abstractmethod
    def log_on(self, code: str) -> list[str]:
        """Return what opens the log of a plan, which is written on at its end, with its first line.

        code : of the plan, eight hexadecimal digits
        """

    @abstractmethod
    def log_off(self, code: str, readings: int) -> list[str]:
        """Return what writes the last line of the log and closes it.  readings : how many the program takes"""

    @abstractmethod
    def touched(self, code: str, touch: Touched) -> list[str]:
        """Return what touches one side and writes it down; where nothing is met the program ends with a message."""

    def log_files(self, code: str) -> dict[str, str]:
        """Return files that the control needs besides, by name."""
        return {}

    def stop(self, axes: Sequence[Axis]) -> list[str]:
        """Return what halts the program until somebody presses start."""
        return ["M0"]

    def refuse_no_tip(self, machine: Machine) -> None:
        """Raise ProgramError where the control cannot hold the tool point of such a machine."""
        if not {"X", "Y", "Z"} <= {axis.name for axis in machine.axes}:
            raise ProgramError("a tool point is held by X, Y and Z", "Name the linear axes of the machine so")

    @property
    def pause(self) -> list[str]:
        """What halts the program while the tool point is held."""
        return ["M0"]

    @abstractmethod
    def tip_on(self, tool: str, tip: Words) -> list[str]:
        """Return what makes X Y Z those of the tool point on the workpiece.  tool : length, mm; tip : where it is"""

    @abstractmethod
    def tip_off(self, axes: Words) -> list[str]:
        """Return what makes them those of the machine again.  axes : where these are"""

    @abstractmethod
    def tip_move(self, words: Words, feed: int) -> str:
        """Return a straight move of the tool point on the workpiece, rotary axes in step.

        feed : mm/min of the tool point, deg/min where it stays
        """

    timed: ClassVar[tuple[str, str] | None] = ("G93", "G94")
    """What makes F the number of moves a minute, and what ends that; None where the control has nothing of the kind."""

    def timed_move(self, words: Words, seconds: float) -> str:
        """Return a straight move of all axes in machine coordinates that takes so long."""
        return re.sub(r" F\d+", f" F{60 / seconds:.4f}", self.move(words, 1), count=1)

    @abstractmethod
    def opening(self, number: int, axes: Sequence[Axis]) -> list[str]:
        """Return the lines that put the control into a known state."""

    @property
    @abstractmethod
    def closing(self) -> list[str]:
        """The lines that end a program."""

    @abstractmethod
    def move(self, words: Words, feed: int) -> str:
        """Return a straight move in machine coordinates; feed : mm/min or deg/min."""

    @abstractmethod
    def dwell_s(self, seconds: float) -> list[str]:
        """Return a wait, in the control's own unit of time."""
