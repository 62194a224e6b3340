"""The log that a measuring program writes on its control: one line for each touch, in the words of any of them.

    AXISCAL LOG 1 PLAN 3F2A9C01 MM
    R12 T1 X101.234567 Y-3.2 Z40.
    END 24

Each run of a program begins with the first line and ends with the last. Controls may pad numbers with blanks, write 12.
for 12 and 12.000000, leave out a zero before the point, or send control characters. Nothing else is let through.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from axiscal.exceptions import ReadingError
from axiscal.measurement.readers.text_file import TextFile, read_text
from axiscal.units import from_unit

LISTS = "AXISCAL_PLAN_{}.txt"
"""File beside the programs that names their lists, by the code of their plan."""
_HEAD = re.compile(r"AXISCAL LOG 1 PLAN ([0-9A-F]{8}) MM")
_WHOLE = r"(\d{1,7})(?:\.0*)?"
_LENGTH = r"([+-]? *(?:\d{1,6}\.\d{0,15}|\d{1,6}|\.\d{1,15}))"
_TOUCH = re.compile(rf"R *{_WHOLE} +T *{_WHOLE} +X *{_LENGTH} *Y *{_LENGTH} *Z *{_LENGTH}")
_MISS = re.compile(rf"MISS R *{_WHOLE} +T *{_WHOLE}")
_END = re.compile(rf"END *{_WHOLE}")
_CONTROL = re.compile(r"[\x00-\x08\x0e-\x1f\x7f%]")
"""Device codes of a serial line, and the sign that begins and ends a tape."""


@dataclass(frozen=True, slots=True)
class LoggedTouch:
    """One touch: number of the reading and of the touch, where the linear axes X, Y, Z stood, m, and its line."""

    reading: int
    touch: int
    at: tuple[float, float, float]
    line: int


@dataclass(frozen=True, slots=True)
class TouchLog:
    """All touches of a log in their order, the code of their plan, and the gaps that the log states."""

    code: str
    touches: tuple[LoggedTouch, ...]
    said: tuple[str, ...]


def plan_code(listings: Sequence[str]) -> str:
    """Return the code of a plan, by the lists of its programs: eight hexadecimal digits."""
    return hashlib.sha256("\0".join(listings).encode()).hexdigest()[:8].upper()


_Line = tuple[int, re.Pattern[str], Sequence[str]]
"""A line of a log: its number, which kind of line it is, and what it says."""


def read_touch_log(path: str | Path) -> TouchLog:
    """Read a log; raises ReadingError for a line of another kind, or for several plans."""
    file = read_text(path)
    texts = (" ".join(_CONTROL.sub(" ", line).split()) for line in file.lines)
    lines = [_understood(file, number, text) for number, text in enumerate(texts, start=1) if text]
    if not lines:
        raise file.fail("this is no log of a measuring program", "Its first line is AXISCAL LOG 1 PLAN ... MM")
    begins = [i for i, (_, kind, _) in enumerate(lines) if kind is _HEAD]
    if begins[:1] != [0]:
        raise _outside(file, lines[0])
    code, touches, said = lines[0][2][0], list[LoggedTouch](), list[str]()
    for begin, end in zip(begins, [*begins[1:], len(lines)], strict=True):
        number, _, (other,) = lines[begin]
        if other != code:
            what = "here begins the log of plan {code}, and above stands that of plan {other}"
            raise file.fail(what, "Give the log of each plan by itself", number, code=other, other=code)
        taken, gap = _run(file, lines[begin + 1 : end])
        touches += taken
        said += gap
    return TouchLog(code, tuple(touches), tuple(said))


def _understood(file: TextFile, number: int, text: str) -> _Line:
    for kind in (_HEAD, _TOUCH, _MISS, _END):
        if (found := kind.fullmatch(text)) is not None:
            return number, kind, found.groups()
    shown = text if len(text) <= 60 else text[:57] + "..."
    raise file.fail("{shown!r} is no line of a log", "Give the file as the control wrote it", number, shown=shown)


def _run(file: TextFile, lines: Sequence[_Line]) -> tuple[list[LoggedTouch], list[str]]:
    """Return the touches of a run, and the gap that its end states; lines : those behind the first."""
    ends = next((i for i, (_, kind, _) in enumerate(lines) if kind is not _TOUCH), len(lines))
    touches = list[LoggedTouch]()
    for number, _, words in lines[:ends]:
        x, y, z = (float(from_unit(float(each.replace(" ", "")), "mm")) for each in words[2:])
        touches.append(LoggedTouch(int(words[0]), int(words[1]), (x, y, z), number))
    if ends == len(lines):
        return touches, ["a run did not come to its end"]
    if lines[ends + 1 :]:
        raise _outside(file, lines[ends + 1])
    number, kind, words = lines[ends]
    if kind is _MISS:
        return touches, [f"at touch {words[1]} of reading {words[0]} the probe met nothing (line {number})"]
    count, taken = int(words[0]), len({touch.reading for touch in touches})
    if taken != count:
        what = "the run that ends here took {count} readings, and {taken} of them stand in the log"
        remedy = "Lines are missing: give the file as the control wrote it"
        raise file.fail(what, remedy, number, count=count, taken=taken)
    return touches, []


def _outside(file: TextFile, line: _Line) -> ReadingError:
    what = "this touch stands outside of any run: the line that begins one is missing"
    return file.fail(what, "Give the file as the control wrote it", line[0])
