"""CSV tables whose header names the units, read strictly.

One header line, `#` before a comment line.  A column is `stem` (text), or `stem_unit` or `stem [unit]` (a number).
The header says what separates the cells: commas, semicolons or tabs. Numbers have a decimal point; between semicolons
or tabs all of them may have a decimal comma instead.  Nothing is guessed: every fault is a `ReadingError` with file,
line, value and remedy.

Text that would be a formula in a spreadsheet is shielded, and read back. A text whose first character, quotes left
aside, is one of `= + - @`, tab or return gets an apostrophe in front. A spreadsheet takes that for "this is text";
reading takes one away. Numbers stay. So every text comes back.

Axis columns `X_mm … C_deg` and the column `approach`, as readings and poses share them.
"""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from axiscal.document.quoting import meant
from axiscal.exceptions import ReadingError
from axiscal.language.spoken import counted, later, listed, put, said
from axiscal.machine.entry import AXIS_NAME
from axiscal.measurement.readers.text_file import TextFile, lines_of, read_text
from axiscal.measurement.reading import LARGEST
from axiscal.units import from_unit

_FORMULA = re.compile(r"'*[=+\-@\t\r]")

LENGTHS = ("mm", "um", "nm", "m", "in", "inch")
ANGLES = ("deg", "arcsec", "urad", "mrad", "rad")
SLOPES = ("um/m", "mm/m", "arcsec", "arcmin", "urad", "mrad", "deg", "div")
"""Of a level: div are divisions, whose value is stated beside."""
TEXT: tuple[str, ...] = ()
_NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_COMMA = re.compile(r"'?[+\-\N{MINUS SIGN}]?(\d+,\d*|,\d+)([eE][+-]?\d+)?", re.ASCII)
_SWAPPED = str.maketrans(",.", ".,")
_LONGEST = 60
"""Characters of what is quoted."""
_SEPARATORS, _QUOTED = ",;\t", re.compile('"[^"]*"')
_UNITS = {*LENGTHS, *ANGLES, *SLOPES}
_NOT_FINITE = re.compile(r"[+-]?(nan|inf|infinity)", re.IGNORECASE)
_NOTHING = re.compile(r"\s*#|[\s;,]*$")
_HINT = re.compile(r"\s*sep=(.)\s*")
"""First line by which a spreadsheet says what separates the cells."""
_IN_BRACKETS = re.compile(r"(.*?)\s*[\[(]([^\[(]*)[\])]")
_SPECIAL = re.compile(r'["\r\n\0]')
_SHORT = 100_000
"""Characters; the csv module refuses longer cells by itself."""


@dataclass(frozen=True, slots=True)
class Column:
    """One column: its header as written, what it holds, and in which unit (None for text).

    stated : unit that the file's reader was given for numbers whose header names none, "" where it was given none
    """

    name: str
    stem: str
    unit: str | None
    stated: str = ""

    @property
    def dimension(self) -> Literal["length", "angle"]:
        """What the unit measures."""
        return "length" if (self.unit or self.stated) in LENGTHS else "angle"

    def fits(self, units: Sequence[str]) -> bool:
        """Return whether it is in one of these units; in none where there are none, for text."""
        return (self.unit or (self.stated if units else "")) in (units or ("",))


@dataclass(frozen=True, slots=True)
class Row:
    """One line of data: cells by header, stripped of white space, shields taken away.

    comma : its numbers have a decimal comma
    """

    file: str
    line: int
    cells: Mapping[str, str]
    comma: bool = False

    def fail(self, what: str, remedy: str, **values: object) -> ReadingError:
        """Return the error that places a fault in this line."""
        return ReadingError(what, remedy, self.file, self.line, **values)

    def text(self, column: Column) -> str:
        """Return a cell as written."""
        return self.cells[column.name]

    def quantity(self, column: Column) -> float:
        """Return a cell as a number of a machine in SI units; raises ReadingError."""
        unit = column.unit or column.stated
        if not unit:
            remedy = "write it as '{stem}_mm' or '{stem}_deg'"
            raise self.fail("column '{column}' has no unit", remedy, column=column.name, stem=column.stem)
        value = from_unit(self.number(column), unit)
        if abs(value) >= LARGEST:
            raise self._no_number(column)
        return value

    def number(self, column: Column) -> float:
        """Return a cell as the number that it says; raises ReadingError."""
        plain = self._plain(column)
        value = float(plain) if _NUMBER.fullmatch(plain) else math.nan
        if not math.isfinite(value):
            raise self._no_number(column)
        return value

    def rounding(self, column: Column) -> float:
        """Return half of the last digit of a number, in SI units."""
        head, *power = re.split("[eE]", self._plain(column).lstrip("+-"))
        half = "e".join([re.sub(r"\d", "0", head) + ("5" if "." in head else ".5"), *power])
        return from_unit(float(half), column.unit or column.stated)

    def _plain(self, column: Column) -> str:
        """Return a cell as a number with a decimal point is written."""
        plain = self.text(column).replace("\N{MINUS SIGN}", "-")
        return plain.translate(_SWAPPED) if self.comma else plain

    def _no_number(self, column: Column) -> ReadingError:
        what, remedy = _why_not(self._plain(column), self.comma)
        text = self.text(column)
        return self.fail(what, remedy, column=column.name, text=_quote(text), better=text.replace(",", "."))

    def only_filled(self, columns: Sequence[Column]) -> Column | None:
        """Return the one column of several that is filled here, None if all are empty; raises ReadingError for two."""
        filled = [column for column in columns if self.text(column)]
        if len(filled) > 1:
            names = listed(said(" and "), [f"'{column.name}'" for column in filled])
            raise self.fail("{names} are both filled", "fill exactly one of them in each line", names=names)
        return filled[0] if filled else None


