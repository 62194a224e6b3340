"""A plain CSV table: `axis,position_mm,forward_um,reverse_um,std_um`, or `position_deg`, `forward_arcsec` ….

The columns hold the deviation, actual minus nominal, not the correction: whoever loads it elsewhere subtracts it.
"""

from __future__ import annotations

import numpy as np

from axiscal.compensation.table import CompensationTable, TableFile
from axiscal.exceptions import InputError, TableError
from axiscal.measurement.readers.table import ANGLES, LENGTHS, TEXT, parse_table
from axiscal.numerics import Array
from axiscal.units import from_unit, to_unit

_UNITS = LENGTHS + ANGLES
_LAYOUT = {"axis": TEXT, "position": _UNITS, "forward": _UNITS, "reverse": _UNITS, "std": _UNITS}
_STEP = 0.5e-4  # of the deviations' unit, by their four decimals


def write(table: CompensationTable) -> str:
    """Return the text of the table."""
    fine = table.fine_unit
    header = f"axis,position_{table.unit},forward_{fine},reverse_{fine},std_{fine}\n"
    columns = [to_unit(table.positions, table.unit)]
    columns += [to_unit(values, fine) for values in (table.forward, table.reverse, table.std)]
    return header + "".join(
        "{},{:.7f},{:.4f},{:.4f},{:.4f}\n".format(table.axis, *row) for row in zip(*columns, strict=True)
    )


def parse(text: str, file: str = "table.csv") -> CompensationTable:
    """Return the table of a text; raises ReadingError or TableError."""
    source = parse_table(text, file).allow(_LAYOUT)
    axis = source.one_of("axis", "axis")
    names = {row.text(axis) for row in source.rows}
    if len(names) > 1:
        raise TableError(f"the file holds the axes {', '.join(sorted(names))}", "write one file for each axis", file)
    stems = ("position", "forward", "reverse", "std")
    found = [source.one_of(stem, f"{stem}_mm") for stem in stems]
    if len({column.dimension for column in found}) > 1:
        raise TableError("the columns mix lengths and angles", "a table of one axis holds one kind", file, source.line)
    columns = [np.array([row.quantity(column) for row in source.rows]) for column in found]
    positions, forward, reverse, std = columns
    return CompensationTable(names.pop(), found[0].dimension == "angle", positions, forward, reverse, std)


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
    )
    return TableFile(f"{table.axis}.csv", text, notes, resolution, residual)


def _largest(values: Array) -> float:
    return float(np.max(np.abs(values)))
