"""Columns of tables: their units, and the words for them and for directions in many languages."""

from __future__ import annotations

import re
import tomllib
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Literal

from axiscal.machine.error_names import AXIS_NAME

LENGTHS = ("mm", "um", "nm", "m", "in", "inch", "thou", "uin")
ANGLES = ("deg", "arcsec", "urad", "mrad", "rad")
TILTS = (*ANGLES, "arcmin", "um/m", "mm/m", "in/ft")
"""Of tests."""
Units = tuple[str, ...]
"""In which a column may be."""
TEXT: Units = ()
WORDS = tomllib.loads(resources.files(__package__).joinpath("columns.toml").read_text(encoding="utf-8"))
_UNITS = {word: unit for unit, words in WORDS["units"].items() for word in words}
_UNITS |= {unit: unit for unit in (*LENGTHS, *TILTS)}
_ENDS = "|".join(map(re.escape, sorted(_UNITS, key=len, reverse=True)))
_WITH_UNIT = re.compile(
    rf"(.+?)(?:\s*[\[(]\s*|_|(?<![\d\s])(?:\s*[,/]\s*|\s+(?:in\s+)?))({_ENDS})\s*[\])]?", re.IGNORECASE
)
"""A header: what it holds, and its unit, in brackets or behind `_`, a comma, a stroke, a blank, or "in"."""
_LONGEST = 200
"""Characters of a header: none with a unit is longer, and a run of blanks is gone through once for each of them."""
STEMS = {word: stem for stem, words in WORDS["columns"].items() for word in words}
"""Of tests, by the words of their headers."""
OF_READINGS = {word: word for word in ("setup", "approach", "reading", "check", "time", "value")}
_GRAD = re.compile(r"(?<![^\W_])grad(?![^\W_])", re.IGNORECASE)
_GERMAN = re.compile(rf"(?<![^\W\d_])(?:{'|'.join(WORDS['german'])})(?![^\W\d_])", re.IGNORECASE)
_SIGNS = {word: int(sign) for sign, words in WORDS["directions"].items() for word in words}
_PARTS = re.compile(r"\d{1,9}|[+\-\u2190-\u2193]|[^\W\d_]+")
_APPROACH = re.compile(f"([+−-])?({AXIS_NAME})([+−-])?")
_RUN = re.compile(r"[0-9]{1,6}")
"""Of a run or a reading: whoever writes more has slipped."""


@dataclass(frozen=True, slots=True)
class Column:
    """One column: its header as written, what it holds, and in which unit (None for text).

    stated : unit that the file's reader was given for numbers whose header names none, "" where it was given none
    mark : decimal mark of its numbers, "" where none of them decides
    """

    name: str
    stem: str
    unit: str | None
    stated: str = ""
    mark: str = "."

    @property
    def dimension(self) -> Literal["length", "angle"]:
        """What the unit measures."""
        return "length" if (self.unit or self.stated) in LENGTHS else "angle"

    def fits(self, units: Sequence[str]) -> bool:
        """Return whether it is in one of these units; in none where there are none, for text."""
        return (self.unit or (self.stated if units else "")) in (units or ("",))


def column_of(name: str, stated: str = "", words: Mapping[str, str] = OF_READINGS) -> Column:
    """Return the column of a header: `stem_unit`, `stem [unit]` or `stem (unit)`, else text or a number as stated.

    words : stems by what they may be called
    """
    found = _WITH_UNIT.fullmatch(_plain(name)) if len(name) <= _LONGEST else None
    stem, unit = (found[1], unit_of(found[2])) if found else (name, None)
    return Column(name, words.get(stem.lower(), stem), unit, stated)


def in_deg(line: str, header: str) -> str | None:
    """Return a line of a header with deg for the Grad of a German one; None for those of another."""
    return None if _GRAD.search(line) and not _GERMAN.search(header) else _GRAD.sub("deg", line)


def _plain(text: str) -> str:
    """Return a text with the plainest form of each letter and sign, and u for micro."""
    return unicodedata.normalize("NFKC", text).replace("\N{GREEK SMALL LETTER MU}", "u")


def unit_of(text: str) -> str | None:
    """Return the unit that a text is, in brackets or not; None where it is none."""
    return _UNITS.get(_plain(text).strip(" []()").lower())


def sign_of(text: str) -> int | None:
    """Return the sign of a direction by its word, None for another word."""
    return _SIGNS.get(_plain(text).lower().replace("\N{MINUS SIGN}", "-"))


def unread(text: str) -> bool:
    """Return whether a cell says that nobody read anything there."""
    return text.strip("=").lower() in WORDS["unread"]


def whole(text: str) -> int | None:
    """Return the number of a run or a reading, None for another text."""
    return int(text) if _RUN.fullmatch(text) else None


def run_of(stem: str) -> tuple[int, int] | None:
    """Return the run, 1 of one that a word alone names, and the direction of `1+` or `reverse`, None for another."""
    words = _PARTS.findall(stem[:99].lower().replace("\N{MINUS SIGN}", "-"))  # no header is longer
    runs = [word for word in words if _RUN.fullmatch(word)]
    ways = [sign for word in words if word not in runs and (sign := sign_of(word))]
    others = [word for word in words if not (sign_of(word) or word in runs or STEMS.get(word) in ("run", "deviation"))]
    alone = not runs and any(map(str.isalpha, stem))
    return (int((runs or ["1"])[0]), ways[0]) if len(runs) + alone == len(ways) == 1 and not others else None


def approach_of(text: str) -> dict[str, int] | None:
    """Return the direction of the last motion (+1, -1) by axis from `X+ Y-`, `X+;Y-` or `+X`, None where it is none."""
    found = [_APPROACH.fullmatch(each) for each in re.split(r"[\s,;]+", text) if each]
    approach = {each[2]: sign for each in found if each and (sign := sign_of((each[1] or "") + (each[3] or "")))}
    return approach if len(approach) == len(found) else None
