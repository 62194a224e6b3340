"""Axis columns `X_mm … C_deg` and the column `approach`, as readings and poses share them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from axiscal.machine.names import AXIS_NAME
from axiscal.measurement.readers.csv_table import ANGLES, LENGTHS, TEXT, CsvTable, Row, read_table

_APPROACH = re.compile(f"({AXIS_NAME})([+-])")


def axis_names(table: CsvTable) -> tuple[str, ...]:
    """Return the axes that have a column, in the order of the header."""
    return tuple(dict.fromkeys(column.stem for column in table.columns if re.fullmatch(AXIS_NAME, column.stem)))


def axis_layout(table: CsvTable) -> dict[str, tuple[str, ...]]:
    """Return which columns may name an axis, with the units of each: the usual axes and those of this table."""
    return {name: ANGLES if name[0] in "ABC" else LENGTHS for name in (*"XYZABC", *axis_names(table))}


def read_position(table: CsvTable, row: Row) -> dict[str, float]:
    """Return the coordinates (m or rad) that a line gives, by axis; an empty cell gives none.  Raises ReadingError."""
    position = {}
    for name in axis_names(table):
        column = row.only_filled(table.all_of(name))
        if column is not None:
            position[name] = row.quantity(column)
    return position


def read_approach(table: CsvTable, row: Row) -> dict[str, int]:
    """Return the direction of the last motion (+1, -1) by axis from `X+ Y-` or `X+;Y-`; raises ReadingError."""
    columns = table.all_of("approach")
    approach: dict[str, int] = {}
    for word in re.split(r"[\s;]+", row.text(columns[0]).strip(" ;")) if columns else []:
        found = _APPROACH.fullmatch(word)
        if word and (found is None or found[1] in approach):
            remedy = "write each axis once with its direction, as in 'X+' or 'X+ Y-', or leave it empty"
            raise row.fail("approach {text!r} cannot be read", remedy, text=row.text(columns[0]))
        if found:
            approach[found[1]] = 1 if found[2] == "+" else -1
    return approach


@dataclass(frozen=True, slots=True)
class RawPose:
    """One pose as written: coordinate (m or rad) by axis, direction of approach (+1, -1) by axis, line of the file."""

    position: Mapping[str, float]
    approach: Mapping[str, int]
    line: int


def read_poses(path: str | Path) -> tuple[RawPose, ...]:
    """Read poses in the order of the file, each with a coordinate in every axis column; raises ReadingError."""
    table = read_table(path)
    axes = axis_names(table)
    table.allow({"approach": TEXT} | axis_layout(table))
    if not axes:
        raise table.fail("no column names an axis", "name the axes as in 'X_mm' or 'C_deg'")
    return tuple(_pose(table, row, len(axes)) for row in table.rows)


def _pose(table: CsvTable, row: Row, axes: int) -> RawPose:
    position = read_position(table, row)
    if len(position) < axes:
        raise row.fail("the pose has an empty coordinate", "write a coordinate for every axis of the header")
    return RawPose(position, read_approach(table, row), row.line)
