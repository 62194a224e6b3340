"""CSV tables whose header names the units, read strictly: every fault is a `ReadingError` with file, line and remedy.

One header line, `#` before a comment line.  A column is `stem` (text), or `stem_unit` or `stem [unit]` (a number);
units may stand in a line of their own below.  Lines above are titles, where two names of columns tell the header.
The header says what separates the cells: commas, semicolons or tabs.

Numbers are as each country writes them: `1.5` and `1,5`; `1'080.5`, `1,080.5` and `1.080,5` with marks of thousands. A
column has one decimal mark, by its own numbers, else by those of the other columns. `1.080` may be 1080 where the
decimal mark is a comma, or where no number of the file decides: it is refused.

Text that would be a formula in a spreadsheet is shielded, and read back. A text whose first character, quotes left
aside, is one of `= + - @`, tab or return gets an apostrophe in front; reading takes one away. Numbers stay.
"""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cached_property
from itertools import pairwise, zip_longest

from axiscal.document.quoting import meant
from axiscal.exceptions import ReadingError
from axiscal.language.spoken import later, listed, said
from axiscal.machine.error_names import AXIS_NAME
from axiscal.measurement.readers.columns import (
    ANGLES,
    LENGTHS,
    OF_READINGS,
    STEMS,
    Column,
    Units,
    column_of,
    in_deg,
    run_of,
    unit_of,
    unread,
)
from axiscal.measurement.readers.text_file import TextFile
from axiscal.measurement.reading import LARGEST
from axiscal.units import from_unit

EXAMPLE = "setup,X_mm,approach,value_um"
"""A header."""
_NO_HEADER = later("no known format begins with {text}")
_HEADER = later("give a table whose first line names the columns, such as {header}; docs/readings.md names all formats")
NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_OF_FORTRAN = re.compile(r"(?<=[\d.,])[dD](?=[+-]?\d+$)", re.ASCII)
_BETWEEN = " '\x92\N{RIGHT SINGLE QUOTATION MARK}\N{NO-BREAK SPACE}\N{NARROW NO-BREAK SPACE}\N{THIN SPACE}"
"""What stands between thousands and is no decimal mark."""
_GROUPED = re.compile(rf"[+-]?[1-9]\d{{0,2}}([.,{_BETWEEN}])\d{{3}}(?:\1\d{{3}})*(?:(?!\1)([.,])\d*)?", re.ASCII)
_EITHER = re.compile(r"[+-]?[1-9]\d{0,2}([.,])\d{3}", re.ASCII)
"""A number whose only mark may be that of thousands, or the decimal one."""
_DECIMAL = re.compile(r"[+-]?\d*([.,])\d*(?:[dDeE][+-]?\d+)?", re.ASCII)
_AXIS = re.compile(f"{AXIS_NAME}(?:_radius|_diameter)?")
_FORMULA = re.compile(r"'*[=+\-@\t\r]")
_QUOTED = re.compile(r'"[^"]*"|\([^()]*\)')
_SEPARATED, _GAP = re.compile(r"[;\t]|,(?!\d)|(?<!\d),"), re.compile(" {2,}")
"""What separates cells, no decimal comma, and what does where nothing else does."""
_NOTHING = re.compile(r"\s*#(?![;\t,])|[\s;,]*$")
_TITLES, _COLUMNS = 60, 1000
"""Lines above a header, and cells of a line, that are looked at: no program writes more."""
_HINT = re.compile(r"\s*sep=(.)\s*")
"""First line by which a spreadsheet says what separates the cells."""
_LONGEST = 60
"""Characters of what is quoted."""


def plain(text: str, mark: str) -> str:
    """Return a number with a decimal point and without marks of thousands; another text nearly as it is.

    mark : the decimal one of its column
    """
    text = _OF_FORTRAN.sub("E", text.replace("\N{MINUS SIGN}", "-"))
    found = _GROUPED.fullmatch(text)
    if found and found[1] != mark and not _EITHER.fullmatch(text):
        text = text.replace(found[1], "")
    return text.translate(str.maketrans(",.", ".,")) if mark == "," else text


