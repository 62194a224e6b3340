"""A part program as its motions: a strict modal reader of G-code, which refuses every word that it does not know.

Lines that move nothing stay as they are. A motion is split into what stands before it, its way, and what ends it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from axiscal.exceptions import ReadingError
from axiscal.measurement.readers.text_file import TextFile
from axiscal.units import from_unit

Code = Literal[0, 1, 2, 3]
Plane = tuple[int, int, int]
"""Two axes that turn from the first to the second about the third, by their places in XYZ."""
Spot = tuple[float, float, float]
"""X, Y, Z, m, NaN where nobody knows."""

_LETTERS, _CENTRES = "XYZ", "IJK"
_PLANES: Mapping[str, Plane] = {"17": (0, 1, 2), "18": (2, 0, 1), "19": (1, 2, 0)}
"""By G17, G18 and G19 (RS274/NGC)."""
_UNITS: Mapping[str, Literal["mm", "in"]] = {"21": "mm", "20": "in"}
_OFFSETS = ("54", "55", "56", "57", "58", "59", "59.1", "59.2", "59.3")
_HOME = ("28", "30", "53")
_KEPT = frozenset(
    {*_PLANES, *_UNITS, *_OFFSETS, *_HOME, "4", "40", "43", "49", "61", "61.1", "64", "80", "94", "95", "96", "97"}
)
_FORMS = ("90", "91", "90.1", "91.1")
_MOTIONS: Mapping[str, Code] = {"0": 0, "1": 1, "2": 2, "3": 3}
"""By G0 to G3 (RS274/NGC)."""
_AT_ONCE, _AT_END = ("3", "4", "5", "6", "7", "8", "9", "48", "49"), ("0", "1", "2", "30")
_COMMENT = re.compile(r"\([^()]*\)|;.*")
_WORD = re.compile(r"([A-Z])([-+]?(?:\d+\.?\d*|\.\d+))")
_SAME = 5e-6
"""m, by which the ends of an arc may differ in their distance from its centre: what four decimals of an inch leave."""


@dataclass(frozen=True, slots=True)
class PartMotion:
    """A way from start to end.  code : G0 to G3; of an arc centre and plane, G2 turns against the plane's sense."""

    code: Code
    start: Spot
    end: Spot
    centre: Spot = (0.0, 0.0, 0.0)
    plane: Plane = (0, 1, 2)

    @property
    def known(self) -> bool:
        """Whether it is known where it begins."""
        return not any(map(math.isnan, self.start))

    @property
    def turn(self) -> tuple[float, float]:
        """The angle at which an arc begins and by how much it turns, rad."""
        u, v, _ = self.plane
        first, last = (math.atan2(p[v] - self.centre[v], p[u] - self.centre[u]) for p in (self.start, self.end))
        sign = 1.0 if self.code == 3 else -1.0
        whole = math.dist((self.start[u], self.start[v]), (self.end[u], self.end[v])) < 1e-9
        return first, sign * (math.tau if whole else (sign * (last - first)) % math.tau)


@dataclass(frozen=True, slots=True)
class PartLine:
    """A line.  text : all of it, of a motion what stands before it; after : what stands behind; unit : of lengths"""

    line: int
    text: str
    motion: PartMotion | None = None
    after: str = ""
    unit: Literal["mm", "in"] = "mm"


@dataclass(frozen=True, slots=True)
class _Modes:
    """What is in force.  code : of motions; at : where the tool stands; offset, tool : those in use, "" before any"""

    unit: Literal["mm", "in"]
    code: Code | None = None
    plane: Plane = (0, 1, 2)
    absolute: bool = True
    from_start: bool = True
    at: Spot = (math.nan, math.nan, math.nan)
    offset: str = ""
    tool: str = ""


def read_program(file: TextFile, unit: Literal["mm", "in"] = "mm") -> tuple[PartLine, ...]:
    """Return the lines of a program; raises ReadingError at a line with a word that is not known.

    unit : of lengths before G20 or G21
    """
    modes, blocks = _Modes(unit), list[PartLine]()
    for number, line in enumerate(file.lines, 1):
        block, modes = _LineReader(file, number, line, modes).read()
        blocks.append(block)
    return tuple(blocks)


