"""A plain CSV table: `axis,position_mm,forward_um,reverse_um,std_um`, or `position_deg`, `forward_arcsec` ….

A table over the position of another axis has a column `over` as well. The columns hold the deviation, actual minus
nominal, not the correction: whoever loads it elsewhere subtracts it.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from axiscal.numerics import Array
from axiscal.tables.exporter import ExportOptions, TableFormat, Written
from axiscal.tables.loaded import Loaded, OldFile
from axiscal.tables.table import CompensationTable
from axiscal.units import from_unit, to_unit
from axiscal_core.machine import Machine

_STEP = 0.5e-4  # of the deviations' unit, by their four decimals
_COLUMNS = "The columns hold the deviation, actual minus nominal, of the tool relative to the workpiece: subtract it."
_STD = (
    "The column std_{unit} is the standard deviation of the value as it stands, counted from where the table is zero. "
    "The shape of the curve is known better, as said below."
)


class PlainCsv(TableFormat):
    """Deviations for people and other programs: one file for each axis, and for each axis over another."""

    holds = "the deviation of every axis over its own position and of linear axes over the others, in both directions."
    left_out = "errors that depend on two axes at once, and the orientation of the tool."
    tried = True
    points = 2000  # four an interval are rarely more than a hundred
    both_ways = True

    def write(self, tables: Sequence[CompensationTable], machine: Machine, options: ExportOptions) -> Written:
        """Return one file for each table."""
        files, steps, notes = dict[str, str](), defaultdict[str, float](float), dict[str, None]()
        for table in tables:
            name = table.axis if table.over == table.axis else f"{table.axis}_over_{table.over}"
            files[f"{name}.csv"] = text_of(table)
            steps[table.axis] += float(from_unit(2 * _STEP, table.fine_unit))
            notes[_COLUMNS] = notes[_STD.format(unit=table.fine_unit)] = None
        turning = [axis.name for axis in machine.axes if axis.cyclic]
        turns = (f"Tables of {', '.join(turning)} hold one turn and repeat after it.",) if turning else ()
        return Written(files, steps, (*notes, *turns))

    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what somebody does who takes the deviations of these tables away."""
        return Loaded(tuple(parse(file.text) for file in files))


def text_of(table: CompensationTable) -> str:
    """Return the text of the table."""
    fine = table.fine_unit
    cross = table.over != table.axis
    header = f"axis,{'over,' if cross else ''}position_{table.unit},forward_{fine},reverse_{fine},std_{fine}\n"
    name = f"{table.axis},{table.over}" if cross else table.axis
    columns = [np.round(to_unit(table.positions, table.unit), 7) + 0.0]
    columns += [np.round(to_unit(values, fine), 4) + 0.0 for values in (table.forward, table.reverse, table.std)]
    return header + "".join("{},{:.7f},{:.4f},{:.4f},{:.4f}\n".format(name, *row) for row in zip(*columns, strict=True))


def parse(text: str) -> CompensationTable:
    """Return the table of a text as `text_of` writes it."""
    header, *lines = (line.split(",") for line in text.splitlines())
    rows = [dict(zip(header, line, strict=True)) for line in lines]

    def column(stem: str) -> Array:
        name = next(each for each in header if each.startswith(f"{stem}_"))
        found: Array = from_unit(np.array([float(row[name]) for row in rows]), name.removeprefix(f"{stem}_"))
        return found

    at, forward, reverse, std = (column(stem) for stem in ("position", "forward", "reverse", "std"))
    return CompensationTable(rows[0]["axis"], at, forward, reverse, std, rows[0].get("over", ""))