@dataclass(frozen=True, slots=True)
class CsvTable:
    """A whole file: its columns and its rows, in the order of the file."""

    file: str
    line: int
    columns: tuple[Column, ...]
    rows: tuple[Row, ...]

    def all_of(self, stem: str) -> tuple[Column, ...]:
        """Return the columns that hold `stem`, in whatever units."""
        return tuple(column for column in self.columns if column.stem == stem)

    def one_of(self, stem: str, example: str) -> Column:
        """Return the only column that holds `stem`; raises ReadingError when there is none or more than one."""
        found = self.all_of(stem)
        if len(found) == 1:
            return found[0]
        if found:
            what = "columns '{name}' and '{other}' say the same"
            raise self.fail(what, "keep one of them", name=found[0].name, other=found[1].name)
        remedy = "name it in the header; found: {known}"
        raise self.fail("there is no column '{example}'", remedy, example=example, known=self.header)

    def needed(self, layout: Mapping[str, tuple[str, ...]], *names: str) -> tuple[Column, ...]:
        """Return the columns that names such as `target_mm` are examples of, in whatever units.

        layout : stems that may be there, with their units.  Raises ReadingError for another, or where one is missing.
        """
        self.allow(layout)
        return tuple(self.one_of(column_of(name).stem, name) for name in names)

    def fail(self, what: str, remedy: str, **values: object) -> ReadingError:
        """Return the error that places a fault in the header."""
        return ReadingError(what, remedy, self.file, self.line, **values)

    @property
    def header(self) -> str:
        """The header, as one line."""
        return ",".join(column.name for column in self.columns)

    def allow(self, layout: Mapping[str, tuple[str, ...]]) -> CsvTable:
        """Return the table if each column is in `layout` (stem -> units, TEXT for text); raises ReadingError if not.

        Raises it also where a unit was given for what names none, and all columns name theirs.
        """
        for column in self.columns:
            if column.stem not in layout or not column.fits(layout[column.stem]):
                raise self._unknown(column, layout)
        if self.columns[0].stated and all(column.unit or not layout[column.stem] for column in self.columns):
            raise self.fail("every column names its unit, and --unit names another", "leave --unit out")
        return self

    def _unknown(self, column: Column, layout: Mapping[str, tuple[str, ...]]) -> ReadingError:
        name = column.name[:_LONGEST]
        spelt = {stem: [f"{stem}_{unit}" for unit in units] or [stem] for stem, units in layout.items()}
        if layout.get(column.stem):
            what = "column '{column}' has a unit of the wrong kind" if column.unit else "column '{column}' has no unit"
            return self.fail(what, "it can be {known}", column=name, known=", ".join(spelt[column.stem]))
        known = [name for stem, names in spelt.items() if not self.all_of(stem) for name in names]
        first = ", ".join(names[0] for names in spelt.values())
        every = said("known are {known}; take out what is not needed", known=first)
        return self.fail("column '{column}' is not known", meant(name, known, every), column=name)


def read_table(path: str | Path) -> CsvTable:
    """Read a table from a file; raises ReadingError when it cannot be opened or is not such a table."""
    return table_of(read_text(path))


def parse_table(text: str, file: str) -> CsvTable:
    """Parse a table from text; `file` is the name that errors carry.  Raises ReadingError."""
    return table_of(TextFile(file, lines_of(text, file)))


