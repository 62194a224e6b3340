"""A control's words for the few things that a measuring program does, as data: one writer fills them in.

`dialects.toml` has ours, as the controls' manuals have them. Blanks in braces are filled in: {to} axes with where they
go, {feed} mm/min or deg/min; the fields below name every other one. Nothing that a person wrote is filled in but names
of axes and of programs, which are plain words.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Annotated

from pydantic import BeforeValidator, TypeAdapter

from axiscal.document import meant, shown
from axiscal.document.ports import names, of_class, one_of
from axiscal.exceptions import ProgramError
from axiscal.programs.steps import Touched
from axiscal_core.axes import Axis

PORTS = "axiscal.dialects"
"""Group of the entry points by which packages bring words of a control."""
LETTERS = "XYZABCUVW"
Lines = Annotated[tuple[str, ...], BeforeValidator(lambda told: told.splitlines() if isinstance(told, str) else told)]
Words = Sequence[tuple[str, str]]
"""Names of axes with where they go, as text in mm or deg."""


def filled(lines: Iterable[str], **values: object) -> list[str]:
    """Return lines with their blanks filled in."""
    return [line.format(**values) for line in lines]


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

    def opened(self, axes: Sequence[Axis], code: str) -> list[str]:
        """Return what opens it: lengths are in mm, the plan is that of the code."""
        places = ((axis.name, 5420 + LETTERS.find(axis.name)) for axis in axes if axis.rotary)
        turns = " ".join(self.settled.format(axis=name, place=place) for name, place in places)
        told = {"code": code, "head": f"AXISCAL LOG 1 PLAN {code} MM", "settled": turns and f"G53 G1 {turns}"}
        return [line for line in filled(self.on, **told) if line]


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
    proof: str = ""
    comment: str = "({text})"
    screen: str = ""
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
                remedy = "Name the axes of the machine by the letters {letters}"
                what, letters = "{control} programs have no axis {axis}", " ".join(LETTERS)
                raise ProgramError(what, remedy, control=self.title, axis=axis.name, letters=letters)

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
        return "".join(f"{place} {block}\n" if self.numbered else f"{block}\n" for place, block in enumerate(blocks))

    def straight_move(self, words: Words, feed: int) -> str:
        """Return a straight move in machine coordinates; the name of an axis with a digit takes a =."""
        plus = "+" if self.signed else ""
        each = (axis + "=" * (len(axis) > 1) + plus * (at[0] != "-") + at for axis, at in words)
        return self.move.format(to=" ".join(each), feed=feed)

    def stopped(self, axes: int) -> list[str]:
        """Return what halts the program, and proves afterwards that its coordinates are the machine's."""
        return [*self.stop, *(self.proof.format(first=5021 + k, second=5041 + k) for k in range(axes) if self.proof)]

    def touched(self, touch: Touched) -> list[str]:
        """Return what touches one side and writes it down; where nothing is met the program ends with a message."""
        numbers = (touch.reading, touch.touch, *touch.into, *touch.back, *touch.beside)
        feeds = touch.fast, touch.slow, touch.travel
        return filled(self.logging().touch, all=" ".join(f"[{number}]" for number in (*numbers, *feeds)))


_OURS = TypeAdapter(dict[str, Dialect]).validate_python(
    tomllib.loads(resources.files(__package__).joinpath("dialects.toml").read_text(encoding="utf-8"))
)
LINUXCNC = _OURS["linuxcnc"]


def controllers() -> tuple[str, ...]:
    """Return the names of the controls that axiscal knows itself."""
    return tuple(_OURS)


def dialect(controller: str) -> Dialect:
    """Return the words of a control; raises ProgramError for one that is not known."""
    found = _OURS.get(controller.casefold()) or one_of(PORTS, controller)
    if found is None:
        remedy = meant(controller, (*_OURS, *names(PORTS)), quoted="{}")
        what = "{name} is not a controller that programs can be written for"
        raise ProgramError(what, remedy, name=shown(controller))
    words: Dialect = of_class(controller, found, Dialect)
    return words
