"""Rows of an ISO 230-2 test: `target_mm,direction,run,deviation_um`, or `target_deg` and `deviation_arcsec`."""

from __future__ import annotations

import re
from dataclasses import dataclass

from axiscal.measurement.readers.csv_table import ANGLES, LENGTHS, TEXT, Column, CsvTable, Row

STEMS = frozenset({"target", "direction", "run", "deviation"})
_LAYOUT = {"target": LENGTHS + ANGLES, "direction": TEXT, "run": TEXT, "deviation": LENGTHS + ANGLES}


@dataclass(frozen=True, slots=True)
class PositioningRow:
    """One reading: target (m, rad), direction +1 or -1, run, deviation actual minus target (m, rad), line."""

    target: float
    direction: int
    run: int
    deviation: float
    line: int


@dataclass(frozen=True, slots=True)
class PositioningRows:
    """The readings of one axis, in the order of the file."""

    file: str
    rotary: bool
    rows: tuple[PositioningRow, ...]


def positioning_rows(table: CsvTable) -> PositioningRows:
    """Interpret a table as readings of one axis; raises ReadingError, also for a reading given twice."""
    target, direction, run, deviation = table.needed(_LAYOUT, "target_mm", "direction", "run", "deviation_um")
    rotary = _is_rotary(table, target, deviation)
    seen: dict[tuple[float, int, int], int] = {}
    rows = []
    for row in table.rows:
        key = (row.quantity(target), read_direction(row, direction), read_run(row, run))
        if key in seen:
            remedy = "give each reading its own run number"
            what = "target {target}, direction {direction}, run {run} was read in line {earlier} already"
            at = {"target": row.text(target), "direction": row.text(direction), "run": key[2]}
            raise row.fail(what, remedy, **at, earlier=seen[key])
        seen[key] = row.line
        rows.append(PositioningRow(*key, row.quantity(deviation), row.line))
    return PositioningRows(table.file, rotary, tuple(rows))


def _is_rotary(table: CsvTable, target: Column, deviation: Column) -> bool:
    kinds = {column.dimension for column in (target, deviation)}
    if len(kinds) > 1:
        what = "'{target}' and '{deviation}' mix a length and an angle"
        remedy = "use target_mm with deviation_um, or target_deg with deviation_arcsec"
        raise table.fail(what, remedy, target=target.name, deviation=deviation.name)
    return kinds == {"angle"}


def read_direction(row: Row, column: Column) -> int:
    """Return +1 or -1; raises ReadingError."""
    signs = {"+": 1, "-": -1}
    text = row.text(column)
    if text not in signs:
        remedy = "write + for the approach in the positive direction, - for the negative one"
        raise row.fail("direction {text!r} is not known", remedy, text=text)
    return signs[text]


def read_run(row: Row, column: Column) -> int:
    """Return the number of a run; raises ReadingError."""
    text = row.text(column)
    if not re.fullmatch(r"[0-9]{1,9}", text):
        raise row.fail("run {text!r} is not a whole number", "number the runs 1, 2, 3, ...", text=text)
    return int(text)
