"""Poses to predict at: `X_mm,…,C_deg[,approach]`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from axiscal.measurement.readers.axes import axis_layout, axis_names, read_approach, read_position
from axiscal.measurement.readers.csv_table import TEXT, CsvTable, Row, read_table


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
