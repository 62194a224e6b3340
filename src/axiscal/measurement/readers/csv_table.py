"""CSV tables whose header names the units, read strictly.

One header line, `#` before a comment line.  A column is `stem` (text), or `stem_unit` or `stem [unit]` (a number);
units may stand in a line of their own below.  Lines above are titles, where two names of columns tell the header.
The header says what separates the cells: commas, semicolons or tabs.  Numbers are as `decimal_marks` has them.
Nothing is guessed: every fault is a `ReadingError` with file, line, value and remedy.

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
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import zip_longest
from pathlib import Path

from axiscal.document.quoting import meant
from axiscal.exceptions import ReadingError
from axiscal.language.spoken import later, listed, said
from axiscal.machine.entry import AXIS_NAME
from axiscal.measurement.readers.columns import (
    ANGLES,
    LENGTHS,
    OF_READINGS,
    STEMS,
    TEXT,
    Column,
    column_of,
    run_of,
    sign_of,
    unit_of,
)
from axiscal.measurement.readers.decimal_marks import NUMBER, doubtful, half_digit, marks_of, plain
from axiscal.measurement.readers.text_file import TextFile, lines_of, read_text
from axiscal.measurement.reading import LARGEST
from axiscal.units import from_unit

_FORMULA = re.compile(r"'*[=+\-@\t\r]")

_LONGEST = 60
"""Characters of what is quoted."""
_SEPARATORS, _QUOTED = ",;\t", re.compile(r'"[^"]*"|\([^()]*\)')
_NOT_FINITE = re.compile(r"[+-]?(nan|inf|infinity)", re.IGNORECASE)
_NOTHING = re.compile(r"\s*#|[\s;,]*$")
_TITLES = 60
"""Lines with more titles above the header than any program writes are no table."""
_COLUMNS = 1000
"""Cells of a line that are looked at before it is known as a header."""
_HINT = re.compile(r"\s*sep=(.)\s*")
"""First line by which a spreadsheet says what separates the cells."""


@dataclass(frozen=True, slots=True)
class Row:
    """One line of data: cells by header, stripped of white space, shields taken away."""

    file: str
    line: int
    cells: Mapping[str, str]

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
        text = self._plain(column)
        value = float(text) if NUMBER.fullmatch(text) else math.nan
        if not math.isfinite(value) or doubtful(self.text(column), column.mark):
            raise self._no_number(column)
        return value

    def rounding(self, column: Column) -> float:
        """Return half of the last digit of a number, in SI units."""
        return from_unit(half_digit(self._plain(column)), column.unit or column.stated)

    def _plain(self, column: Column) -> str:
        return plain(self.text(column), column.mark)

    def _no_number(self, column: Column) -> ReadingError:
        text = self.text(column)
        what, remedy = _why_not(text, column.mark)
        return self.fail(what, remedy, column=column.name, text=_quote(text), better=text.replace(",", "."))

    def meant(self, column: Column, read: Callable[[str], int | None], what: str, remedy: str) -> int:
        """Return what a cell means; raises ReadingError where `read` returns None."""
        if (found := read(self.text(column))) is None:
            raise self.fail(what, remedy, text=self.text(column)[:40])
        return found

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
        raise self.fail("there is no column '{example}'", "name it in the header; found: {found}", example=example)

    def needed(self, layout: Mapping[str, tuple[str, ...]], *names: str) -> tuple[Column, ...]:
        """Return the columns that names such as `target_mm` are examples of, in whatever units.

        layout : stems that may be there, with their units.  Raises ReadingError for another, or where one is missing.
        """
        self.allow(layout)
        return tuple(self.one_of(column_of(name).stem, name) for name in names)

    def fail(self, what: str, remedy: str, **values: object) -> ReadingError:
        """Return the error that places a fault in the header, `found`."""
        found = ",".join(column.name for column in self.columns)
        return ReadingError(what, remedy, self.file, self.line, **{"found": found, **values})

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


def parse_table(text: str, file: str) -> CsvTable:
    """Parse a table from text; `file` is the name that errors carry.  Raises ReadingError."""
    return table_of(TextFile(file, lines_of(text, file)))


EXAMPLE = "setup,X_mm,approach,value_um"
"""A header."""


def table_of(
    file: TextFile, header: str = EXAMPLE, words: Mapping[str, str] = OF_READINGS, usual: str = ""
) -> CsvTable:
    """Return the table that a file holds; raises ReadingError, with a header as example where there is none.

    words : stems by what they may be called in the header; usual : letters of the columns of a file without one
    """
    number, separator, columns, data = _begun(file, header, words, usual)
    rows = [_row(file.name, n, line, _cells(file.name, n, line, separator), columns) for n, line in data]
    if not rows:
        raise file.fail("there is a header but no data", "add one line for each reading", number)
    marks = marks_of([[row.text(column) for row in rows] for column in columns], separator)
    columns = tuple(replace(column, mark=each) for column, each in zip(columns, marks, strict=True))
    return CsvTable(file.name, number, columns, tuple(rows))


def header_of(file: TextFile, words: Mapping[str, str]) -> tuple[Column, ...]:
    """Return the columns that the header of a file names, none where it has none."""
    try:
        return _begun(file, "", words)[2]
    except ReadingError:
        return ()


def _begun(
    file: TextFile, header: str, words: Mapping[str, str], usual: str = ""
) -> tuple[int, str, tuple[Column, ...], list[tuple[int, str]]]:
    """Return the line of the header, what separates cells, the columns, and the lines of data; raises ReadingError."""
    data = [(number, line) for number, line in enumerate(file.lines, 1) if not _NOTHING.match(line)]
    hint = _HINT.fullmatch(data[0][1]) if data else None
    if not data[bool(hint) :]:
        raise file.fail("there is no header and no data", "let the first line name the columns")
    begin = next((at for at, (_, line) in enumerate(data[:_TITLES]) if _names(line) > 1), int(hint is not None))
    (number, first), *data = data[begin:]
    separator = hint[1] if hint else "\t" if usual else _separator(first)
    names = _cells(file.name, number, first, separator)
    if usual and not any(map(str.isalpha, first)):
        names, data = list(usual[: len(names)]), [(number, first), *data]
    if len(names) == 1 and not (_names(first) or _AXIS.fullmatch(names[0])):
        raise file.fail("no known format begins with {text}", "docs/readings.md names all", number, text=_quote(first))
    width, below = len(names), _cells(file.name, *data[0], separator) if data else []
    while len(names) > 1 and not names[-1]:
        names.pop()
    units = [unit_of(cell) for cell in below[:width]]
    if any(units) and all(unit or not cell for unit, cell in zip_longest(units, below)):  # in a line of their own
        names = [f"{name} [{unit}]" if unit else name for name, unit in zip_longest(names, units, fillvalue="")]
        data = data[1:]
    return number, separator, _columns(file, number, names, header, words), data


def _separator(line: str) -> str:
    """Return what separates the cells of a header."""
    return max(_SEPARATORS, key=_QUOTED.sub("", line).count)


def _names(line: str) -> int:
    """Return how many cells of a line are known as names of columns."""
    cells, words = line.split(_separator(line), _COLUMNS)[:_COLUMNS], STEMS.keys() | OF_READINGS
    columns = [column_of(cell.strip(' "')) for cell in cells]
    return sum(bool(each.unit or each.stem.lower() in words or run_of(each.stem)) for each in columns)


def _cells(file: str, number: int, line: str, separator: str) -> list[str]:
    try:
        return [cell.strip() for cell in next(csv.reader([line], strict=True, delimiter=separator))]
    except csv.Error as error:
        remedy = "close every quote and cell"
        raise ReadingError("the line is not CSV: {error}", remedy, file, number, error=error) from None


def _columns(
    file: TextFile, number: int, names: list[str], header: str, words: Mapping[str, str]
) -> tuple[Column, ...]:
    if any(NUMBER.fullmatch(name) for name in names):
        remedy = "let the first line be the header, such as {header}"
        raise file.fail("the first line holds numbers and names no columns", remedy, number, header=header)
    for index, name in enumerate(names):
        if not name or name in names[:index]:
            what = "column '{name}' is named twice" if name else "column {column} has no name"
            name, remedy = name[:_LONGEST], "give each column one name of its own"
            raise file.fail(what, remedy, number, name=name, column=index + 1)
    return tuple(column_of(name, file.unit, words) for name in names)


def _row(file: str, number: int, line: str, cells: list[str], columns: tuple[Column, ...]) -> Row:
    if len(cells) < len(columns) or any(cells[len(columns) :]):
        remedy = "write one cell for each column, and a decimal point in numbers: 1.5, not 1,5"
        what, text = "the line has {count} cells for {columns} columns: {text}", _quote(line)
        raise ReadingError(what, remedy, file, number, count=len(cells), columns=len(columns), text=text)
    named = zip(columns, cells, strict=False)
    return Row(file, number, {column.name: unshielded(cell) for column, cell in named})


def _quote(text: str) -> str:
    """Quote what somebody wrote, shortened, control characters made visible."""
    return repr(text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "...")


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


def csv_text(rows: Iterable[Sequence[str]]) -> str:
    """Return a CSV file of text and of numbers as they are written."""
    text = io.StringIO()
    shielded = ([f"'{c}" if _FORMULA.match(c) and not NUMBER.fullmatch(c) else c for c in row] for row in rows)
    csv.writer(text, lineterminator="\n").writerows(shielded)
    return text.getvalue()


def unshielded(cell: str) -> str:
    """Return the text that a cell stands for."""
    return cell[1:] if cell[:1] == "'" and _FORMULA.match(cell) else cell


_APPROACH = re.compile(f"([+−-])?({AXIS_NAME})([+−-])?")


_AXIS = re.compile(f"{AXIS_NAME}(?:_radius|_diameter)?")


def axis_names(table: CsvTable) -> tuple[str, ...]:
    """Return the axes that have a column, in the order of the header; "X_diameter" where it says what X is."""
    return tuple(dict.fromkeys(column.stem for column in table.columns if _AXIS.fullmatch(column.stem)))


def axis_layout(table: CsvTable) -> dict[str, tuple[str, ...]]:
    """Return which columns may name an axis, with the units of each: the usual axes and those of this table."""
    return {name: ANGLES if name[0] in "ABC" else LENGTHS for name in (*"XYZABC", *axis_names(table))}


def axis_columns(table: CsvTable, row: Row) -> dict[str, Column]:
    """Return the column of each coordinate that a line gives, by axis."""
    columns = ((name, row.only_filled(table.all_of(name))) for name in axis_names(table))
    return {name: column for name, column in columns if column is not None}


def approach_of(text: str) -> dict[str, int] | None:
    """Return the direction of the last motion (+1, -1) by axis from `X+ Y-`, `X+;Y-` or `+X`, None where it is none."""
    found = [_APPROACH.fullmatch(each) for each in re.split(r"[\s,;]+", text) if each]
    approach = {each[2]: sign for each in found if each and (sign := sign_of((each[1] or "") + (each[3] or "")))}
    return approach if len(approach) == len(found) else None


@dataclass(frozen=True, slots=True)
class RawPose:
    """One pose as written: coordinate (m or rad) by axis, direction of approach (+1, -1) by axis, line of the file.

    setup : of a reading that is planned
    """

    position: Mapping[str, float]
    approach: Mapping[str, int]
    line: int
    setup: str = ""


def raw_pose(table: CsvTable, row: Row, *, alone: bool = False) -> RawPose:
    """Return the pose of a line, without axes whose cells are empty; raises ReadingError.

    alone : the approach may be a direction such as `+`, of the axis ''
    """
    position = {name: row.quantity(column) for name, column in axis_columns(table, row).items()}
    text = next((row.text(column) for column in table.all_of("approach")), "")
    approach = {"": sign} if alone and (sign := sign_of(text)) else approach_of(text)
    if approach is None:
        remedy = "write each axis once with its direction, as in 'X+' or 'X+ Y-', or leave it empty"
        raise row.fail("approach {text!r} cannot be read", remedy, text=text)
    return RawPose(position, approach, row.line)


def read_poses(path: str | Path) -> tuple[RawPose, ...]:
    """Read poses in the order of the file, each with a coordinate in every axis column; raises ReadingError."""
    table = table_of(read_text(path))
    axes = axis_names(table)
    table.allow({"approach": TEXT} | axis_layout(table))
    if not axes:
        raise table.fail("no column names an axis", "name the axes as in 'X_mm' or 'C_deg'")
    for row in table.rows:
        if len(axis_columns(table, row)) < len(axes):
            raise row.fail("the pose has an empty coordinate", "write a coordinate for every axis of the header")
    return tuple(raw_pose(table, row) for row in table.rows)