def _doubtful(text: str, mark: str) -> bool:
    """Return whether nothing says if the mark of a number is that of thousands."""
    return (found := _EITHER.fullmatch(text.replace("\N{MINUS SIGN}", "-"))) is not None and found[1] != mark


def _marks(columns: Sequence[Sequence[str]], separator: str) -> list[str]:
    """Return the decimal mark of each column by its cells, "" where no number decides.

    In a file with one mark only, a point between bare commas and a comma between semicolons or tabs are decimal ones.
    """
    points, commas = (any(mark in cell for column in columns for cell in column) for mark in ".,")
    if not (commas if separator == "," else points):
        return ["." if separator == "," else ","] * len(columns)
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


@dataclass(frozen=True)
class TableLine:
    """A line of a file, where a fault can stand; that of a whole table is its header."""

    file: TextFile
    line: int

    def fail(self, what: str, remedy: str, **values: object) -> ReadingError:
        """Return the error that places a fault in this line."""
        return self.file.fail(what, remedy, self.line, **values)


@dataclass(frozen=True)
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
        if not math.isfinite(value) or _doubtful(self.text, self.column.mark):
            raise self._no_number()
        return value

    def rounding(self) -> float:
        """Return half of the last digit of a number, in SI units."""
        last = Decimal(plain(self.text, self.column.mark)).as_tuple().exponent
        return from_unit(float(Decimal(5).scaleb(int(last) - 1)), self.column.unit or self.column.stated)

    def meant(self, read: Callable[[str], int | None], what: str, remedy: str) -> int:
        """Return what it means; raises ReadingError where `read` returns None."""
        if (found := read(self.text)) is None:
            raise self.fail(what, remedy, text=self.text[:40])
        return found

    def _no_number(self) -> ReadingError:
        what = "{column} {text} is no number that a machine has"
        remedy = "write digits with a decimal point, in the unit of the header; 1.080 as 1.0800 or as 1080"
        return self.fail(what, remedy, column=self.column.name, text=_shown(self.text))


@dataclass(frozen=True)
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


@dataclass(frozen=True)
class CsvTable(TableLine):
    """A whole file: its columns and its rows, in the order of the file."""

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

    def allow(self, layout: Mapping[str, Units]) -> CsvTable:
        """Return the table if each column is in `layout` (stem -> units, TEXT for text); raises ReadingError if not.

        Raises it also where a unit was given for what names none, and all columns name theirs.
        """
        spelt = {stem: [f"{stem}_{unit}" for unit in units] or [stem] for stem, units in layout.items()}
        for column in self.columns:
            name, units = column.name[:_LONGEST], layout.get(column.stem)
            if units is not None and column.fits(units):
                continue
            if units:
                what = "column '{column}' has not the unit that it needs"
                raise self.fail(what, "it can be {known}", column=name, known=", ".join(spelt[column.stem]))
            known = [each for stem, names in spelt.items() if not self.all_of(stem) for each in names]
            first = ", ".join(names[0] for names in spelt.values())
            every = said("known are {known}; take out what is not needed", known=first)
            raise self.fail("column '{column}' is not known", meant(name, known, every), column=name)
        if self.columns[0].stated and all(column.unit or not layout[column.stem] for column in self.columns):
            raise self.fail("every column names its unit, and --unit names another", "leave --unit out")
        return self