EXAMPLE = "setup,X_mm,approach,value_um"
"""A header."""


def table_of(file: TextFile, header: str = EXAMPLE) -> CsvTable:
    """Return the table that a file holds; raises ReadingError, with a header as example where there is none."""
    number, separator, columns, data = _begun(file, header)
    read = [(n, line, _cells(file.name, n, line, separator)) for n, line in data]
    comma = separator != "," and any(_COMMA.fullmatch(cell) for _, _, cells in read for cell in cells)
    rows = tuple(_row(file.name, n, line, cells, columns, comma) for n, line, cells in read)
    if not rows:
        raise file.fail("there is a header but no data", "add one line for each reading", number)
    return CsvTable(file.name, number, columns, rows)


def header_of(file: TextFile) -> tuple[Column, ...]:
    """Return the columns that the first line of a file names, none where it is no header."""
    try:
        return _begun(file, "")[2]
    except ReadingError:
        return ()


def _begun(file: TextFile, header: str) -> tuple[int, str, tuple[Column, ...], list[tuple[int, str]]]:
    """Return the line of the header, what separates cells, the columns, and the lines of data; raises ReadingError."""
    data = [(number, line) for number, line in enumerate(file.lines, 1) if not _NOTHING.match(line)]
    hint = _HINT.fullmatch(data[0][1]) if data else None
    if not data[bool(hint) :]:
        raise file.fail("there is no header and no data", "let the first line name the columns")
    (number, first), *data = data[bool(hint) :]
    separator = hint[1] if hint else max(_SEPARATORS, key=_QUOTED.sub("", first).count)
    return number, separator, _columns(file, number, _cells(file.name, number, first, separator), header), data


def _cells(file: str, number: int, line: str, separator: str) -> list[str]:
    try:
        if len(line) < _SHORT and not _SPECIAL.search(line):  # the same, many times faster
            return [cell.strip() for cell in line.split(separator)]
        return [cell.strip() for cell in next(csv.reader([line], strict=True, delimiter=separator))]
    except csv.Error as error:
        remedy = "close every quote and cell"
        raise ReadingError("the line is not CSV: {error}", remedy, file, number, error=error) from None


def _columns(file: TextFile, number: int, names: list[str], header: str) -> tuple[Column, ...]:
    if any(_NUMBER.fullmatch(name) for name in names):
        remedy = "let the first line be the header, such as {header}"
        raise file.fail("the first line holds numbers and names no columns", remedy, number, header=header)
    for index, name in enumerate(names):
        if not name or name in names[:index]:
            what = "column '{name}' is named twice" if name else "column {column} has no name"
            raise file.fail(
                what, "give each column one name of its own", number, name=name[:_LONGEST], column=index + 1
            )
    return tuple(column_of(name, file.unit) for name in names)


def column_of(name: str, stated: str = "") -> Column:
    """Return the column of a header: `stem_unit`, `stem [unit]` or `stem (unit)`, else text or a number as stated."""
    plain = name.replace("µ", "u").replace("μ", "u")
    stem, unit = found.groups() if (found := _IN_BRACKETS.fullmatch(plain)) else plain.rpartition("_")[::2]
    return Column(name, stem, unit, stated) if stem and unit in _UNITS else Column(name, name, None, stated)


def _row(file: str, number: int, line: str, cells: list[str], columns: tuple[Column, ...], comma: bool) -> Row:
    if len(cells) != len(columns):
        remedy = "write one cell for each column, and a decimal point in numbers: 1.5, not 1,5"
        had = counted("the line has {count} cell", "the line has {count} cells", len(cells))
        wanted = counted("the header {count} column", "the header {count} columns", len(columns))
        what = put("{had}, {wanted}: {text}", had=had, wanted=wanted, text=_quote(line))
        raise ReadingError(what, remedy, file, number)
    named = zip(columns, cells, strict=True)
    return Row(file, number, {column.name: unshielded(cell) for column, cell in named}, comma)


def _quote(text: str) -> str:
    """Quote what somebody wrote, shortened, control characters made visible."""
    return repr(text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "...")


