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

from axiscal.measurement.readers.text_file import read_text
from axiscal.units import from_unit

LISTS = "AXISCAL_PLAN_{}.txt"
"""File beside the programs that names their lists, by the code of their plan."""
_HEAD = re.compile(r"AXISCAL LOG 1 PLAN ([0-9A-F]{8}) MM")
_WHOLE = r"(\d{1,7})(?:\.0*)?"
_LENGTH = r"([+-]? *(?:\d{1,6}\.\d{0,15}|\d{1,6}|\.\d{1,15}))"
_TOUCH = re.compile(rf"R *{_WHOLE} +T *{_WHOLE} +X *{_LENGTH} *Y *{_LENGTH} *Z *{_LENGTH}")
_MISS = re.compile(rf"MISS R *{_WHOLE} +T *{_WHOLE}")
_END = re.compile(rf"END *{_WHOLE}")
_AS_WRITTEN = "Give the file as the control wrote it"
_CUT = "a run did not come to its end"
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
    file, code, running = read_text(path), "", False
    touches, said, taken = list[LoggedTouch](), list[str](), set[int]()
    for number, line in enumerate(file.lines, start=1):
        text = " ".join(_CONTROL.sub(" ", line).split())
        if begin := _HEAD.fullmatch(text):
            if code not in ("", begin[1]):
                what = "here begins the log of plan {code}, and above stands that of plan {other}"
                raise file.fail(what, "Give the log of each plan by itself", number, code=begin[1], other=code)
            said += [_CUT] * running
            code, running, taken = begin[1], True, set()
            continue
        touch, miss, end = (pattern.fullmatch(text) for pattern in (_TOUCH, _MISS, _END))
        if text and not ((touch or miss or end) and running):
            raise file.fail("{shown!r} is no line of a log, or in no run of it", _AS_WRITTEN, number, shown=text[:60])
        if touch:
            x, y, z = (float(from_unit(float(each.replace(" ", "")), "mm")) for each in touch.groups()[2:])
            touches.append(LoggedTouch(int(touch[1]), int(touch[2]), (x, y, z), number))
            taken.add(int(touch[1]))
        elif miss:
            said.append(f"at touch {miss[2]} of reading {miss[1]} the probe met nothing (line {number})")
        elif end and len(taken) != int(end[1]):
            what = "the run that ends here took {count} readings, and {taken} of them stand in the log"
            remedy = "Lines are missing: give the file as the control wrote it"
            raise file.fail(what, remedy, number, count=int(end[1]), taken=len(taken))
        running = running and not (miss or end)
    if not code:
        raise file.fail("this is no log of a measuring program", "Its first line is AXISCAL LOG 1 PLAN ... MM")
    return TouchLog(code, tuple(touches), tuple(said + [_CUT] * running))
