"""CSV tables whose header names the units, read strictly.

One header line, `#` before a comment line.  A column is `stem` (text), or `stem_unit` or `stem [unit]` (a number);
units may stand in a line of their own below.  Lines above are titles, where two names of columns tell the header.
The header says what separates the cells: commas, semicolons or tabs.  Numbers are as `table_cells` has them.
Nothing is guessed: every fault is a `ReadingError` with file, line, value and remedy.

Text that would be a formula in a spreadsheet is shielded, and read back. A text whose first character, quotes left
aside, is one of `= + - @`, tab or return gets an apostrophe in front. A spreadsheet takes that for "this is text";
reading takes one away. Numbers stay. So every text comes back.

Axis columns `X_mm … C_deg` and the column `approach`, as readings and poses share them.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise, zip_longest

from axiscal.document.quoting import meant
from axiscal.exceptions import ReadingError
from axiscal.language.spoken import said
from axiscal.machine.error_names import AXIS_NAME
from axiscal.measurement.readers.columns import (
    ANGLES,
    GERMAN,
    GRAD,
    LENGTHS,
    OF_READINGS,
    STEMS,
    Column,
    Units,
    column_of,
    run_of,
    sign_of,
    unit_of,
)
from axiscal.measurement.readers.table_cells import LONGEST, NUMBER, Row, TableLine, marks_of, quoted
from axiscal.measurement.readers.text_file import TextFile

EXAMPLE = "setup,X_mm,approach,value_um"
"""A header."""
_APPROACH = re.compile(f"([+−-])?({AXIS_NAME})([+−-])?")
_AXIS = re.compile(f"{AXIS_NAME}(?:_radius|_diameter)?")
_FORMULA = re.compile(r"'*[=+\-@\t\r]")
_SEPARATORS, _QUOTED = ",;\t", re.compile(r'"[^"]*"|\([^()]*\)')
_SEPARATED, _GAP = re.compile(r"[;\t]|,(?!\d)|(?<!\d),"), re.compile(" {2,}")
"""What separates cells, no decimal comma, and what does where nothing else does."""
_NOTHING = re.compile(r"\s*#(?![;\t,])|[\s;,]*$")
_TITLES = 60
"""Lines with more titles above the header than any program writes are no table."""
_COLUMNS = 1000
"""Cells of a line that are looked at before it is known as a header."""
_HINT = re.compile(r"\s*sep=(.)\s*")
"""First line by which a spreadsheet says what separates the cells."""


@dataclass(frozen=True)
class CsvTable(TableLine):
    """A whole file: its columns and its rows, in the order of the file; its line is that of the header."""

    columns: tuple[Column, ...]
    rows: tuple[Row, ...]

    def with_columns(self, columns: Iterable[Column]) -> CsvTable:
        """Return the table with other units or marks of the same columns."""
        own = tuple(columns)
        return replace(self, columns=own, rows=tuple(replace(row, columns=own) for row in self.rows))

    @cached_property
    def axes(self) -> tuple[str, ...]:
        """The axes that have a column, in the order of the header; "X_diameter" where it says what X is."""
        return tuple(dict.fromkeys(column.stem for column in self.columns if _AXIS.fullmatch(column.stem)))

    @property
    def axis_layout(self) -> dict[str, Units]:
        """Which columns may name an axis, with the units of each: the usual axes and those of this table."""
        return {name: ANGLES if name[0] in "ABC" else LENGTHS for name in (*"XYZABC", *self.axes)}

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
        what, names = "there is no column '{example}'", ",".join(column.name for column in self.columns)
        raise self.fail(what, "name it in the header; found: {found}", example=example, found=names)

    def needed(self, layout: Mapping[str, Units], *names: str) -> tuple[Column, ...]:
        """Return the columns that names such as `target_mm` are examples of, in whatever units.

        layout : stems that may be there, with their units.  Raises ReadingError for another, or where one is missing.
        """
        self.allow(layout)
        return tuple(self.one_of(column_of(name).stem, name) for name in names)

    def allow(self, layout: Mapping[str, Units]) -> CsvTable:
        """Return the table if each column is in `layout` (stem -> units, TEXT for text); raises ReadingError if not.

        Raises it also where a unit was given for what names none, and all columns name theirs.
        """
        for column in self.columns:
            if column.stem not in layout or not column.fits(layout[column.stem]):
                raise self._unknown(column, layout)
        if self.columns[0].stated and all(column.unit or not layout[column.stem] for column in self.columns):
            raise self.fail("every column names its unit, and --unit names another", "leave --unit out")
        return self

    def _unknown(self, column: Column, layout: Mapping[str, Units]) -> ReadingError:
        name = column.name[:LONGEST]
        spelt = {stem: [f"{stem}_{unit}" for unit in units] or [stem] for stem, units in layout.items()}
        if layout.get(column.stem):
            what = "column '{column}' has a unit of the wrong kind" if column.unit else "column '{column}' has no unit"
            return self.fail(what, "it can be {known}", column=name, known=", ".join(spelt[column.stem]))
        known = [name for stem, names in spelt.items() if not self.all_of(stem) for name in names]
        first = ", ".join(names[0] for names in spelt.values())
        every = said("known are {known}; take out what is not needed", known=first)
        return self.fail("column '{column}' is not known", meant(name, known, every), column=name)


def table_of(
    file: TextFile, header: str = EXAMPLE, words: Mapping[str, str] = OF_READINGS, usual: str = ""
) -> CsvTable:
    """Return the table that a file holds; raises ReadingError, with a header as example where there is none.

    words : stems by what they may be called in the header; usual : letters of the columns of a file without one
    """
    number, separator, columns, data = _begun(file, header, words, usual)
    texts = [_texts(file.name, n, line, separator, len(columns)) for n, line in data]
    if not texts:
        raise file.fail("there is a header but no data", "add one line for each reading", number)
    kept = [at for at, column in enumerate(columns) if column.stem]
    columns, texts = tuple(columns[at] for at in kept), [tuple(each[at] for at in kept) for each in texts]
    marks = marks_of(list(zip(*texts, strict=True)), separator)
    columns = tuple(replace(column, mark=each) for column, each in zip(columns, marks, strict=True))
    rows = (Row(file.name, n, each, columns) for (n, _), each in zip(data, texts, strict=True))
    return CsvTable(file.name, number, columns, tuple(rows))


def header_of(file: TextFile, words: Mapping[str, str]) -> tuple[Column, ...]:
    """Return the columns that the header of a file names, none where it has none."""
    try:
        return tuple(column for column in _begun(file, "", words)[2] if column.stem)
    except ReadingError:
        return ()


def _begun(
    file: TextFile, header: str, words: Mapping[str, str], usual: str = ""
) -> tuple[int, str, tuple[Column, ...], list[tuple[int, str]]]:
    """Return the line of the header, what separates cells, the columns, and the lines of data; raises ReadingError."""
    data = [(number, line) for number, line in enumerate(file.lines, 1) if not _NOTHING.match(line)]
    if not any(_SEPARATED.search(line) for _, line in data):
        data = [(number, _GAP.sub("\t", line.strip())) for number, line in data]
    hint = _HINT.fullmatch(data[0][1]) if data else None
    if not data[bool(hint) :]:
        raise file.fail("there is no header and no data", "let the first line name the columns")
    titles = enumerate(pairwise([*data, (0, "")][: _TITLES + 1]))
    heads = ((at, one) for at, ((_, line), (_, below)) in titles if (one := _spanned(line, below)) or _names(line) > 1)
    begin, over = next(heads, (int(hint is not None), ""))
    (number, first), *data = data[begin:]
    if over:
        first, data = over, data[1:]
    separator = hint[1] if hint else "\t" if usual else _separator(first)
    first, under = (_in_deg(file, number, line, first) for line in (first, data[0][1] if data else ""))
    names = [] if first.lstrip().startswith(tuple("{[<")) else _cells(file.name, number, first, separator)
    if usual and not any(map(str.isalpha, first)):
        names, data = list(usual[: len(names)]), [(number, first), *data]
    if not names or (len(names) == 1 and not (_names(first) or _AXIS.fullmatch(names[0]))):
        what, remedy = "no known format begins with {text}", "give a table such as {header}; docs/readings.md names all"
        raise file.fail(what, remedy, number, text=quoted(first), header=header)
    width, below = len(names), _cells(file.name, data[0][0], under, separator) if data else []
    while len(names) > 1 and not names[-1]:
        names.pop()
    units = [unit_of(cell) for cell in below[:width]]
    if any(units) and all(unit or not cell for unit, cell in zip_longest(units, below)):  # in a line of their own
        names = [f"{name} [{unit}]" if unit else name for name, unit in zip_longest(names, units, fillvalue="")]
        data = data[1:]
    return number, separator, _columns(file, number, names, header, words), data


def _in_deg(file: TextFile, number: int, line: str, header: str) -> str:
    """Return a line of a header with deg for the Grad of a German one; raises ReadingError for those of another."""
    if GRAD.search(line) and not GERMAN.search(header):
        raise file.fail("Grad are deg in German and may be gon here", "write deg in the header", number)
    return GRAD.sub("deg", line)


def _separator(line: str) -> str:
    """Return what separates the cells of a header."""
    return max(_SEPARATORS, key=_QUOTED.sub("", line).count)


def _spanned(line: str, below: str) -> str:
    """Return a header of two lines as one, with runs below what spans them; "" where these are none."""
    separator, names, wide = _separator(line), list[str](), column_of("")
    over, under = (_split(each.rstrip(separator)) for each in (line, below))
    for above, own in zip_longest(over, under, fillvalue="") if "" in over or len(under) > len(over) else ():
        wide = column_of(above) if above else wide
        name = f"{wide.stem} {own}" + (f" [{wide.unit}]" if wide.unit and not column_of(own).unit else "")
        if not (own and STEMS.get(wide.stem.lower(), "run") in ("run", "deviation") and run_of(column_of(name).stem)):
            unit = unit_of(own)
            name = (f"{above} [{unit}]" if unit else "") if above and own else above or own
        names.append(name)
    return header if _names(header := separator.join(names)) == len(names) > 1 else ""


def _split(line: str) -> list[str]:
    return [cell.strip(' "') for cell in line.split(_separator(line), _COLUMNS)[:_COLUMNS]]


def _names(line: str) -> int:
    """Return how many cells of a line are known as names of columns."""
    columns, words = [*map(column_of, _split(line))], STEMS.keys() | OF_READINGS
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
    if any(NUMBER.fullmatch(name) for name in names) and not _names(names[0]):
        remedy = "let the first line be the header, such as {header}"
        raise file.fail("the first line holds numbers and names no columns", remedy, number, header=header)
    for index, name in enumerate(names):
        if not name or name in names[:index]:
            what = "column '{name}' is named twice" if name else "column {column} has no name"
            name, remedy = name[:LONGEST], "give each column one name of its own"
            raise file.fail(what, remedy, number, name=name, column=index + 1)
    return tuple(column_of(name, file.unit, words) for name in names)


def _texts(file: str, number: int, line: str, separator: str, width: int) -> tuple[str, ...]:
    cells = _cells(file, number, line, separator)
    if len(cells) < width or any(cells[width:]):
        remedy = "write one cell for each column, and a decimal point in numbers: 1.5, not 1,5"
        what, text = "the line has {count} cells for {columns} columns: {text}", quoted(line)
        raise ReadingError(what, remedy, file, number, count=len(cells), columns=width, text=text)
    return tuple(map(unshielded, cells[:width]))


def csv_text(rows: Iterable[Sequence[str]]) -> str:
    """Return a CSV file of text and of numbers as they are written."""
    text = io.StringIO()
    shielded = ([f"'{c}" if _FORMULA.match(c) and not NUMBER.fullmatch(c) else c for c in row] for row in rows)
    csv.writer(text, lineterminator="\n").writerows(shielded)
    return text.getvalue()


def unshielded(cell: str) -> str:
    """Return the text that a cell stands for."""
    return cell[1:] if cell[:1] == "'" and _FORMULA.match(cell) else cell


def approach_of(text: str) -> dict[str, int] | None:
    """Return the direction of the last motion (+1, -1) by axis from `X+ Y-`, `X+;Y-` or `+X`, None where it is none."""
    found = [_APPROACH.fullmatch(each) for each in re.split(r"[\s,;]+", text) if each]
    approach = {each[2]: sign for each in found if each and (sign := sign_of((each[1] or "") + (each[3] or "")))}
    return approach if len(approach) == len(found) else None