def table_of(
    file: TextFile, header: str = EXAMPLE, words: Mapping[str, str] = OF_READINGS, usual: str = ""
) -> CsvTable:
    """Return the table that a file holds; raises ReadingError, with a header as example where there is none.

    words : stems by what they may be called in the header; usual : letters of the columns of a file without one
    """
    number, separator, columns, data = _begun(file, header, words, usual)
    texts = [_texts(file, n, line, separator, len(columns)) for n, line in data]
    if not texts:
        raise file.fail("there is a header but no data", "add one line for each reading", number)
    kept = [at for at, column in enumerate(columns) if column.stem]
    texts = [tuple(each[at] for at in kept) for each in texts]
    marks = _marks(list(zip(*texts, strict=True)), separator)
    own = tuple(replace(columns[at], mark=mark) for at, mark in zip(kept, marks, strict=True))
    rows = (Row(file, n, each, own) for (n, _), each in zip(data, texts, strict=True))
    return CsvTable(file, number, own, tuple(rows))


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
        raise file.fail(_NO_HEADER, _HEADER, text=_shown(""), header=header or EXAMPLE)
    titles = enumerate(pairwise([*data, (0, "")][: _TITLES + 1]))
    heads = ((at, one) for at, ((_, line), (_, below)) in titles if (one := _spanned(line, below)) or _names(line) > 1)
    begin, over = next(heads, (int(hint is not None), ""))
    (number, first), *data = data[begin:]
    if over:
        first, data = over, data[1:]
    separator = hint[1] if hint else "\t" if usual else _separator(first)
    plain_lines = [in_deg(line, first) for line in (first, data[0][1] if data else "")]
    if None in plain_lines:
        raise file.fail("Grad are deg in German and may be gon here", "write deg in the header", number)
    first, under = (line or "" for line in plain_lines)
    names = [] if first.lstrip().startswith(tuple("{[<")) else _cells(file, number, first, separator)
    if usual and not any(map(str.isalpha, first)):
        names, data = list(usual[: len(names)]), [(number, first), *data]
    if not names or (len(names) == 1 and not (_names(first) or _AXIS.fullmatch(names[0]))):
        raise file.fail(_NO_HEADER, _HEADER, number, text=_shown(first), header=header)
    width, below = len(names), _cells(file, data[0][0], under, separator) if data else []
    while len(names) > 1 and not names[-1]:
        names.pop()
    units = [unit_of(cell) for cell in below[:width]]
    if any(units) and all(unit or not cell for unit, cell in zip_longest(units, below)):  # in a line of their own
        names = [f"{name} [{unit}]" if unit else name for name, unit in zip_longest(names, units, fillvalue="")]
        data = data[1:]
    if any(NUMBER.fullmatch(name) for name in names) and not _names(names[0]):
        raise file.fail(_NO_HEADER, _HEADER, number, text=_shown(first), header=header)
    for index, name in enumerate(names):
        if not name or name in names[:index]:
            what, remedy = "column {column} has the name '{name}'", "give each column one name of its own"
            raise file.fail(what, remedy, number, name=name[:_LONGEST], column=index + 1)
    return number, separator, tuple(column_of(name, file.unit, words) for name in names), data


def _separator(line: str) -> str:
    """Return what separates the cells of a header."""
    return max(",;\t", key=_QUOTED.sub("", line).count)


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


def _cells(file: TextFile, number: int, line: str, separator: str) -> list[str]:
    try:
        return [cell.strip() for cell in next(csv.reader([line], strict=True, delimiter=separator))]
    except csv.Error as error:
        raise file.fail("the line is not CSV: {error}", "close every quote and cell", number, error=error) from None


def _texts(file: TextFile, number: int, line: str, separator: str, width: int) -> tuple[str, ...]:
    cells = _cells(file, number, line, separator)
    if len(cells) < width or any(cells[width:]):
        remedy = "write one cell for each column, and a decimal point in numbers: 1.5, not 1,5"
        what, text = "the line has {count} cells for {columns} columns: {text}", _shown(line)
        raise file.fail(what, remedy, number, count=len(cells), columns=width, text=text)
    return tuple(map(unshielded, cells[:width]))


def _shown(text: str) -> str:
    """Quote what somebody wrote, shortened, control characters made visible."""
    return repr(text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "...")


def csv_text(rows: Iterable[Sequence[str]]) -> str:
    """Return a CSV file of text and of numbers as they are written."""
    text = io.StringIO()
    shielded = ([f"'{c}" if _FORMULA.match(c) and not NUMBER.fullmatch(c) else c for c in row] for row in rows)
    csv.writer(text, lineterminator="\n").writerows(shielded)
    return text.getvalue()


def unshielded(cell: str) -> str:
    """Return the text that a cell stands for."""
    return cell[1:] if cell[:1] == "'" and _FORMULA.match(cell) else cell
