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
from axiscal.measurement.readers.text import read_text
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


def read_touch_log(path: str | Path) -> TouchLog:
    """Read a log; raises ReadingError for a line of another kind, or for several plans."""
    return _LogReader(str(path)).log(read_text(path).lines)


class _LogReader:
    def __init__(self, file: str) -> None:
        self._file = file
        self._codes: list[str] = []
        self._touches: list[LoggedTouch] = []
        self._said: list[str] = []
        self._run: set[int] | None = None

    def log(self, lines: Sequence[str]) -> TouchLog:
        for number, line in enumerate(lines, start=1):
            text = " ".join(_CONTROL.sub(" ", line).split())
            if text:
                self._line(text, number)
        self._unended()
        if not self._codes:
            raise self._fail("this is no log of a measuring program", "Its first line is AXISCAL LOG 1 PLAN ... MM")
        return TouchLog(self._codes[0], tuple(self._touches), tuple(self._said))

    def _line(self, text: str, line: int) -> None:
        if (found := _HEAD.fullmatch(text)) is not None:
            self._begun(found[1], line)
        elif (found := _TOUCH.fullmatch(text)) is not None:
            x, y, z = (float(from_unit(float(each.replace(" ", "")), "mm")) for each in found.groups()[2:])
            self._in_run(line).add(int(found[1]))
            self._touches.append(LoggedTouch(int(found[1]), int(found[2]), (x, y, z), line))
        elif (found := _MISS.fullmatch(text)) is not None:
            self._in_run(line)
            self._said.append(f"at touch {found[2]} of reading {found[1]} the probe met nothing (line {line})")
            self._run = None
        elif (found := _END.fullmatch(text)) is not None:
            self._ended(int(found[1]), line)
        else:
            shown = text if len(text) <= 60 else text[:57] + "..."
            remedy = "Give the file as the control wrote it"
            raise self._fail("{shown!r} is no line of a log", remedy, line, shown=shown)

    def _begun(self, code: str, line: int) -> None:
        self._unended()
        if self._codes and code != self._codes[0]:
            what = "here begins the log of plan {code}, and above stands that of plan {other}"
            raise self._fail(what, "Give the log of each plan by itself", line, code=code, other=self._codes[0])
        self._codes.append(code)
        self._run = set()

    def _in_run(self, line: int) -> set[int]:
        if self._run is None:
            what = "this touch stands outside of any run: the line that begins one is missing"
            raise self._fail(what, "Give the file as the control wrote it", line)
        return self._run

    def _ended(self, count: int, line: int) -> None:
        taken = len(self._in_run(line))
        if taken != count:
            what = "the run that ends here took {count} readings, and {taken} of them stand in the log"
            remedy = "Lines are missing: give the file as the control wrote it"
            raise self._fail(what, remedy, line, count=count, taken=taken)
        self._run = None

    def _unended(self) -> None:
        if self._run is not None:
            self._said.append("a run did not come to its end")
        self._run = None

    def _fail(self, what: str, remedy: str, line: int | None = None, **values: object) -> ReadingError:
        return ReadingError(what, remedy, self._file, line, **values)
