"""A part program as its motions: a strict modal reader of G-code, which refuses every word that it does not know.

Lines that move nothing stay as they are. A motion is split into what stands before it, its way, and what ends it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
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
_TAKEN = "XYZIJKRFSTNPHQ"
"""Letters whose words stay, or are of a motion, with any number."""
_COMMENT = re.compile(r"\([^()]*\)|;.*")
_WORD = re.compile(r"([A-Z])([-+]?(?:\d+\.?\d*|\.\d+))")
_SAME = 5e-6
"""m, by which the ends of an arc may differ in their distance from its centre: what four decimals of an inch leave."""


@dataclass(frozen=True, slots=True)
class PartMotion:
    """A way from start to end, straight, or as an arc or helix.

    rapid : nothing is cut on it; turn : rad that an arc turns about its centre in its plane, from `first`; 0 of a line
    """

    rapid: bool
    start: Spot
    end: Spot
    turn: float = 0.0
    first: float = 0.0
    centre: tuple[float, float] = (0.0, 0.0)
    plane: tuple[int, int, int] = (0, 1, 2)

    @property
    def known(self) -> bool:
        """Whether it is known where it begins."""
        return not any(map(math.isnan, self.start))

    @property
    def quarters(self) -> list[float]:
        """The shares of it between which no axis turns round, both ends included."""
        low, high = sorted((self.first, self.first + self.turn))
        at = np.arange(math.ceil(low / (math.pi / 2)), math.floor(high / (math.pi / 2)) + 1) * math.pi / 2
        shares = sorted((at - self.first) / self.turn) if self.turn else []
        return [0.0, *(share for share in shares if 1e-9 < share < 1 - 1e-9), 1.0]

    def places(self, shares: Array) -> Array:
        """Return the places of shares (m,) of it, (m, 3) m."""
        end, shares = np.array(self.end), shares[:, None]
        start = np.where(np.isnan(self.start), end, self.start)
        found: Array = start + shares * (end - start)
        if self.turn:
            u, v, _ = self.plane
            first, last = (math.dist((p[u], p[v]), self.centre) for p in (self.start, self.end))
            angle, radius = self.first + self.turn * shares, first + (last - first) * shares
            found[:, [u, v]] = self.centre + radius * np.hstack([np.cos(angle), np.sin(angle)])
        return found


@dataclass(frozen=True, slots=True)
class PartLine:
    """A line.  text : all of it, of a motion what stands before it; after : what stands behind; unit : of lengths"""

    line: int
    text: str
    motion: PartMotion | None = None
    after: str = ""
    unit: Unit = "mm"


def read_program(file: TextFile, unit: Unit = "mm") -> tuple[PartLine, ...]:
    """Return the lines of a program; raises ReadingError at a line with a word that is not known.

    unit : of lengths before G20 or G21
    """
    reader = _InForce(file, unit)
    return tuple(reader.line(number, text) for number, text in enumerate(file.lines, 1))


class _InForce:
    """Reads one line after the other and keeps what is in force.

    code : of motions; at : where the tool stands; offset, tool : those in use, "" before any
    """

    def __init__(self, file: TextFile, unit: Unit) -> None:
        self._file, self._unit, self._number = file, unit, 0
        self._code, self._offset, self._tool, self._plane = "", "", "", _PLANES["17"]
        self._absolute, self._from_start = True, True
        self._at: Spot = (math.nan,) * 3

    def _fail(self, what: str, remedy: str, **values: object) -> ReadingError:
        return self._file.fail(what, remedy, self._number, **values)

    def line(self, number: int, text: str) -> PartLine:
        """Return a line; raises ReadingError."""
        self._number = number
        words = [*self._words(re.sub(r"\s+", "", _COMMENT.sub("", text)).upper().strip("%"))]
        numbers = {letter: float(value) for letter, value in words if letter not in "GM"}
        if twice := next((letter for letter in numbers if [k for k, _ in words].count(letter) > 1), ""):
            raise self._fail("{letter} stands twice in this line", "Keep one of them", letter=twice)

        def without(letters: str, codes: Collection[str], late: Collection[str] = ()) -> str:
            """Return the line without some words, G codes and M codes; its comments stay."""
            gone = {"G": codes, "M": late}
            kept = [k + v for k, v in words if not (k in letters or v in gone.get(k, ()))]
            return text.rstrip() if len(kept) == len(words) else " ".join([*kept, *_COMMENT.findall(text)])

        codes = [code for letter, code in words if letter == "G"]
        self._enforce(codes, next((code for letter, code in words if letter == "T"), self._tool))
        home = any(code in _HOME for code in codes)
        if home or "4" in codes:
            named = set(_LETTERS) & set(numbers) or set(_LETTERS)
            self._at = tuple(math.nan if home and a in named else at for a, at in zip(_LETTERS, self._at, strict=True))
            counted = home and not self._absolute
            return PartLine(number, "G91 " * counted + without("", _FORMS), None, "G90" * counted, self._unit)
        if not {*_LETTERS, *_CENTRES, "R"} & set(numbers):
            return PartLine(number, without("", _FORMS), unit=self._unit)
        motion = self._motion({key: float(from_unit(value, self._unit)) for key, value in numbers.items()})
        self._at = motion.end
        late = " ".join(f"M{code}" for letter, code in words if letter == "M" and code in _AT_END)
        return PartLine(number, without("XYZIJKRN", (*_FORMS, *_MOTIONS), _AT_END), motion, late, self._unit)

    def _words(self, bare: str) -> Iterator[tuple[str, str]]:
        """Yield the words, a code without what it may have in front and behind: "01." is 1; raises ReadingError."""
        while bare:
            if (found := _WORD.match(bare)) is None:
                remedy = "Take the line out, or write the program without subroutines, variables and settings"
                raise self._fail("{text} is no word of a program that can be rewritten", remedy, text=repr(bare[:20]))
            letter, value = found.groups()
            code = f"{float(value):g}" if letter in "GMT" else value
            if code not in {"G": _KNOWN, "M": _AT_ONCE | _AT_END}.get(letter, {code} if letter in _TAKEN else set()):
                remedy = (
                    "Write the program without it: rotary axes, offsets, cycles and other settings are not rewritten"
                )
                raise self._fail("{word} is not understood", remedy, word=letter + value)
            yield letter, code
            bare = bare[found.end() :]

    def _enforce(self, codes: Sequence[str], tool: str) -> None:
        """Keep what a line puts in force."""
        if sum(code in _MOTIONS for code in codes) > 1:
            raise self._fail("two motions stand in one line", "Write a line for each")
        for code in codes:
            if code in _OFFSETS and self._offset not in ("", code):
                what, remedy = "G{code} is another work offset than G{first}", "Write a program for each offset"
                raise self._fail(what, remedy, code=code, first=self._offset)
            self._unit, self._plane = _UNITS.get(code, self._unit), _PLANES.get(code, self._plane)
            self._code = "" if code == "80" else code if code in _MOTIONS else self._code
            self._absolute = {"90": True, "91": False}.get(code, self._absolute)
            self._from_start = {"90.1": False, "91.1": True}.get(code, self._from_start)
            self._offset = code if code in _OFFSETS else self._offset
        if tool != self._tool and self._tool not in ("", "0"):
            what, remedy = "T{tool} is another tool than T{first}", "Write a program for each tool"
            raise self._fail(what, remedy, tool=tool, first=self._tool)
        self._tool = tool

    def _motion(self, places: Mapping[str, float]) -> PartMotion:
        """Return the way that is in force.  places : numbers by letter, those of lengths in m"""
        if not self._code:
            raise self._fail("it is not said how the tool goes there", "Write G0, G1, G2 or G3 in this line")
        standing = dict(zip(_LETTERS, self._at, strict=True))
        if not self._absolute and any(a in places and math.isnan(at) for a, at in standing.items()):
            raise self._fail("it is not known from where G91 counts", "Go to a place with G90 first")
        begin = dict.fromkeys(_LETTERS, 0.0) if self._absolute else standing
        end = tuple(begin[a] + places[a] if a in places else at for a, at in standing.items())
        lost = next((a for a, at in zip(_LETTERS, end, strict=True) if math.isnan(at)), "")
        if self._code != "0" and lost:
            raise self._fail("it is not known where {axis} stands here", "Go to X, Y and Z with G0 before", axis=lost)
        if self._code not in ("2", "3"):
            return PartMotion(self._code == "0", self._at, end)
        if any(map(math.isnan, self._at)):
            raise self._fail("it is not known where this arc begins", "Go to X, Y and Z with G0 before")
        u, v, _ = self._plane
        ends = start, stop = [(spot[u], spot[v]) for spot in (self._at, end)]
        sign = 1.0 if self._code == "3" else -1.0
        if "R" in places:
            across = math.dist(start, stop) / 2
            if not 0 < across <= abs(places["R"]) + _SAME:
                raise self._fail("no circle of this radius goes through both ends", "Write its centre as I, J, K")
            far = math.copysign(math.sqrt(max(places["R"] ** 2 - across**2, 0.0)), sign * places["R"])
            aside = far / (2 * across)
            x = (start[0] + stop[0]) / 2 - aside * (stop[1] - start[1])
            y = (start[1] + stop[1]) / 2 + aside * (stop[0] - start[0])
        else:
            from_there = start if self._from_start else (0.0, 0.0)
            given = zip((u, v), from_there, start, strict=True)
            x, y = (places[_CENTRES[k]] + zero if _CENTRES[k] in places else at for k, zero, at in given)
            apart = [math.dist(spot, (x, y)) for spot in ends]
            if min(apart) <= 0 or abs(apart[0] - apart[1]) > max(_SAME, 1e-3 * apart[0]):
                what = "the ends of this arc are not equally far from its centre"
                raise self._fail(what, "Write G91.1 where I, J, K count from the start, G90.1 where from zero")
        first, last = (math.atan2(spot[1] - y, spot[0] - x) for spot in ends)
        turn = math.tau if math.dist(start, stop) < 1e-9 else (sign * (last - first)) % math.tau
        return PartMotion(False, self._at, end, sign * turn, first, (x, y), self._plane)
