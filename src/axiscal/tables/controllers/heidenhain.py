"""HEIDENHAIN `.COM` tables, into a file that the user's own control has saved.

One table for each axis: its positions, the backlash, and a column for each axis that is corrected at them. The layout
is that of the template: head, column heads and widths, and end; only the rows are new.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.numerics import Array
from axiscal.tables.exporter import ExportOptions, TableFormat, Written, paragraphs, sign_said
from axiscal.tables.loaded import Loaded, OldFile
from axiscal.tables.table import CompensationTable
from axiscal.units import from_unit, to_unit
from axiscal_core.machine import Machine

_NUMBER = r"[+-]?\d+(?:\.\d+)?"
_EXPECTED = (
    "it begins with BEGIN NAME .COM, then a line of column heads with AXISPOS, BACKLASH and axes, then rows of "
    "numbers, and ends with [END]"
)


@dataclass(frozen=True, slots=True)
class Layout:
    """The form of a `.COM` file.

    first, header, last : its lines around the rows; heads : the names of its columns
    edges : for each column where its values begin (with True) or end (False); decimals : of the values
    """

    first: str
    header: str
    heads: tuple[str, ...]
    edges: tuple[tuple[int, bool], ...]
    last: str
    decimals: int

    def text(self, name: str, columns: Mapping[str, Array]) -> str:
        """Return a file with these columns, each value ending where the template's do; absent columns are zero."""
        count = len(columns["AXISPOS"])
        first = re.sub(r"(?<=BEGIN )\S+?(?=\s*\.COM)", name, self.first)
        values = {**columns, "NR": np.arange(count)}
        zero = np.zeros(count)
        table = np.stack([values.get(head, zero) for head in self.heads], axis=1)
        rows = [self._row(dict(zip(self.heads, row, strict=True))) for row in table.tolist()]
        return "\n".join([first, self.header, *rows, self.last]) + "\n"

    def _row(self, values: Mapping[str, float]) -> str:
        line = ""
        for head, (edge, left) in zip(self.heads, self.edges, strict=True):
            decimals = 0 if head == "NR" else self.decimals
            shown = f"{round(values[head], decimals) + 0.0:.{decimals}f}"
            start = edge if left else edge - len(shown)
            if start < len(line) + bool(line):
                what = "the columns of the template are too narrow for {shown}"
                raise TableError(what, "widen them up to {head}", shown=shown, head=head)
            line = line.ljust(start) + shown
        return line


_SIGN = "page 716 of the Technical Manual MANUALplus 620 states the columns of .COM tables and not their sign"


