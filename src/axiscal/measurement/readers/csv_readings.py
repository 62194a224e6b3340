"""READINGS.csv: `[reading,]setup,X_mm,…,B_deg,approach,value_um[,std_um][,time]`, or the columns of an ISO 230-2 test.

`value_x_um,value_y_um,value_z_um` for an instrument that reads three directions, `value_1_um` and so on for tracers
that read at once.
Positions may be left out (a parked axis); `value_urad` or `value_arcsec` for angles.  No machine is known here: who
does know it checks the names of set-ups and axes, and whether a position lies within the travel.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from axiscal.document import shown
from axiscal.exceptions import Faults
from axiscal.measurement.csv_cells import unshielded
from axiscal.measurement.instruments.distance import MOST
from axiscal.measurement.readers.axes import axis_layout, read_approach, read_position
from axiscal.measurement.readers.csv_table import ANGLES, LENGTHS, TEXT, Column, CsvTable, Row, read_table
from axiscal.measurement.readers.positioning import STEMS, PositioningRows, positioning_rows
from axiscal.measurement.readers.times import read_times
from axiscal.measurement.setup import FINEST

_THREE = ("value_x", "value_y", "value_z")
_STATIONS = tuple(f"value_{number}" for number in range(1, MOST + 1))
"""Columns of tracers that read at once."""
_HIGHEST = 10**6
"""Of a number of a reading: whoever writes more has slipped."""
_LAYOUT = {
    "reading": TEXT,
    "setup": TEXT,
    "approach": TEXT,
    "time": TEXT,
    **dict.fromkeys(("value", "std", *_THREE, *_STATIONS), LENGTHS + ANGLES),
}


@dataclass(frozen=True, slots=True)
class RawReading:
    """One reading as written, in SI units.

    setup : name of the set-up; "" in an ISO 230-2 file
    position : coordinate (m or rad) by axis; an axis left out is parked; {"": target} in an ISO 230-2 file, whose only
        moving axis is not named
    approach : +1 or -1 by axis, absent where the direction of approach is not known; {"": ±1} in an ISO 230-2 file
    value : deviation, actual minus commanded, m or rad as `dimension` says
    std : standard deviation of the value, None if not said
    line : line of the file
    others : the values along y and z of an instrument that reads three directions, whose first is `value`, or those of
        the second station and on
    by_station : the values are one from each station
    number : under which a program has it, None if not said
    error : where a file names no set-up but the error that was read, such as "EXX"; "z" a height, "slope" a level's
    time : s after the first reading of the file; None where it does not say
    base : how far apart the feet of a level stood, m
    """

    setup: str
    position: Mapping[str, float]
    approach: Mapping[str, int]
    value: float
    std: float | None
    dimension: Literal["length", "angle"]
    line: int
    others: tuple[float, ...] = ()
    error: str = ""
    time: float | None = None
    base: float | None = None
    number: int | None = None
    by_station: bool = False


def read_readings(path: str | Path) -> tuple[RawReading, ...]:
    """Read the readings of a file of either kind, in its order; raises ReadingError."""
    table = read_table(path)
    if {column.stem for column in table.columns} >= STEMS:
        return of_positioning(positioning_rows(table))
    table.allow(_LAYOUT | axis_layout(table))
    setup = table.one_of("setup", "setup")
    if not any(table.all_of(first) for first in ("value", _THREE[0], _STATIONS[0])):
        table.one_of("value", "value_um")
    faults, readings = Faults(), list[RawReading]()
    for row in table.rows:
        with faults.noted():
            readings.append(_reading(table, row, setup))
    faults.refuse()
    times = read_times(table.rows, next(iter(table.all_of("time")), None))
    numbers = _numbers(table)
    return tuple(replace(reading, time=t, number=n) for reading, t, n in zip(readings, times, numbers, strict=True))


def _numbers(table: CsvTable) -> list[int | None]:
    """Return the numbers of the readings; raises ReadingError for one that is none, or that stands twice."""
    column, lines = next(iter(table.all_of("reading")), None), dict[int, int]()
    if column is None or not any(row.text(column) for row in table.rows):
        return [None] * len(table.rows)
    remedy, faults = "write the number that the program gives it, 1 or more, in every line", Faults()
    for row in table.rows:
        text = row.text(column)
        with faults.noted():
            if not (text.isascii() and text.isdigit() and 0 < int(text[:9]) <= _HIGHEST and len(text) < 9):
                raise row.fail(f"{shown(text)} is not the number of a reading", remedy)
            if int(text) in lines:
                raise row.fail(f"reading {int(text)} stands in line {lines[int(text)]} too", "leave one of them out")
            lines[int(text)] = row.line
    faults.refuse()
    return list(lines)


def of_positioning(test: PositioningRows) -> tuple[RawReading, ...]:
    """Return the readings of an ISO 230-2 test, whose axis is not named."""
    dimension: Literal["length", "angle"] = "angle" if test.rotary else "length"
    return tuple(
        RawReading("", {"": row.target}, {"": row.direction}, row.deviation, None, dimension, row.line)
        for row in test.rows
    )


def _reading(table: CsvTable, row: Row, setup: Column) -> RawReading:
    three = [row.only_filled(table.all_of(stem)) for stem in _THREE]
    stations = [row.only_filled(table.all_of(stem)) for stem in _STATIONS]
    column = row.only_filled([*table.all_of("value"), *table.all_of("value_x"), *table.all_of("value_1")])
    if column is None:
        raise row.fail("the line has no value", "write the deviation that was read, or take out the line")
    if not row.text(setup):
        raise row.fail("the line has no set-up", "write the name of the set-up as the campaign has it")
    value, std = row.quantity(column), _std(table, row, column)
    position, approach = read_position(table, row), read_approach(table, row)
    others, by_station = _others(row, column, three[1:]) if column is three[0] else (), column is stations[0]
    others = _of_stations(row, column, stations[1:]) if by_station else others
    name = unshielded(row.text(setup))
    raw = RawReading(name, position, approach, value, std, column.dimension, row.line, others)
    return replace(raw, by_station=by_station)


def _of_stations(row: Row, first: Column, columns: Sequence[Column | None]) -> tuple[float, ...]:
    """Return the values of the second station and on, as many as are filled without a gap."""
    filled = [column for column in columns if column is not None]
    if columns[: len(filled)] != filled or any(column.dimension != first.dimension for column in filled):
        raise row.fail("a station between others has no value", "fill value_1, value_2 and so on, one for each station")
    return tuple(row.quantity(column) for column in filled)


def _others(row: Row, first: Column, columns: Sequence[Column | None]) -> tuple[float, ...]:
    """Return the values along y and z beside the one along x."""
    filled = [column for column in columns if column is not None]
    if len(filled) < len(columns) or any(column.dimension != first.dimension for column in filled):
        raise row.fail("the line has a value along x, but not along y and z too", "fill value_x, value_y and value_z")
    return tuple(row.quantity(column) for column in filled)


def _std(table: CsvTable, row: Row, value: Column) -> float | None:
    column = row.only_filled(table.all_of("std"))
    if column is None:
        return None
    if column.dimension != value.dimension:
        raise row.fail(f"'{column.name}' does not fit '{value.name}'", f"write it as 'std_{value.unit}'")
    std = row.quantity(column)
    if std < FINEST:
        remedy = "a standard deviation is at least 0.1 nm or 0.1 nrad; leave it empty to take the set-up's noise"
        raise row.fail(f"{column.name} is {row.text(column)}", remedy)
    return std