class _LineReader:
    """Reads one line under the modes that are in force."""

    def __init__(self, file: TextFile, number: int, text: str, modes: _Modes) -> None:
        self._file, self._number, self._text, self._modes = file, number, text, modes
        self._words = list(self._split())

    def fail(self, what: str, remedy: str, **values: object) -> ReadingError:
        """Return the error that places a fault in this line."""
        return self._file.fail(what, remedy, self._number, **values)

    def _split(self) -> Iterator[tuple[str, str]]:
        bare = re.sub(r"\s+", "", _COMMENT.sub("", self._text)).upper().strip("%")
        while bare:
            found = _WORD.match(bare)
            if found is None:
                remedy = "Take the line out, or write the program without subroutines, variables and settings"
                raise self.fail("{text} is no word of a program that can be rewritten", remedy, text=repr(bare[:20]))
            yield found[1], found[2]
            bare = bare[found.end() :]

    def read(self) -> tuple[PartLine, _Modes]:
        """Return the line, and the modes behind it."""
        codes = [_plain(value) for letter, value in self._words if letter == "G"]
        numbers = self._numbers()
        modes = self._in_force(codes)
        home = any(code in _HOME for code in codes)
        if home or "4" in codes:
            lost = [letter in numbers or not set(_LETTERS) & set(numbers) for letter in _LETTERS]
            gone = tuple(math.nan if home and away else at for at, away in zip(modes.at, lost, strict=True))
            counted = home and not modes.absolute
            text, after = ("G91 " * counted + self._said("")), "G90" * counted
            return PartLine(self._number, text, None, after, modes.unit), replace(modes, at=(gone[0], gone[1], gone[2]))
        if not {*_LETTERS, *_CENTRES, "R"} & set(numbers):
            return PartLine(self._number, self._said(""), unit=modes.unit), modes
        return self._moved(modes, numbers)

    def _numbers(self) -> dict[str, float]:
        """Return the words of places, m, and others by letter; raises ReadingError for those that are not known."""
        found = dict[str, float]()
        remedy = "Write the program without it: rotary axes, offsets, cycles and other settings are not rewritten"
        for letter, value in self._words:
            known = letter in "XYZIJKRFSTNPHQ" if letter not in "GM" else self._knows(letter, _plain(value))
            if not known:
                raise self.fail("{word} is not understood", remedy, word=letter + value)
            if letter in found:
                raise self.fail("{letter} stands twice in this line", "Keep one of them", letter=letter)
            if letter not in "GM":
                found[letter] = float(value)
        return found

    def _knows(self, letter: str, code: str) -> bool:
        return code in (_AT_ONCE + _AT_END if letter == "M" else {*_KEPT, *_FORMS, *_MOTIONS})

    def _in_force(self, codes: Sequence[str]) -> _Modes:
        """Return the modes with what this line changes."""
        modes = self._modes
        motions = [code for code in codes if code in _MOTIONS]
        if len(motions) > 1:
            raise self.fail("two motions stand in one line", "Write a line for each")
        for code in codes:
            if code in _OFFSETS and modes.offset not in ("", code):
                what, remedy = "G{code} is another work offset than G{first}", "Write a program for each offset"
                raise self.fail(what, remedy, code=code, first=modes.offset)
            modes = replace(
                modes,
                unit=_UNITS.get(code, modes.unit),
                plane=_PLANES.get(code, modes.plane),
                code=None if code == "80" else _MOTIONS.get(code, modes.code),
                absolute={"90": True, "91": False}.get(code, modes.absolute),
                from_start={"90.1": False, "91.1": True}.get(code, modes.from_start),
                offset=code if code in _OFFSETS else modes.offset,
            )
        tool = next((_plain(value) for letter, value in self._words if letter == "T"), modes.tool)
        if tool != modes.tool and modes.tool not in ("", "0"):
            what, remedy = "T{tool} is another tool than T{first}", "Write a program for each tool"
            raise self.fail(what, remedy, tool=tool, first=modes.tool)
        return replace(modes, tool=tool)

    def _moved(self, modes: _Modes, numbers: Mapping[str, float]) -> tuple[PartLine, _Modes]:
        """Return a motion, and the modes with the tool at its end."""
        if modes.code is None:
            raise self.fail("it is not said how the tool goes there", "Write G0, G1, G2 or G3 in this line")
        if not modes.absolute and any(letter in numbers and math.isnan(at) for letter, at in self._axes(modes)):
            raise self.fail("it is not known from where G91 counts", "Go to a place with G90 first")
        places = {
            key: float(from_unit(numbers[key], modes.unit)) for key in (*_LETTERS, *_CENTRES, "R") if key in numbers
        }
        ends = [
            (0.0 if modes.absolute else at) + places[letter] if letter in places else at
            for letter, at in self._axes(modes)
        ]
        end = ends[0], ends[1], ends[2]
        if modes.code and any(map(math.isnan, end)):
            lost = next(letter for letter, at in zip(_LETTERS, end, strict=True) if math.isnan(at))
            raise self.fail("it is not known where {axis} stands here", "Go to X, Y and Z with G0 before", axis=lost)
        motion = PartMotion(modes.code, modes.at, end)
        if modes.code > 1:
            motion = replace(motion, plane=modes.plane, centre=self._centre(motion, modes, places))
        late = " ".join(
            f"M{_plain(value)}" for letter, value in self._words if letter == "M" and _plain(value) in _AT_END
        )
        return PartLine(self._number, self._said("XYZIJKRN"), motion, late, modes.unit), replace(modes, at=end)

    def _axes(self, modes: _Modes) -> Iterator[tuple[str, float]]:
        return zip(_LETTERS, modes.at, strict=True)

    def _centre(self, motion: PartMotion, modes: _Modes, places: Mapping[str, float]) -> Spot:
        if not motion.known:
            raise self.fail("it is not known where this arc begins", "Go to X, Y and Z with G0 before")
        u, v, w = modes.plane
        centre = list(motion.start)
        if "R" in places:
            across = math.dist((motion.start[u], motion.start[v]), (motion.end[u], motion.end[v])) / 2
            if not 0 < across <= abs(places["R"]) + _SAME:
                raise self.fail("no circle of this radius goes through both ends", "Write its centre as I, J, K")
            sign = math.copysign(1.0, places["R"]) * (1.0 if motion.code == 3 else -1.0)
            aside = sign * math.sqrt(max(places["R"] ** 2 - across**2, 0.0)) / (2 * across)
            way = motion.end[u] - motion.start[u], motion.end[v] - motion.start[v]
            centre[u] = (motion.start[u] + motion.end[u]) / 2 - aside * way[1]
            centre[v] = (motion.start[v] + motion.end[v]) / 2 + aside * way[0]
        else:
            for k in (u, v):
                from_start = motion.start[k] if modes.from_start else 0.0
                missing = 0.0 if modes.from_start else motion.start[k]
                centre[k] = from_start + places[_CENTRES[k]] if _CENTRES[k] in places else from_start + missing
            apart = [math.dist((p[u], p[v]), (centre[u], centre[v])) for p in (motion.start, motion.end)]
            if min(apart) <= 0 or abs(apart[0] - apart[1]) > max(_SAME, 1e-3 * apart[0]):
                what = "the ends of this arc are not equally far from its centre"
                raise self.fail(what, "Write G91.1 where I, J, K count from the start, G90.1 where from zero")
        return centre[0], centre[1], centre[w] if w == 2 else centre[2]

    def _said(self, without: str) -> str:
        """Return the line without some words and without how places are counted; its comments stay."""
        if not self._words or (not without and not set(_FORMS) & {_plain(v) for k, v in self._words if k == "G"}):
            return self._text.rstrip()
        kept = [
            key + value for key, value in self._words if key not in without and not self._drops(key, value, without)
        ]
        return " ".join([*kept, *_COMMENT.findall(self._text)])

    def _drops(self, letter: str, value: str, without: str) -> bool:
        moved = without and (
            (letter == "G" and _plain(value) in _MOTIONS) or (letter == "M" and _plain(value) in _AT_END)
        )
        return bool(moved) or (letter == "G" and _plain(value) in _FORMS)


def _plain(value: str) -> str:
    """Return a number of a code without what it may have in front and behind: "01." is 1."""
    return f"{float(value):g}"
