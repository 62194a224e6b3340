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

_NUMBER = re.compile(r"[+-]?\d+(?:\.\d+)?")
_EXPECTED = (
    "it begins with BEGIN NAME .COM, then a line of column heads with AXISPOS, BACKLASH and axes, then rows of "
    "numbers, and ends with [END]"
)
_SIGN = "page 716 of the Technical Manual MANUALplus 620 states the columns of .COM tables and not their sign"


@dataclass(frozen=True, slots=True)
class Layout:
    """The form of a `.COM` file.

    first, header, last : its lines around the rows; heads : the names of its columns; rows : words of each row
    edges : for each column where its values begin (with True) or end (False); decimals : of the values
    """

    first: str
    header: str
    last: str
    heads: tuple[str, ...]
    rows: tuple[list[str], ...]
    edges: tuple[tuple[int, bool], ...]
    decimals: int

    @classmethod
    def of_text(cls, text: str, file: str) -> Layout:
        """Return the form of a file; raises TableError, with what was expected, for anything else."""
        lines = [line.rstrip() for line in text.splitlines() if line.strip()]
        first, header, *body, last = lines if len(lines) > 3 else [*lines, *[""] * 4][:4]
        heads, rows = tuple(header.split()), tuple(line.split() for line in body)
        named = {"AXISPOS", "BACKLASH"} <= {*heads} and len({*heads}) == len(heads)
        whole = [len(row) == len(heads) and all(map(_NUMBER.fullmatch, row)) for row in rows]
        fits = [bool(re.match(r"BEGIN \S+?\s*\.COM\b", first)), named, *whole, last.startswith("[END]")]
        if not all(fits):
            shown = [first, header, *body, last][fits.index(False)].strip()[:60]
            raise TableError("{text!r} is no line of a .COM table", _EXPECTED, file, fits.index(False) + 1, text=shown)
        if re.search(r"\bINCH\b|DATUM:[-+]?[0.]*[1-9]", first):
            what = "{text!r} is not in millimetres from the machine datum"
            raise TableError(what, "save a table in MM with DATUM:+0", file, 1, text=first.strip()[:60])
        above, below = ([match.span() for match in re.finditer(r"\S+", line)] for line in (header, body[0]))
        edges = tuple((b, True) if a == b else (e, False) for (a, _), (b, e) in zip(above, below, strict=True))
        decimals = max(len(w.partition(".")[2]) for head, w in zip(heads, rows[0], strict=True) if head != "NR")
        if decimals < 3:
            remedy = "save a table with values to 0.001 mm or finer"
            raise TableError("the values have {decimals} decimals", remedy, file, decimals=decimals)
        return cls(first, header, last, heads, rows, edges, decimals)

    def text(self, name: str, columns: Mapping[str, Array]) -> str:
        """Return a file with these columns, each value ending where the template's do; absent columns are zero."""
        count, lines = len(columns["AXISPOS"]), [re.sub(r"(?<=BEGIN )\S+?(?=\s*\.COM)", name, self.first), self.header]
        own = {**columns, "NR": np.arange(count)}
        for row in np.stack([own.get(head, np.zeros(count)) for head in self.heads], axis=1).tolist():
            line = ""
            for head, (edge, left), value in zip(self.heads, self.edges, row, strict=True):
                decimals = 0 if head == "NR" else self.decimals
                shown = f"{round(value, decimals) + 0.0:.{decimals}f}"
                start = edge if left else edge - len(shown)
                if start < len(line) + bool(line):
                    what = "the columns of the template are too narrow for {shown}"
                    raise TableError(what, "widen them up to {head}", shown=shown, head=head)
                line = line.ljust(start) + shown
            lines.append(line)
        return "\n".join([*lines, self.last]) + "\n"


class Heidenhain(TableFormat):
    """`.COM` tables in the form of the template."""

    holds = "for each axis its positioning error and reversal, and over linear axes the straightness and squareness."
    left_out = "errors that depend on two axes at once, the reversal of straightness, and axes that have no column."
    points = 256  # by HEIDENHAIN's manual: lines of a table
    takes = frozenset({"--template", "--spacing"})
    unstated = "own"

    def tables(self, estimate: Estimate, options: ExportOptions) -> tuple[CompensationTable, ...]:
        """Return the tables that the template has a column for; those over one axis have the same points."""
        heads = _template(options).heads
        return tuple(table for table in super().tables(estimate, options) if table.axis in heads)

    def write(self, tables: Sequence[CompensationTable], machine: Machine, options: ExportOptions) -> Written:
        """Return one file for each axis, in the form of the template."""
        layout, columns = _template(options), dict[str, dict[str, Array]]()
        for table in tables:
            own = columns.setdefault(table.over, {"AXISPOS": np.asarray(to_unit(table.positions, table.unit))})
            forward, reverse = (
                options.sign * to_unit(each, table.value_unit()) for each in (table.forward, table.reverse)
            )
            own |= {table.axis: forward} | ({"BACKLASH": reverse - forward} if table.over == table.axis else {})
        files = {f"{axis}_AXIS.COM": layout.text(f"{axis}_AXIS", own) for axis, own in columns.items()}
        steps = {axis.name: 3 * float(from_unit(10.0**-layout.decimals, axis.unit)) for axis in machine.axes}
        missing = [axis.name for axis in machine.axes if axis.name not in layout.heads]
        turning = [axis.name for axis in machine.axes if axis.cyclic and axis.name in layout.heads]
        notes = paragraphs("axiscal.tables", "heidenhain.jinja", missing=missing, turning=turning)
        return Written(files, steps, notes, first=sign_said(options, _SIGN))

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what tables do: the axis that a file's name begins with is looked up; raises TableError."""
        tables = list[CompensationTable]()
        for layout in (Layout.of_text(file.text, file.name) for file in files):
            over = machine.axis(re.split(r"[_.]", layout.first.split()[1])[0])
            columns = dict(zip(layout.heads, np.array(layout.rows, dtype=float).T, strict=True))
            at = from_unit(columns["AXISPOS"], over.unit)
            for axis in (axis for axis in machine.axes if axis.name in columns):
                up, step = (options.sign * from_unit(columns[name], axis.unit) for name in (axis.name, "BACKLASH"))
                tables.append(CompensationTable(axis.name, at, up, up + step * (axis is over), over=over.name))
        return Loaded(tuple(tables))


def _template(options: ExportOptions) -> Layout:
    return Layout.of_text(options.saved("HEIDENHAIN"), options.template_name)
