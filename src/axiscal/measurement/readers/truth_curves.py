"""Curves of known errors: `error,position_mm,value_um`; `position_deg` for rotary axes, `value_urad` for angles.

One file may hold both kinds: then exactly one position column and one value column are filled in each line.  A location
error is one line, its position empty.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from axiscal.exceptions import DescriptionError
from axiscal.machine.names import ErrorName, parse_error_name
from axiscal.measurement.readers.csv_table import ANGLES, LENGTHS, TEXT, Column, CsvTable, Row, read_table
from axiscal.numerics import Array

_LAYOUT = {"error": TEXT, "position": LENGTHS + ANGLES, "value": LENGTHS + ANGLES}


class TruthCurve(NamedTuple):
    """One error: positions (n,) m or rad, increasing; values (n,) m or rad.  A constant has one position, 0."""

    positions: Array
    values: Array


def read_truth(path: str | Path) -> dict[str, TruthCurve]:
    """Read the curves of a file by canonical error name, in the order of the file; raises ReadingError."""
    table = read_table(path).allow(_LAYOUT)
    error = table.one_of("error", "error")
    for stem, example in (("position", "position_mm"), ("value", "value_um")):
        if not table.all_of(stem):
            table.one_of(stem, example)
    curves: dict[str, list[tuple[float, float]]] = {}
    for row in table.rows:
        name = _name(row, error)
        points = curves.setdefault(name.canonical, [])
        points.append(_point(table, row, name, points))
    return {name: TruthCurve(*np.array(points).T) for name, points in curves.items()}


def _name(row: Row, column: Column) -> ErrorName:
    try:
        return parse_error_name(row.text(column))
    except DescriptionError as fault:
        raise row.fail(fault.what, fault.remedy) from None


def _point(table: CsvTable, row: Row, name: ErrorName, before: list[tuple[float, float]]) -> tuple[float, float]:
    position, value = row.only_filled(table.all_of("position")), row.only_filled(table.all_of("value"))
    if value is None:
        remedy = "write the value of the error, or take out the line"
        raise row.fail("{name} has no value here", remedy, name=name.canonical)
    _fits(row, value, name, "angle" if name.angular else "length")
    if position is None:
        return _constant(row, name, before), row.quantity(value)
    _fits(row, position, name, "angle" if name.axis[0] in "ABC" else "length")
    at = row.quantity(position)
    if before and at <= before[-1][0]:
        what = "position {text} of {name} does not lie beyond the one before it"
        remedy = "sort the positions of each error and give each once"
        raise row.fail(what, remedy, text=row.text(position), name=name.canonical)
    return at, row.quantity(value)


def _constant(row: Row, name: ErrorName, before: list[tuple[float, float]]) -> float:
    """Return the position of a constant, which is given only once."""
    if name.kind == "motion" or before:
        remedy = "write the position; only a constant, given in one line, goes without"
        raise row.fail("{name} has no position here", remedy, name=name.canonical)
    return 0.0


def _fits(row: Row, column: Column, name: ErrorName, dimension: str) -> None:
    if column.dimension != dimension:
        remedy = "the {stem} of {name} is an angle: deg, urad or arcsec"
        remedy = "the {stem} of {name} is a length: mm or um" if dimension == "length" else remedy
        what = "'{column}' does not fit {name}"
        raise row.fail(what, remedy, column=column.name, name=name.canonical, stem=column.stem)
