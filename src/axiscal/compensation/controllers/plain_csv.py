"""A plain CSV table: `axis,position_mm,forward_um,reverse_um,std_um`, or `position_deg`, `forward_arcsec` ….

A table over the position of another axis has a column `over` as well. The columns hold the deviation, actual minus
nominal, not the correction: whoever loads it elsewhere subtracts it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.compensation.effect import table_control
from axiscal.compensation.export_options import ExportOptions
from axiscal.compensation.loaded import Loaded
from axiscal.compensation.lookup import Lookup
from axiscal.compensation.offer import Draft
from axiscal.compensation.old_files import OldFile
from axiscal.compensation.sampling import axis_tables, cross_tables
from axiscal.compensation.table import CompensationTable, TableFile
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import InputError, TableError
from axiscal.machine.description import Machine
from axiscal.measurement.readers.csv_table import ANGLES, LENGTHS, TEXT, parse_table
from axiscal.numerics import Array
from axiscal.units import from_unit, to_unit

_UNITS = LENGTHS + ANGLES
_LAYOUT = {"axis": TEXT, "over": TEXT, "position": _UNITS, "forward": _UNITS, "reverse": _UNITS, "std": _UNITS}
_MOST = 2000
"""Rows of an axis; four an interval are rarely more than a hundred."""
_HOLDS = "the deviation of every axis over its own position and of linear axes over the others, in both directions."
_LEFT = "errors that depend on two axes at once, and the orientation of the tool."
_STEP = 0.5e-4  # of the deviations' unit, by their four decimals


def write(table: CompensationTable) -> str:
    """Return the text of the table."""
    fine = table.fine_unit
    cross = table.over != table.axis
    header = f"axis,{'over,' if cross else ''}position_{table.unit},forward_{fine},reverse_{fine},std_{fine}\n"
    name = f"{table.axis},{table.over}" if cross else table.axis
    columns = [np.round(to_unit(table.positions, table.unit), 7) + 0.0]
    columns += [np.round(to_unit(values, fine), 4) + 0.0 for values in (table.forward, table.reverse, table.std)]
    return header + "".join("{},{:.7f},{:.4f},{:.4f},{:.4f}\n".format(name, *row) for row in zip(*columns, strict=True))


def parse(text: str, file: str = "table.csv") -> CompensationTable:
    """Return the table of a text; raises ReadingError or TableError."""
    source = parse_table(text, file).allow(_LAYOUT)
    axis = source.one_of("axis", "axis")
    names = {row.text(axis) for row in source.rows}
    if len(names) > 1:
        raise TableError(f"the file holds the axes {', '.join(sorted(names))}", "write one file for each axis", file)
    stems = ("position", "forward", "reverse", "std")
    found = [source.one_of(stem, f"{stem}_mm") for stem in stems]
    overs = [column for column in source.columns if column.stem == "over"]
    over = {row.text(column) for column in overs for row in source.rows}
    if len(over) > 1:
        raise TableError("the file holds several tables", "write one file for each", file)
    if not over and len({column.dimension for column in found}) > 1:
        raise TableError("the columns mix lengths and angles", "a table of one axis holds one kind", file, source.line)
    columns = [np.array([row.quantity(column) for row in source.rows]) for column in found]
    positions, forward, reverse, std = columns
    rotary = found[1].dimension == "angle"
    return CompensationTable(names.pop(), rotary, positions, forward, reverse, std, over.pop() if over else "")


def offer(table: CompensationTable) -> TableFile:
    """Return the file, read back and compared with the table; raises TableError when it does not hold it."""
    text, resolution = write(table), float(from_unit(2 * _STEP, table.fine_unit))
    try:
        back = parse(text)
    except InputError as fault:
        raise TableError(f"the table of {table.axis} does not fit a CSV file: {fault.what}", fault.remedy) from None
    residual = max(
        _largest(table.deviation(table.positions, side) - back.deviation(table.positions, side)) for side in (1, -1)
    )
    if not residual <= resolution:
        what = f"the CSV table of {table.axis} differs by {table.shown(residual)}"
        raise TableError(what, "set the points further apart, or check the units of the readings")
    notes = (
        "The columns hold the deviation, actual minus nominal, of the tool relative to the workpiece: subtract it.",
        f"The column std_{table.fine_unit} is the standard deviation of the value as it stands, counted from where the "
        "table is zero. The shape of the curve is known better, as said below.",
    )
    return TableFile(f"{_stem(table)}.csv", text, notes, resolution, residual)


def load(files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
    """Return what somebody did who took the deviations of these tables away; raises ReadingError, TableError."""
    lookups = []
    for file in files:
        table = parse(file.text, file.name)
        for side, values in ((1, table.forward), (-1, table.reverse)):
            lookups.append(Lookup(table.axis, table.over, table.positions, -values, side))
    return Loaded(tuple(lookups))


def make(estimate: Estimate, options: ExportOptions) -> Draft:
    """Return one file for each axis, and for each axis over another; raises TableError."""
    own = axis_tables(estimate, options.spacing, _MOST)
    new = (*own, *cross_tables(estimate, options.spacing, _MOST))
    tables = options.old.under_tables(new, estimate.machine, _MOST)
    offers = [offer(table) for table in tables]
    held = table_control(estimate.machine, [parse(file.text, file.name) for file in offers])
    resolution: dict[str, float] = {}
    for table, file in zip(tables, offers, strict=True):
        resolution[table.axis] = resolution.get(table.axis, 0.0) + file.resolution
    notes = tuple(dict.fromkeys(note for file in offers for note in file.notes))
    turning = [axis.name for axis in estimate.machine.axes if axis.cyclic]
    notes += (f"Tables of {', '.join(turning)} hold one turn and repeat after it.",) if turning else ()
    files = {file.name: file.text for file in offers}
    return Draft(files, held, table_control(estimate.machine, tables), resolution, tables, _HOLDS, _LEFT, notes, True)


def _stem(table: CompensationTable) -> str:
    return table.axis if table.over == table.axis else f"{table.axis}_over_{table.over}"


def _largest(values: Array) -> float:
    return float(np.max(np.abs(values)))
