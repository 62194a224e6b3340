"""A part program as its motions: a strict modal reader of G-code, which refuses every word that it does not know.

Lines that move nothing stay as they are. A motion is split into what stands before it, its way, and what ends it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from axiscal.exceptions import ReadingError
from axiscal.measurement.readers.text_file import TextFile
from axiscal.numerics import Array
from axiscal.units import from_unit

Unit = Literal["mm", "in"]
Spot = tuple[float, ...]
"""X, Y, Z, m, NaN where nobody knows."""

_LETTERS, _CENTRES = "XYZ", "IJK"
_PLANES = {"17": (0, 1, 2), "18": (2, 0, 1), "19": (1, 2, 0)}
"""By G17, G18 and G19 (RS274/NGC): two axes that turn from the first to the second about the third."""
_UNITS: Mapping[str, Unit] = {"21": "mm", "20": "in"}
_OFFSETS = ("54", "55", "56", "57", "58", "59", "59.1", "59.2", "59.3")
_HOME, _FORMS, _MOTIONS = ("28", "30", "53"), ("90", "91", "90.1", "91.1"), ("0", "1", "2", "3")
_KNOWN = {*_PLANES, *_UNITS, *_OFFSETS, *_HOME, *_FORMS, *_MOTIONS}
_KNOWN |= {"4", "40", "43", "49", "61", "61.1", "64", "80", "94", "95", "96", "97"}
_AT_ONCE, _AT_END = {"3", "4", "5", "6", "7", "8", "9", "48", "49"}, {"0", "1", "2", "30"}
_COMMENT = re.compile(r"\([^()]*\)|;.*")
_WORD = re.compile(r"([A-Z])([-+]?(?:\d+\.?\d*|\.\d+))")
_SAME = 5e-6
"""m, by which the ends of an arc may differ in their distance from its centre: what four decimals of an inch leave."""


@dataclass(frozen=True, slots=True)
class PartMotion:
    """A way from start to end, straight, or as an arc or helix.

    rapid : nothing is cut on it; turn : rad that an arc turns about its centre in its plane; 0 of a line
    """

    rapid: bool
    start: Spot
    end: Spot
    turn: float = 0.0
    centre: Spot = (0.0, 0.0, 0.0)
    plane: tuple[int, int, int] = (0, 1, 2)

    @property
    def known(self) -> bool:
        """Whether it is known where it begins."""
        return not any(map(math.isnan, self.start))

    @property
    def _first(self) -> float:
        u, v, _ = self.plane
        return math.atan2(self.start[v] - self.centre[v], self.start[u] - self.centre[u])

    @property
    def quarters(self) -> list[float]:
        """The shares of it between which no axis turns round, both ends included."""
        if not self.turn:
            return [0.0, 1.0]
        low, high = sorted((self._first, self._first + self.turn))
        at = np.arange(math.ceil(low / (math.pi / 2)), math.floor(high / (math.pi / 2)) + 1) * math.pi / 2
        shares = sorted((at - self._first) / self.turn)
        return [0.0, *(share for share in shares if 1e-9 < share < 1 - 1e-9), 1.0]

    def places(self, shares: Array) -> Array:
        """Return the places of shares (m,) of it, (m, 3) m."""
        end, shares = np.array(self.end), shares[:, None]
        start = np.where(np.isnan(self.start), end, self.start)
        found: Array = start + shares * (end - start)
        if self.turn:
            u, v, _ = self.plane
            first, last = (math.dist((p[u], p[v]), (self.centre[u], self.centre[v])) for p in (self.start, self.end))
            angle, radius = self._first + self.turn * shares[:, 0], first + (last - first) * shares[:, 0]
            found[:, u] = self.centre[u] + radius * np.cos(angle)
            found[:, v] = self.centre[v] + radius * np.sin(angle)
        return found


@dataclass(frozen=True, slots=True)
class PartLine:
    """A line.  text : all of it, of a motion what stands before it; after : what stands behind; unit : of lengths"""

    line: int
    text: str
    motion: PartMotion | None = None
    after: str = ""
    unit: Unit = "mm"


@dataclass(frozen=True, slots=True)
class _Modes:
    """What is in force.  code : of motions; at : where the tool stands; offset, tool : those in use, "" before any"""

    unit: Unit
    code: str = ""
    plane: tuple[int, int, int] = (0, 1, 2)
    absolute: bool = True
    from_start: bool = True
    at: Spot = (math.nan, math.nan, math.nan)
    offset: str = ""
    tool: str = ""


def read_program(file: TextFile, unit: Unit = "mm") -> tuple[PartLine, ...]:
    """Return the lines of a program; raises ReadingError at a line with a word that is not known.

    unit : of lengths before G20 or G21
    """
    modes, lines = _Modes(unit), list[PartLine]()
    for number, text in enumerate(file.lines, 1):
        line, modes = _LineReader(file, number, text).read(modes)
        lines.append(line)
    return tuple(lines)


class _LineReader:
    """Reads one line."""

    def __init__(self, file: TextFile, number: int, text: str) -> None:
        self._file, self._number, self._text = file, number, text
        self._words, self._numbers = list[tuple[str, str]](), dict[str, float]()
        bare, words = re.sub(r"\s+", "", _COMMENT.sub("", text)).upper().strip("%"), list[tuple[str, str]]()
        while bare:
            found = _WORD.match(bare)
            if found is None:
                remedy = "Take the line out, or write the program without subroutines, variables and settings"
                raise self.fail("{text} is no word of a program that can be rewritten", remedy, text=repr(bare[:20]))
            words.append((found[1], found[2]))
            bare = bare[found.end() :]
        for word in words:
            self._take(*word)

    def fail(self, what: str, remedy: str, **values: object) -> ReadingError:
        """Return the error that places a fault in this line."""
        return self._file.fail(what, remedy, self._number, **values)

    def _take(self, letter: str, value: str) -> None:
        """Keep a word, its code without what it may have in front and behind: "01." is 1; raises ReadingError."""
        code = f"{float(value):g}" if letter in "GMT" else value
        known = {"G": _KNOWN, "M": _AT_ONCE | _AT_END}.get(letter, {code} if letter in "XYZIJKRFSTNPHQ" else set())
        if code not in known:
            remedy = "Write the program without it: rotary axes, offsets, cycles and other settings are not rewritten"
            raise self.fail("{word} is not understood", remedy, word=letter + value)
        if letter in self._numbers:
            raise self.fail("{letter} stands twice in this line", "Keep one of them", letter=letter)
        self._words.append((letter, code))
        if letter not in "GM":
            self._numbers[letter] = float(value)

    def read(self, before: _Modes) -> tuple[PartLine, _Modes]:
        """Return the line, and the modes behind it."""
        codes = [code for letter, code in self._words if letter == "G"]
        modes, home = self._in_force(codes, before), any(code in _HOME for code in codes)
        if home or "4" in codes:
            named = set(_LETTERS) & set(self._numbers) or set(_LETTERS)
            gone = (math.nan if home and a in named else at for a, at in zip(_LETTERS, modes.at, strict=True))
            counted = home and not modes.absolute
            text = "G91 " * counted + self._said("", _FORMS)
            return PartLine(self._number, text, None, "G90" * counted, modes.unit), replace(modes, at=tuple(gone))
        if not {*_LETTERS, *_CENTRES, "R"} & set(self._numbers):
            return PartLine(self._number, self._said("", _FORMS), unit=modes.unit), modes
        motion = self._motion(modes)
        late = " ".join(f"M{code}" for letter, code in self._words if letter == "M" and code in _AT_END)
        text = self._said("XYZIJKRN", (*_FORMS, *_MOTIONS), _AT_END)
        return PartLine(self._number, text, motion, late, modes.unit), replace(modes, at=motion.end)

    def _in_force(self, codes: list[str], modes: _Modes) -> _Modes:
        """Return the modes with what this line changes."""
        if sum(code in _MOTIONS for code in codes) > 1:
            raise self.fail("two motions stand in one line", "Write a line for each")
        for code in codes:
            if code in _OFFSETS and modes.offset not in ("", code):
                what, remedy = "G{code} is another work offset than G{first}", "Write a program for each offset"
                raise self.fail(what, remedy, code=code, first=modes.offset)
            modes = replace(
                modes,
                unit=_UNITS.get(code, modes.unit),
                plane=_PLANES.get(code, modes.plane),
                code="" if code == "80" else code if code in _MOTIONS else modes.code,
                absolute={"90": True, "91": False}.get(code, modes.absolute),
                from_start={"90.1": False, "91.1": True}.get(code, modes.from_start),
                offset=code if code in _OFFSETS else modes.offset,
            )
        tool = next((code for letter, code in self._words if letter == "T"), modes.tool)
        if tool != modes.tool and modes.tool not in ("", "0"):
            what, remedy = "T{tool} is another tool than T{first}", "Write a program for each tool"
            raise self.fail(what, remedy, tool=tool, first=modes.tool)
        return replace(modes, tool=tool)

    def _motion(self, modes: _Modes) -> PartMotion:
        if not modes.code:
            raise self.fail("it is not said how the tool goes there", "Write G0, G1, G2 or G3 in this line")
        standing = dict(zip(_LETTERS, modes.at, strict=True))
        if not modes.absolute and any(a in self._numbers and math.isnan(at) for a, at in standing.items()):
            raise self.fail("it is not known from where G91 counts", "Go to a place with G90 first")
        places = {key: float(from_unit(value, modes.unit)) for key, value in self._numbers.items()}
        begin = dict.fromkeys(_LETTERS, 0.0) if modes.absolute else standing
        end = tuple(begin[a] + places[a] if a in places else at for a, at in standing.items())
        if modes.code != "0" and (lost := next((a for a, at in zip(_LETTERS, end, strict=True) if math.isnan(at)), "")):
            raise self.fail("it is not known where {axis} stands here", "Go to X, Y and Z with G0 before", axis=lost)
        motion = PartMotion(modes.code == "0", modes.at, end, plane=modes.plane)
        return self._arc(motion, modes, places) if modes.code in ("2", "3") else motion

    def _arc(self, motion: PartMotion, modes: _Modes, places: Mapping[str, float]) -> PartMotion:
        if not motion.known:
            raise self.fail("it is not known where this arc begins", "Go to X, Y and Z with G0 before")
        (u, v, _), centre, sign = modes.plane, list(motion.start), 1.0 if modes.code == "3" else -1.0
        start, end = ((spot[u], spot[v]) for spot in (motion.start, motion.end))
        if "R" in places:
            across = math.dist(start, end) / 2
            if not 0 < across <= abs(places["R"]) + _SAME:
                raise self.fail("no circle of this radius goes through both ends", "Write its centre as I, J, K")
            aside = (
                math.sqrt(max(places["R"] ** 2 - across**2, 0.0))
                / (2 * across)
                * math.copysign(sign, sign * places["R"])
            )
            centre[u] = (start[0] + end[0]) / 2 - aside * (end[1] - start[1])
            centre[v] = (start[1] + end[1]) / 2 + aside * (end[0] - start[0])
        else:
            for k in (u, v):
                if _CENTRES[k] in places:
                    centre[k] = places[_CENTRES[k]] + (motion.start[k] if modes.from_start else 0.0)
            apart = [math.dist(spot, (centre[u], centre[v])) for spot in (start, end)]
            if min(apart) <= 0 or abs(apart[0] - apart[1]) > max(_SAME, 1e-3 * apart[0]):
                what = "the ends of this arc are not equally far from its centre"
                raise self.fail(what, "Write G91.1 where I, J, K count from the start, G90.1 where from zero")
        first, last = (math.atan2(spot[1] - centre[v], spot[0] - centre[u]) for spot in (start, end))
        turn = math.tau if math.dist(start, end) < 1e-9 else (sign * (last - first)) % math.tau
        return replace(motion, turn=sign * turn, centre=tuple(centre))

    def _said(self, letters: str, codes: tuple[str, ...], late: frozenset[str] | set[str] = frozenset()) -> str:
        """Return the line without some words, G codes and M codes; its comments stay."""
        dropped = [k in letters or v in {"G": codes, "M": late}.get(k, ()) for k, v in self._words]
        if not any(dropped):
            return self._text.rstrip()
        kept = [k + v for (k, v), gone in zip(self._words, dropped, strict=True) if not gone]
        return " ".join([*kept, *_COMMENT.findall(self._text)])
