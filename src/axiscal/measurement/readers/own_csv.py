"""Our own exchange file, first line `# axiscal-csv 1`:

    run_id,axis,error,direction,target,value,unit,u_std,t_c,time

UTF-8, decimal point. `direction` is + or − or empty; targets are in mm, on rotary axes in deg; `unit` is that of value
and u_std. `t_c` (material temperature) and `time` are kept for people.
"""

from __future__ import annotations

from dataclasses import dataclass

from axiscal.exceptions import DescriptionError, UnitError
from axiscal.machine.names import parse_error_name
from axiscal.measurement.readers.csv_table import TEXT, CsvTable, Row, parse_table
from axiscal.measurement.readers.text import TextFile
from axiscal.measurement.setup import FINEST
from axiscal.units import dimension_of, from_unit

MARK = "# axiscal-csv 1"
_COLUMNS = ("run_id", "axis", "error", "direction", "target", "value", "unit", "u_std", "t_c", "time")
_NEEDED = ("axis", "error", "target", "value", "unit")
_SIGNS = {"+": 1, "-": -1, "−": -1, "": 0}
"""What the format writes for the two directions, and for none."""


@dataclass(frozen=True, slots=True)
class OwnReading:
    """One line: the axis that moved and its target (m or rad), the error that was read, and its value.

    direction : +1, -1, or 0 where it is not said; angular : the value is an angle
    """

    axis: str
    target: float
    error: str
    direction: int
    value: float
    std: float | None
    angular: bool
    line: int


def is_own(file: TextFile) -> bool:
    """Return whether the file says that it is one of ours."""
    return file.lines[0].strip().lower() == MARK


def own_readings(file: TextFile) -> tuple[OwnReading, ...]:
    """Return the readings; raises ReadingError."""
    table = parse_table("\n".join(file.lines), file.name).allow(dict.fromkeys(_COLUMNS, TEXT))
    for name in _NEEDED:
        table.one_of(name, name)
    return tuple(_reading(file, table, row) for row in table.rows)


def _reading(file: TextFile, table: CsvTable, row: Row) -> OwnReading:
    cells = {column.name: row.text(column) for column in table.columns}
    try:
        error = parse_error_name(cells["error"])
        unit = cells["unit"].replace("µ", "u").replace("μ", "u")
        dimension = dimension_of(unit)
    except (DescriptionError, UnitError) as fault:
        raise row.fail(fault.what, fault.remedy) from None
    if dimension != ("angle" if error.angular else "length"):
        raise row.fail(f"{error.canonical} is not given in {unit}", "give lengths in um, angles in urad or arcsec")
    if error.axis != cells["axis"]:
        raise row.fail(f"{error.canonical} is not an error of axis {cells['axis']!r}", "name the axis that moved")
    if cells.get("direction", "") not in _SIGNS:
        raise row.fail(f"direction {cells['direction']!r} is not known", "write +, - or nothing")
    target = file.number(cells["target"], "target", row.line)
    std = cells.get("u_std", "")
    spread = from_unit(file.number(std, "u_std", row.line), unit) if std else None
    if spread is not None and spread < FINEST:
        remedy = "a standard deviation is at least 0.1 nm or 0.1 nrad; leave it empty otherwise"
        raise row.fail(f"u_std is {std}", remedy)
    return OwnReading(
        axis=error.axis,
        target=from_unit(target, "deg" if error.axis[0] in "ABC" else "mm"),
        error=error.canonical,
        direction=_SIGNS[cells.get("direction", "")],
        value=from_unit(file.number(cells["value"], "value", row.line), unit),
        std=spread,
        angular=error.angular,
        line=row.line,
    )