def _why_not(text: str, comma: bool) -> tuple[str, str]:
    """Return what is wrong with a cell that is no number of a machine, and what would be right.

    comma : the file has decimal commas, and points and commas of the text are swapped
    """
    if not text:
        return later("{column} is empty"), later("write the number that was read, or take out the line")
    if _NUMBER.fullmatch(text) and math.isfinite(float(text)):
        remedy = later("write the number that was read, in the unit of the header")
        return later("{column} {text} is too large for a machine"), remedy
    if _NOT_FINITE.fullmatch(text) or _NUMBER.fullmatch(text):
        return later("{column} {text} is not finite"), later("write the number that was read, or take out the line")
    if comma and _NUMBER.fullmatch(text.replace(",", ".")):
        return later("{column} {text} has a decimal point, others have a comma"), later("write all numbers alike")
    if _NUMBER.fullmatch(text.replace(",", ".")):
        return later("{column} {text} has a decimal comma"), later("write a decimal point: {better}")
    remedy = later("write digits with a decimal point; the unit stands in the header")
    return later("{column} {text} is not a number"), remedy


def csv_text(rows: Iterable[Sequence[str]]) -> str:
    """Return a CSV file of text and of numbers as they are written."""
    text = io.StringIO()
    shielded = ([f"'{c}" if _FORMULA.match(c) and not _NUMBER.fullmatch(c) else c for c in row] for row in rows)
    csv.writer(text, lineterminator="\n").writerows(shielded)
    return text.getvalue()


def unshielded(cell: str) -> str:
    """Return the text that a cell stands for."""
    return cell[1:] if cell[:1] == "'" and _FORMULA.match(cell) else cell


_APPROACH = re.compile(f"({AXIS_NAME})([+−-])")
_APPROACH_ALONE = re.compile(f"({AXIS_NAME}|)([+−-])")


_AXIS = re.compile(f"{AXIS_NAME}(?:_radius|_diameter)?")


def axis_names(table: CsvTable) -> tuple[str, ...]:
    """Return the axes that have a column, in the order of the header; "X_diameter" where it says what X is."""
    return tuple(dict.fromkeys(column.stem for column in table.columns if _AXIS.fullmatch(column.stem)))


def axis_layout(table: CsvTable) -> dict[str, tuple[str, ...]]:
    """Return which columns may name an axis, with the units of each: the usual axes and those of this table."""
    return {name: ANGLES if name[0] in "ABC" else LENGTHS for name in (*"XYZABC", *axis_names(table))}


def read_position(table: CsvTable, row: Row) -> dict[str, float]:
    """Return the coordinates (m or rad) that a line gives, by axis; an empty cell gives none.  Raises ReadingError."""
    return {name: row.quantity(column) for name, column in axis_columns(table, row).items()}


def axis_columns(table: CsvTable, row: Row) -> dict[str, Column]:
    """Return the column of each coordinate that a line gives, by axis."""
    columns = ((name, row.only_filled(table.all_of(name))) for name in axis_names(table))
    return {name: column for name, column in columns if column is not None}


def approach_of(text: str, word: re.Pattern[str] = _APPROACH) -> dict[str, int] | None:
    """Return the direction of the last motion (+1, -1) by axis from `X+ Y-` or `X+;Y-`, None where it is none."""
    found = [word.fullmatch(each) for each in re.split(r"[\s,;]+", text) if each]
    approach = {each[1]: 1 if each[2] == "+" else -1 for each in found if each}
    return approach if len(approach) == len(found) else None


def read_approach(table: CsvTable, row: Row, *, alone: bool = False) -> dict[str, int]:
    """Return the approach that a line gives; raises ReadingError.  alone : `+` is taken as well, of the axis ''"""
    columns = table.all_of("approach")
    text = row.text(columns[0]) if columns else ""
    if (approach := approach_of(text, _APPROACH_ALONE if alone else _APPROACH)) is None:
        remedy = "write each axis once with its direction, as in 'X+' or 'X+ Y-', or leave it empty"
        raise row.fail("approach {text!r} cannot be read", remedy, text=text)
    return approach


@dataclass(frozen=True, slots=True)
class RawPose:
    """One pose as written: coordinate (m or rad) by axis, direction of approach (+1, -1) by axis, line of the file."""

    position: Mapping[str, float]
    approach: Mapping[str, int]
    line: int


def read_poses(path: str | Path) -> tuple[RawPose, ...]:
    """Read poses in the order of the file, each with a coordinate in every axis column; raises ReadingError."""
    table = read_table(path)
    axes = axis_names(table)
    table.allow({"approach": TEXT} | axis_layout(table))
    if not axes:
        raise table.fail("no column names an axis", "name the axes as in 'X_mm' or 'C_deg'")
    return tuple(_pose(table, row, len(axes)) for row in table.rows)


def _pose(table: CsvTable, row: Row, axes: int) -> RawPose:
    position = read_position(table, row)
    if len(position) < axes:
        raise row.fail("the pose has an empty coordinate", "write a coordinate for every axis of the header")
    return RawPose(position, read_approach(table, row), row.line)
