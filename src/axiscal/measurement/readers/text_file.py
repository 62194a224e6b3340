"""Files of text, whatever they are encoded in: lines, and numbers with the place of each fault."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from importlib import resources
from itertools import pairwise
from pathlib import Path

from axiscal.document.file import bounded_content, number_or_none
from axiscal.exceptions import ReadingError
from axiscal.measurement.readers.columns import STEMS
from axiscal.units import from_unit

MOST = 20_000_000
"""Bytes; a day of readings has a thousandth of it."""
MOST_LINES = 200_000
"""Lines; estimating takes 10,000 readings in a minute, and a file that is wrong is to be refused in a second."""

_PATTERNS = tomllib.loads(resources.files(__package__).joinpath("lines.toml").read_text(encoding="utf-8"))
LINES_OF = {kind: {name: re.compile(each) for name, each in these.items()} for kind, these in _PATTERNS.items()}
"""How lines of a kind of files look, by what they are."""
_TIME = r"(?:[\d./-]{8,10},? )?(\d\d?):(\d\d)(?::(\d\d))?(?:[.,]\d+)?\s*(?:([AP])M\s*)?(?:[-|] )?"
_LOG = re.compile(rf"^\s*(?:\[?{_TIME}\]?\s*(?::\s+)?)?(?:(?:Recv:|READ:|->|[<>])\s*)*(?:[Ee]cho:|//)?\s*")
_PAGES, _HEAD = ("latin-1", "cp1250", "cp1251"), 5000
"""Pages of codes in which spreadsheets save, and bytes that decide: the one in which most words are known."""
_BEYOND = re.compile("|".join(re.escape(word) for word in STEMS if not word.isascii()))
_LARGEST = 1e9
"""In whatever unit the file has: a kilometre in micrometres, which no machine has."""


@dataclass(frozen=True)
class TextFile:
    """A file as lines, without the ends of lines.  unit : of lengths whose unit it does not state, "" where unsaid"""

    name: str
    lines: tuple[str, ...]
    unit: str = ""

    @cached_property
    def told(self) -> tuple[tuple[int, str], ...]:
        """The lines with their numbers, without what a terminal and a firmware write in front."""
        return tuple((number, _LOG.split(line, maxsplit=1)[-1].rstrip()) for number, line in enumerate(self.lines, 1))

    def fail(self, what: str, remedy: str, line: int | None = None, **values: object) -> ReadingError:
        """Return the error that places a fault in a line, counted from 1."""
        return ReadingError(what, remedy, self.name, line, **values)

    def length(self, text: str, name: str, line: int) -> float:
        """Return a length, m, in mm unless another unit was given; raises ReadingError."""
        return from_unit(self.number(text, name, line), self.unit or "mm")

    def number(self, text: str, name: str, line: int) -> float:
        """Return a number of a machine; raises ReadingError."""
        value = number_or_none(text)
        if value is None or abs(value) >= _LARGEST:
            shown = text if len(text) <= 40 else text[:37] + "..."
            what, remedy = "{name} {shown!r} is no number of a machine", "write digits with a decimal point"
            raise self.fail(what, remedy, line, name=name, shown=shown)
        return value


def has_line(patterns: Iterable[re.Pattern[str]], file: TextFile) -> bool:
    """Return whether a line of a file begins with one of some patterns."""
    return any(pattern.match(text) for _, text in file.told for pattern in patterns)


def newest_first(file: TextFile) -> bool:
    """Return whether the times in front of its lines go down, as on the page of a printer."""
    found = [each for each in map(_LOG.match, file.lines) if each and each[1]]
    clocks = [(each[4] or "", int(each[1]) % (12 if each[4] else 24), each[2], each[3] or "") for each in found]
    return sum((after > before) - (after < before) for before, after in pairwise(clocks)) < 0


def _content(path: str | Path) -> bytes:
    """Return what stands in a file of readings; raises ReadingError."""
    try:
        return bounded_content(path, MOST)
    except (OSError, ValueError) as error:
        reason = (getattr(error, "strerror", None) or str(error)).lower()
        remedy = "check the name and the permissions"
        raise ReadingError("the file cannot be read: {reason}", remedy, str(path), reason=reason) from None


def exact_text(path: str | Path) -> str:
    """Return a file to the last byte; raises ReadingError for what is no text in UTF-8."""
    try:
        return _content(path).decode()
    except UnicodeDecodeError as fault:
        raise ReadingError("byte {place} is no UTF-8", "save it as UTF-8", str(path), place=fault.start) from None


def read_text(path: str | Path, unit: str = "") -> TextFile:
    """Read a file in UTF-8, UTF-16 with its mark, or else a page of Windows; raises ReadingError."""
    text = _decoded(_content(path))
    if "\0" in text or text.startswith(("PK\3\4", "\xd0\xcf\x11\xe0")):
        remedy = "save its sheet as CSV, or the text in UTF-8"
        raise ReadingError("the file is a workbook, or no text", remedy, str(path))
    return TextFile(str(path), lines_of(text, path), unit)


def lines_of(text: str, path: str | Path) -> tuple[str, ...]:
    """Return the lines of a text, with whatever ends; raises ReadingError for so many that no campaign has."""
    lines = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n").split("\n")
    if len(lines) > MOST_LINES:
        what = "the file has {lines:,} lines, and at most {most:,} are read"
        raise ReadingError(what, "give the readings of one campaign", str(path), lines=len(lines), most=MOST_LINES)
    return tuple(lines)


def _decoded(data: bytes) -> str:
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return data.decode("utf-16", errors="replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        known = {page: len(_BEYOND.findall(data[:_HEAD].decode(page, "replace").lower())) for page in _PAGES}
        return data.decode(max(_PAGES, key=known.__getitem__), "replace")
