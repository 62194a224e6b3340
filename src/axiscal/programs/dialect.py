"""A control's words for the few things that a measuring program does, as data: one writer fills them in.

Blanks in braces are filled in: {to} axes with where they go, {feed} mm/min or deg/min. The fields below name every
other one. Nothing that a person wrote is filled in but names of axes and of programs, which are plain words.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from axiscal.exceptions import ProgramError
from axiscal.programs.steps import Touched
from axiscal_core.axes import Axis

LETTERS = "XYZABCUVW"
Lines = tuple[str, ...]
Words = Sequence[tuple[str, str]]
"""Names of axes with where they go, as text in mm or deg."""


def head(code: str) -> str:
    """Return the first line of a log: lengths are in mm, the plan is that of the code."""
    return f"AXISCAL LOG 1 PLAN {code} MM"


@dataclass(frozen=True, slots=True, kw_only=True)
class Log:
    """How a control touches a sphere by itself and writes a log, which is written on at its end.

    on, off : open it with its first line {head}, and write how many {readings} there were and close it; {code}
    settled : in `on`, turns each rotary {axis} exactly to where it stands, parameter {place}, a word of a straight move
    touch : meets one side from beside it, fast and slowly, writes it down and goes back; ends the program where nothing
    is met. {all} : its numbers in brackets
    notes : what must be known
    """

    on: Lines
    off: Lines
    touch: Lines
    notes: Lines
    settled: str = ""

    def opened(self, axes: Sequence[Axis], **told: str) -> list[str]:
        """Return what opens it."""
        names = [axis.name for axis in axes if axis.rotary]
        turns = " ".join(self.settled.format(axis=name, place=5420 + LETTERS.find(name)) for name in names)
        settled = f"G53 G1 {turns}" if turns else ""
        return [line for line in filled(self.on, settled=settled, **told) if line]


@dataclass(frozen=True, slots=True, kw_only=True)
class Dialect:
    """One control's words.

    title : its name for people; suffix : of its files; notes : what must be known of it
    opening : puts the control into a known state, {name} {number} of the program, {axes} by commas, {zeros} each with a
        nought: nothing in force scales, mirrors, turns or offsets a motion then; closing : ends it
    move : a straight move in machine coordinates; dwell : a wait, {s} seconds or {ms} whole milliseconds
    stop : halts until somebody presses start; proof : checked after it for each axis, from {first} and {second} on
    comment : a line of its own, of plain words {text}
    screen : the same on the operator's screen, where a comment is not seen there
    axes : what an axis may be called; decimals : of a coordinate; longest_name : of a program
    signed : coordinates have a plus; numbered : so have blocks a number
    log : None where it writes none
    """

    title: str
    suffix: str
    notes: Lines
    opening: Lines
    closing: Lines
    move: str
    dwell: Lines
    stop: Lines = ("M0",)
    proof: str | None = None
    comment: str = "({text})"
    screen: str | None = None
    axes: str = f"[{LETTERS}]"
    decimals: int = 4
    longest_name: int = 24
    signed: bool = False
    numbered: bool = False
    log: Log | None = None

    def check_axes(self, axes: Iterable[Axis]) -> None:
        """Raise ProgramError for an axis that the control has no name for."""
        for axis in axes:
            if not re.fullmatch(self.axes, axis.name):
                what = "{control} programs have no axis {axis}"
                remedy = "Name the axes of the machine by the letters {letters}"
                raise ProgramError(what, remedy, control=self.title, axis=axis.name, letters=" ".join(LETTERS))

    def logging(self) -> Log:
        """Return how the control writes a log; raises ProgramError where it writes none."""
        if self.log is None:
            remedy = "Leave --log out: the program stops at each sphere for the control's own cycle"
            raise ProgramError("{control} programs write no log", remedy, control=self.title)
        return self.log

    def framed(self, name: str, number: int, axes: Sequence[Axis], lines: Iterable[str]) -> str:
        """Return the whole text of a program; number : 1 for the first of a plan."""
        given = {"name": name, "number": number, "axes": ",".join(axis.name for axis in axes)}
        given["zeros"] = " ".join(f"{axis.name}0" for axis in axes)
        blocks = [*filled(self.opening, **given), *lines, *filled(self.closing, **given)]
        if self.numbered:
            blocks = [f"{place} {block}" for place, block in enumerate(blocks)]
        return "\n".join(blocks) + "\n"

    def words(self, words: Words) -> str:
        """Return axes with where they go; the name of an axis with a digit takes a =."""
        plus = "+" if self.signed else ""
        return " ".join(
            axis + "=" * (len(axis) > 1) + ("" if value.startswith("-") else plus) + value for axis, value in words
        )

    def straight_move(self, words: Words, feed: int | str) -> str:
        """Return a straight move in machine coordinates."""
        return self.move.format(to=self.words(words), feed=feed)

    def stopped(self, axes: Sequence[Axis]) -> list[str]:
        """Return what halts the program, and proves afterwards that its coordinates are the machine's."""
        proofs = (self.proof.format(first=5021 + k, second=5041 + k) for k in range(len(axes)) if self.proof)
        return [*self.stop, *proofs]

    def touched(self, touch: Touched) -> list[str]:
        """Return what touches one side and writes it down; where nothing is met the program ends with a message."""
        numbers = (touch.reading, touch.touch, *touch.into, *touch.back, *touch.beside)
        feeds = touch.fast, touch.slow, touch.travel
        return filled(self.logging().touch, all=" ".join(f"[{number}]" for number in (*numbers, *feeds)))


def filled(lines: Iterable[str], **values: object) -> list[str]:
    """Return lines with their blanks filled in."""
    return [line.format(**values) for line in lines]