class Heidenhain(TableFormat):
    """`.COM` tables in the form of the template."""

    holds = "for each axis its positioning error and reversal, and over linear axes the straightness and squareness."
    left_out = "errors that depend on two axes at once, the reversal of straightness, and axes that have no column."
    points = 256  # by HEIDENHAIN's manual: lines of a table
    takes = frozenset({"--template", "--spacing"})
    unstated = "own"

    def tables(self, estimate: Estimate, options: ExportOptions) -> tuple[CompensationTable, ...]:
        """Return the tables that the template has a column for; those over one axis have the same points."""
        layout = read_layout(options.saved("HEIDENHAIN"), options.template_name)
        return tuple(table for table in super().tables(estimate, options) if table.axis in layout.heads)

    def write(self, tables: Sequence[CompensationTable], machine: Machine, options: ExportOptions) -> Written:
        """Return one file for each axis, in the form of the template."""
        layout, sign = read_layout(options.saved("HEIDENHAIN"), options.template_name), options.sign
        files = {
            f"{axis}_AXIS.COM": _file(layout, axis, tables, sign) for axis in dict.fromkeys(t.over for t in tables)
        }
        step = 10.0**-layout.decimals
        steps = {axis.name: 3 * float(from_unit(step, axis.unit)) for axis in machine.axes}
        return Written(files, steps, _notes(layout, machine), first=sign_said(options, _SIGN))

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what tables do; raises TableError."""
        return Loaded(tuple(one for file in files for one in _read(file, machine, options.sign)))


def read_layout(text: str, file: str) -> Layout:
    """Return the form of a template; raises TableError, with what was expected, for anything else."""
    lines = [line.rstrip() for line in text.splitlines() if line.strip()]
    if len(lines) < 4 or not re.match(r"BEGIN \S+?\s*\.COM\b", lines[0]) or not lines[-1].startswith("[END]"):
        raise TableError("this is not a .COM table", _EXPECTED, file)
    if re.search(r"\bINCH\b|DATUM:[-+]?[0.]*[1-9]", lines[0]):
        what = "{text!r} is not in millimetres from the machine datum"
        raise TableError(what, "save a table in MM with DATUM:+0", file, 1, text=lines[0].strip()[:60])
    heads = tuple(lines[1].split())
    if "AXISPOS" not in heads or "BACKLASH" not in heads or len(set(heads)) < len(heads):
        raise TableError("the column heads are {text!r}", _EXPECTED, file, 2, text=lines[1].strip()[:60])
    for number, line in enumerate(lines[2:-1], 3):
        if len(line.split()) != len(heads) or not all(re.fullmatch(_NUMBER, word) for word in line.split()):
            raise TableError("{text!r} does not fit the column heads", _EXPECTED, file, number, text=line.strip()[:60])
    begun, ended = ([m.span()[side] for m in re.finditer(r"\S+", lines[2])] for side in (0, 1))
    above = [match.start() for match in re.finditer(r"\S+", lines[1])]
    edges = tuple((b, True) if a == b else (e, False) for a, b, e in zip(above, begun, ended, strict=True))
    words = dict(zip(heads, lines[2].split(), strict=True))
    decimals = max(len(word.partition(".")[2]) for head, word in words.items() if head != "NR")
    if decimals < 3:
        remedy = "save a table with values to 0.001 mm or finer"
        raise TableError("the values have {decimals} decimals", remedy, file, decimals=decimals)
    return Layout(lines[0], lines[1], heads, edges, lines[-1], decimals)


def _read(file: OldFile, machine: Machine, sign: float) -> list[CompensationTable]:
    """Return what the control makes of one file: the axis that its name begins with is looked up."""
    read_layout(file.text, file.name)
    first, header, *rows, _ = (line for line in file.text.splitlines() if line.strip())
    over = machine.axis(re.split(r"[_.]", first.split()[1])[0])
    table = np.array([[float(word) for word in row.split()] for row in rows])
    columns = dict(zip(header.split(), table.T, strict=True))
    at = from_unit(columns["AXISPOS"], over.unit)
    tables = []
    for axis in (axis for axis in machine.axes if axis.name in columns):
        values, step = (sign * from_unit(columns[name], axis.unit) for name in (axis.name, "BACKLASH"))
        tables.append(CompensationTable(axis.name, at, values, values + step * (axis is over), over=over.name))
    return tables


def _file(layout: Layout, axis: str, tables: Sequence[CompensationTable], sign: float) -> str:
    mine = [table for table in tables if table.over == axis]
    columns = {"AXISPOS": np.asarray(to_unit(mine[0].positions, mine[0].unit))}
    for table in mine:
        unit = table.value_unit()
        columns[table.axis] = sign * np.asarray(to_unit(table.forward, unit))
        if table.axis == axis:
            columns["BACKLASH"] = sign * np.asarray(to_unit(table.reverse - table.forward, unit))
    return layout.text(f"{axis}_AXIS", columns)


def _notes(layout: Layout, machine: Machine) -> tuple[str, ...]:
    missing = [axis.name for axis in machine.axes if axis.name not in layout.heads]
    turning = [axis.name for axis in machine.axes if axis.cyclic and axis.name in layout.heads]
    return paragraphs("axiscal.tables", "heidenhain.jinja", missing=missing, turning=turning)
