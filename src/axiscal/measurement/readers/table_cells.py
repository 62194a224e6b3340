"""Lines of a table and their cells: what stands in a column, as text or as a number, and where a fault is.

Numbers are as each country writes them: `1.5` and `1,5`; `1'080.5`, `1,080.5` and `1.080,5` with marks of thousands. A
column has one decimal mark, by its own numbers, else by those of the other columns. `1.080` may be 1080 where the
decimal mark is a comma, or where no number of the file decides: it is refused.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from decimal import Decimal

from axiscal.exceptions import ReadingError
from axiscal.language.spoken import later, listed, said
from axiscal.measurement.readers.columns import Column, unread
from axiscal.measurement.reading import LARGEST
from axiscal.units import from_unit

NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_OF_FORTRAN = re.compile(r"(?<=[\d.,])[dD](?=[+-]?\d+$)", re.ASCII)
_SWAPPED = str.maketrans(",.", ".,")
_BETWEEN = " '\x92\N{RIGHT SINGLE QUOTATION MARK}\N{NO-BREAK SPACE}\N{NARROW NO-BREAK SPACE}\N{THIN SPACE}"
"""What stands between thousands and is no decimal mark."""
_GROUPED = re.compile(rf"[+-]?[1-9]\d{{0,2}}([.,{_BETWEEN}])\d{{3}}(?:\1\d{{3}})*(?:(?!\1)([.,])\d*)?", re.ASCII)
_EITHER = re.compile(r"[+-]?[1-9]\d{0,2}([.,])\d{3}", re.ASCII)
"""A number whose only mark may be that of thousands, or the decimal one."""
_DECIMAL = re.compile(r"[+-]?\d*([.,])\d*(?:[dDeE][+-]?\d+)?", re.ASCII)


def plain(text: str, mark: str) -> str:
    """Return a number with a decimal point and without marks of thousands; another text nearly as it is.

    mark : the decimal one of its column
    """
    text = _OF_FORTRAN.sub("E", text.replace("\N{MINUS SIGN}", "-"))
    found = _GROUPED.fullmatch(text)
    if found and found[1] != mark and not _EITHER.fullmatch(text):
        text = text.replace(found[1], "")
    return text.translate(_SWAPPED) if mark == "," else text


def doubtful(text: str, mark: str) -> bool:
    """Return whether nothing says if the mark of a number is that of thousands."""
    return (found := _EITHER.fullmatch(text.replace("\N{MINUS SIGN}", "-"))) is not None and found[1] != mark


def marks_of(columns: Sequence[Sequence[str]], separator: str) -> list[str]:
    """Return the decimal mark of each column by its cells, "" where no number decides.

    In a file with one mark only, a point between bare commas and a comma between semicolons or tabs are decimal ones.
    """
    points, commas = (any(mark in cell for column in columns for cell in column) for mark in ".,")
    if separator == "," and not commas:
        return ["."] * len(columns)
    if separator != "," and not points:
        return [","] * len(columns)
    own = [list(filter(None, map(_decimal, column))) for column in columns]
    every = {mark for marks in own for mark in marks}
    alone = every.pop() if len(every) == 1 else ""
    return [next(iter(marks), alone) for marks in own]


def _decimal(text: str) -> str:
    """Return the decimal mark that a number shows, "" where it shows none."""
    text = text.replace("\N{MINUS SIGN}", "-")
    if _EITHER.fullmatch(text) or unread(text):
        return ""
    if grouped := _GROUPED.fullmatch(text):
        return grouped[2] or {".": ",", ",": "."}.get(grouped[1], "")
    found = _DECIMAL.fullmatch(text)
    return found[1] if found else ""


LONGEST = 60
"""Characters of what is quoted."""
_NOT_FINITE = re.compile(r"[+-]?(nan|inf|infinity)", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class TableLine:
    """A line of a file, where a fault can stand."""

    file: str
    line: int

    def fail(self, what: str, remedy: str, **values: object) -> ReadingError:
        """Return the error that places a fault in this line."""
        return ReadingError(what, remedy, self.file, self.line, **values)


@dataclass(frozen=True, slots=True)
class Cell(TableLine):
    """What stands in a column of a line, stripped of white space, its shield taken away; "" where it is empty."""

    column: Column
    text: str

    def quantity(self) -> float:
        """Return a number of a machine in SI units; raises ReadingError."""
        unit = self.column.unit or self.column.stated
        if not unit:
            remedy = "write it as '{stem}_mm' or '{stem}_deg'"
            raise self.fail("column '{column}' has no unit", remedy, column=self.column.name, stem=self.column.stem)
        value = from_unit(self.number(), unit)
        if abs(value) >= LARGEST:
            raise self._no_number()
        return value

    def number(self) -> float:
        """Return the number that it says; raises ReadingError."""
        text = plain(self.text, self.column.mark)
        value = float(text) if NUMBER.fullmatch(text) else math.nan
        if not math.isfinite(value) or doubtful(self.text, self.column.mark):
            raise self._no_number()
        return value

    def rounding(self) -> float:
        """Return half of the last digit of a number, in SI units."""
        last = Decimal(plain(self.text, self.column.mark)).as_tuple().exponent
        return from_unit(float(Decimal(5).scaleb(int(last) - 1)), self.column.unit or self.column.stated)

    def _no_number(self) -> ReadingError:
        what, remedy = _why_not(self.text, self.column.mark)
        values = {"text": quoted(self.text), "better": self.text.replace(",", ".")}
        return self.fail(what, remedy, column=self.column.name, **values)

    def meant(self, read: Callable[[str], int | None], what: str, remedy: str) -> int:
        """Return what it means; raises ReadingError where `read` returns None."""
        if (found := read(self.text)) is None:
            raise self.fail(what, remedy, text=self.text[:40])
        return found


@dataclass(frozen=True, slots=True)
class Row(TableLine):
    """One line of data: its texts by the columns of the table."""

    texts: tuple[str, ...]
    columns: tuple[Column, ...]

    def cell(self, place: int) -> Cell:
        """Return the cell of a column."""
        return Cell(self.file, self.line, self.columns[place], self.texts[place])

    def of(self, *stems: str, units: Sequence[str] = ()) -> Cell:
        """Return the one filled cell of all columns that hold these; an empty one where none is; raises ReadingError.

        units : that the column may have, any unless said
        """
        mine = ((at, column) for at, column in enumerate(self.columns) if column.stem in stems)
        known = [at for at, column in mine if not units or column.fits(units)]
        filled = [at for at in known if self.texts[at]]
        if len(filled) > 1:
            names = listed(said(" and "), [f"'{self.columns[at].name}'" for at in filled])
            raise self.fail("{names} are both filled", "fill exactly one of them in each line", names=names)
        if not known:
            return Cell(self.file, self.line, Column(stems[0], stems[0], None), "")
        return self.cell((filled or known)[0])


def quoted(text: str) -> str:
    """Quote what somebody wrote, shortened, control characters made visible."""
    return repr(text if len(text) <= LONGEST else text[: LONGEST - 3] + "...")


def _why_not(text: str, mark: str) -> tuple[str, str]:
    """Return what is wrong with a cell that is no number of a machine, and what would be right."""
    number, or_out = plain(text, mark), later("write the number that was read, or take out the line")
    if not text:
        return later("{column} is empty"), or_out
    if doubtful(text, mark):
        remedy = later("write it without a mark of thousands, or with four decimals")
        return later("{column} {text} is a number of thousands, or one with three decimals"), remedy
    if NUMBER.fullmatch(number) and math.isfinite(float(number)):
        remedy = later("write the number that was read, in the unit of the header")
        return later("{column} {text} is too large for a machine"), remedy
    if _NOT_FINITE.fullmatch(number) or NUMBER.fullmatch(number):
        return later("{column} {text} is not finite"), or_out
    if NUMBER.fullmatch(text):
        return later("{column} {text} has a decimal point, others have a comma"), later("write all numbers alike")
    if NUMBER.fullmatch(text.replace(",", ".")):
        return later("{column} {text} has a decimal comma"), later("write a decimal point: {better}")
    remedy = later("write digits with a decimal point; the unit stands in the header")
    return later("{column} {text} is not a number"), remedy
