"""READINGS.csv: `[reading,]setup,X_mm,…,B_deg,approach,value_um[,std_um][,time]`, and what a reading is as written.

`value_x_um,value_y_um,value_z_um` for an instrument that reads three directions, along those of the workpiece, or
`found_x_mm,found_y_mm,found_z_mm`, where the machine's axes stood; `value_1_um` and so on for tracers that read at
once; `length_mm` for the length between two places, as it is.
Positions may be left out (a parked axis); `value_urad` or `value_arcsec` for angles.  No machine is known here: who
does know it checks the names of set-ups and axes, and whether a position lies within the travel.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal

from axiscal.document import meant, shown
from axiscal.exceptions import Faults, UnitError
from axiscal.language.spoken import counted, joined, later, put, said
from axiscal.measurement.readers.columns import ANGLES, LENGTHS, TEXT, TILTS, WORDS, Units, approach_of, sign_of, whole
from axiscal.measurement.readers.csv_table import EXAMPLE, Cell, CsvTable, Row, csv_text, table_of
from axiscal.measurement.readers.text_file import TextFile, read_text
from axiscal.measurement.reading import Place, Places, Reading, approach_text, columns_of
from axiscal.measurement.setup import FINEST, MOST, Setup
from axiscal.units import parse_quantity, to_unit
from axiscal_core.axes import Axis

_DAY = re.compile(r"\d{4}-?(\d{2}-?\d{2}|W\d{2}(-?\d)?)", re.ASCII)
_NO_YEAR = 1900
"""That of a time without a date, by Python."""
_SECONDS = re.compile(r"[_\[(]s[\])]?$")
_NO_TIME = later("{text!r} is no time, or before those above, or written unlike them")
_REMEDY = later("write it as 2026-11-20T14:05:30, 14:05:30 or 95 min, and the lines in the order of time")

_THREE = ("value_x", "value_y", "value_z")
_MET = ("found_x", "found_y", "found_z")
_STATIONS = tuple(f"value_{number}" for number in range(1, MOST + 1))
"""Columns of tracers that read at once."""
Form = Literal["", "stations", "found", "length"]
_FORMS: Mapping[tuple[str, ...], Form] = {
    ("value",): "", _THREE: "", ("length",): "length", _MET: "found", _STATIONS: "stations",
}  # fmt: skip
"""Columns, of which each line has those of one row, and what their numbers are."""
FOUND = ("less_expected", "surprise", "used", "rms_um", "minutes")
"""Columns that results add to their readings; a reading that was not used is left out."""
_LAYOUT = {
    **dict.fromkeys(("reading", "setup", "approach", "time", "check"), TEXT),
    **dict.fromkeys(("value", "std", *_THREE, *_STATIONS), LENGTHS + TILTS),
    **dict.fromkeys((*_MET, "length", "rms"), LENGTHS),
    **dict.fromkeys((name for name in FOUND if name != "rms_um"), TEXT),
}


Test = Literal["positioning", "angular", "straightness", "circle"]


@dataclass(frozen=True, slots=True)
class RawReading:
    """One reading as written, in SI units.

    setup : name of the set-up; "" of a test
    position : coordinate (m or rad) by axis; an axis left out is parked; {"": target} of a test, whose only moving axis
        is not named
    approach : +1 or -1 by axis, absent where the direction of approach is not known; {"": ±1} of the one that moves
    value : deviation, actual minus commanded, m or rad as `dimension` says
    std : standard deviation of the value, None if not said
    line : line of the file
    others : the values along y and z of an instrument that reads three directions, whose first is `value`, or those of
        the second station and on
    form : of the values, where they are no deviations of one: "stations" one from each, "found" the machine's X, Y, Z
        with the tool point where it found a ball, m, "length" that between the two places of its set-up
    test : of one axis, or of a circle, that the reading belongs to; None for none
    run : of a test; axis : that the file of a test names, "" where it names none
    check : its place was drawn at random
    number : under which a program has it, None if not said
    error : where a file names no set-up but the error that was read, such as "EXX"; "z" a height
    time : s after the first reading of the file; None where it does not say
    rounding : of the digits of each coordinate, half of the last one, m or rad, by axis; absent where not known
    beside : how far the probe of a printer stands beside its nozzle along x and y, m
    zero : X and Y where that printer has the zero of Z, m
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
    beside: tuple[float, float] | None = None
    zero: tuple[float, float] | None = None
    number: int | None = None
    form: Form = ""
    test: Test | None = None
    run: int = 0
    axis: str = ""
    check: bool = False
    rounding: Mapping[str, float] = field(default_factory=dict)

    @property
    def target_dimension(self) -> Literal["length", "angle"]:
        """What the target of a test is: that of a circle is an angle, and a length where an angle is read over it."""
        if self.test in ("angular", "straightness"):
            return "length"
        return "angle" if self.test == "circle" else self.dimension


@dataclass(frozen=True, slots=True)
class Around:
    """What a door knows beside a file.

    axes : of the machine; setups : of the campaign
    bare : lines of a table need no set-up
    ends : of X and Y, m, where a map lies if neither file nor set-up says it
    """

    axes: Sequence[Axis] = ()
    setups: Sequence[Setup] = ()
    bare: bool = False
    ends: tuple[tuple[float, float], tuple[float, float]] | None = None


ALONE = Around()
"""No machine and no set-up is known."""


@dataclass(frozen=True, slots=True)
class Found:
    """Readings of a file in its order.

    cells : of a map, with those that nobody probed; 0 of what is no map
    note : what the reader took for granted, "" for nothing; title : what such a file is called
    """

    readings: tuple[RawReading, ...]
    cells: int = 0
    note: str = ""
    file: str = ""
    title: str = ""

    def sentence(self, setups: Sequence[str] = ()) -> str:
        """Return what was recognised, a sentence.  setups : names of those that the readings are for"""
        count = len(self.readings)
        held = said("{count} of {cells} cells", count=count, cells=self.cells) if self.cells else ""
        parts = [said(self.title), held or counted("{count} reading", "{count} readings", count), self.note]
        if (zero := self.readings[0].zero) is not None:
            x, y = (float(to_unit(at, "mm")) for at in zero)
            parts.append(said("zero at X{x:g} Y{y:g}", x=x, y=y))
        if setups:
            parts.append(said("for set-up {names}", names=joined(list(dict.fromkeys(setups)))))
        return put("{file}: {parts}.", file=Path(self.file).name, parts=", ".join(filter(None, parts)))


def table_readings(file: TextFile, around: Around) -> Found:
    """Return the readings of a table with columns setup, X_mm, value_um and so on; raises ReadingError.

    The error names the header that this machine would have.
    """
    table = table_of(file, ",".join(heading(around.axes, columns_of(around.setups))) if around.axes else EXAMPLE)
    own = {each.name: _own_columns(each) if each.written else {} for each in around.setups}
    table.allow(_LAYOUT | {stem: units for each in own.values() for stem, units in each.items()} | table.axis_layout)
    if not around.bare:
        table.one_of("setup", "setup")
    if not any(table.all_of(first) for first, *_ in (*_FORMS, *filter(None, own.values()))):
        table.one_of("value", "value_um")
    table = replace(table, rows=tuple(row for row in table.rows if row.of("used").text != "no"))
    if not table.rows:
        raise table.fail("no reading of this file was used", "write yes below used in the lines that are to count")
    faults, readings = Faults(), list[RawReading]()
    for row in table.rows:
        with faults.noted():
            readings.append(_reading(table, row, around.bare, own))
    faults.refuse()
    beside = zip(readings, read_times(table), _numbers(table), table.rows, strict=True)
    return Found(tuple(replace(r, time=t, number=n, check=row.of("check").text == "yes") for r, t, n, row in beside))


def raw_pose(table: CsvTable, row: Row, *, alone: bool = False) -> RawReading:
    """Return where a reading of nothing yet is, without axes whose cells are empty; raises ReadingError.

    alone : the approach may be a direction such as `+`, of the axis ''
    """
    cells = {name: cell for name in table.axes if (cell := row.of(name)).text}
    text = row.of("approach").text
    approach = {"": sign} if alone and (sign := sign_of(text)) else approach_of(text)
    if approach is None:
        remedy = "write each axis once with its direction, as in 'X+' or 'X+ Y-', or leave it empty"
        raise row.fail("approach {text!r} cannot be read", remedy, text=text)
    position = {name: cell.quantity() for name, cell in cells.items()}
    rounding = {name: cell.rounding() for name, cell in cells.items()}
    return RawReading(row.of("setup").text, position, approach, 0.0, None, "length", row.line, rounding=rounding)


def read_poses(path: str | Path) -> tuple[RawReading, ...]:
    """Return where readings are to be, in the order of the file, each with a coordinate in every axis column.

    Raises ReadingError.
    """
    table = table_of(read_text(path))
    table.allow({"approach": TEXT} | table.axis_layout)
    if not table.axes:
        raise table.fail("no column names an axis", "name the axes as in 'X_mm' or 'C_deg'")
    poses = tuple(raw_pose(table, row) for row in table.rows)
    for row, pose in zip(table.rows, poses, strict=True):
        if len(pose.position) < len(table.axes):
            raise row.fail("the pose has an empty coordinate", "write a coordinate for every axis of the header")
    return poses


def _numbers(table: CsvTable) -> list[int | None]:
    """Return the numbers of the readings; raises ReadingError for one that is none, or that stands twice."""
    cells, lines = [row.of("reading") for row in table.rows], dict[int, int]()
    if not any(cell.text for cell in cells):
        return [None] * len(cells)
    remedy, faults = "write the number that the program gives it, 1 or more, in every line", Faults()
    for cell in cells:
        with faults.noted():
            what = "{text!r} is not the number of a reading"
            number = cell.meant(lambda text: whole(text) or None, what, remedy)
            if lines.setdefault(number, cell.line) != cell.line:
                what = "reading {number} stands in line {earlier} too"
                raise cell.fail(what, "leave one of them out", number=number, earlier=lines[number])
    faults.refuse()
    return list(lines)


def _own_columns(setup: Setup) -> dict[str, Units]:
    """Return the columns of an instrument whose class names them, each with its units."""
    each = zip(setup.names, setup.reads_each, strict=True)
    return {setup.column(name): LENGTHS if reads == "length" else ANGLES for name, reads in each}


def _reading(table: CsvTable, row: Row, bare: bool, instruments: Mapping[str, Mapping[str, Units]]) -> RawReading:
    """Return the reading of a line; raises ReadingError.  instruments : columns of those that name their own"""
    pose, first = raw_pose(table, row, alone=True), row.of(*(stems[0] for stems in _FORMS))
    own = instruments.get(pose.setup, {})
    stems = tuple(own) or next((each for each in _FORMS if first.text and each[0] == first.column.stem), ())
    if not stems:
        if pose.setup and any(instruments.values()) and pose.setup not in instruments:
            raise row.fail("there is no set-up {name}", meant(pose.setup, instruments), name=shown(pose.setup))
        raise row.fail("the line has no value", "write the deviation that was read, or take out the line")
    if not (pose.setup or bare):
        raise row.fail("the line has no set-up", "write the name of the set-up as the campaign has it")
    cells = [row.of(stem, units=own.get(stem, ())) for stem in stems]
    while stems is _STATIONS and not cells[-1].text:
        cells.pop()
    column = cells[0].column
    for stem, cell in zip(stems, cells, strict=False):
        if not cell.text or not (own or cell.column.dimension == column.dimension):
            raise row.fail("the line has no value {name}", "write all of its numbers, or take out the line", name=stem)
    value, *others = (cell.quantity() for cell in cells)
    if (stated := row.of("std")).text:
        if stated.column.dimension != column.dimension:
            names = {"column": stated.column.name, "value": column.name, "unit": column.unit}
            raise stated.fail("'{column}' does not fit '{value}'", "write it as 'std_{unit}'", **names)
        if stated.quantity() < FINEST:
            remedy = "a standard deviation is at least 0.1 nm or 0.1 nrad; leave it empty to take the set-up's noise"
            raise stated.fail("{column} is {text}", remedy, column=stated.column.name, text=stated.text)
    std, form = stated.quantity() if stated.text else None, "" if own else _FORMS.get(stems, "")
    return replace(pose, value=value, std=std, dimension=column.dimension, others=tuple(others), form=form)


def read_times(table: CsvTable) -> list[float | None]:
    """Return the seconds of each row after the first; None where there is no such column.

    Raises ReadingError for a cell that is empty or no time, and for a time before that of the line above.
    """
    at = [place for place, column in enumerate(table.columns) if column.stem == "time"]  # a date, and a time of day
    if not at:
        return [None] * len(table.rows)
    texts = (" ".join(filter(None, (row.texts[place] for place in at))) for row in table.rows)
    cells = [replace(row.cell(at[0]), text=text) for row, text in zip(table.rows, texts, strict=True)]
    times = [*map(_time, cells)]
    for cell, (kind, seconds), (_, last) in zip(cells, times, (times[0], *times), strict=False):
        if kind != times[0][0] or seconds < last:
            raise cell.fail(_NO_TIME, _REMEDY, text=cell.text)
    return [seconds - times[0][1] for _, seconds in times]


def _time(cell: Cell) -> tuple[str, float]:
    """Return how a time is written, and its seconds from wherever such times begin."""
    with suppress(ValueError):
        moment = datetime.fromisoformat(cell.text)
        if _DAY.fullmatch(cell.text):  # all readings of a day at once, and no drift between them
            raise cell.fail(_NO_TIME, _REMEDY, text=cell.text)
        kind = "date with zone" if moment.tzinfo else "date"
        return kind, (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()
    with suppress(UnitError):
        return "since", parse_quantity(cell.text + " s" * bool(_SECONDS.search(cell.column.name)), "time")
    for form in WORDS["times"]:
        with suppress(ValueError):
            moment = datetime.strptime(cell.text, form).replace(tzinfo=UTC)
            day = cell.text.split()[0] if form.startswith(("%d/", "%m/")) else "date"  # 1/2 and 2/2: a day or a month
            return ("clock" if moment.year == _NO_YEAR else day), moment.timestamp()
    raise cell.fail(_NO_TIME, _REMEDY, text=cell.text[:40])


def blank_sheet(setups: Sequence[Setup], axes: Sequence[Axis], places: Places) -> str:
    """Return the text of the file, with columns to fill in, such as value_um."""
    values = columns_of(setups[index] for index in places.setups)
    return _sheet(axes, values, [(each, [""] * len(values)) for each in places.listed(setups)])


def filled_sheet(axes: Sequence[Axis], readings: Sequence[Reading]) -> str:
    """Return the text of a file of readings that have one value each, or three, to a picometre.

    The file has a column for standard deviations if a reading states one; it is empty for the others.
    """
    own = any(reading.std is not None for reading in readings)
    named = [f"value_{c}_um" for c in "xyz"] if any(reading.others for reading in readings) else ["value_um"]
    numbers = [[*reading.values, *([reading.std] if own else [])] for reading in readings]
    texts = [["" if each is None else f"{to_unit(each, 'um'):.6f}" for each in every] for every in numbers]
    return _sheet(axes, [*named, *(["std_um"] if own else [])], zip(readings, texts, strict=True))


def heading(axes: Sequence[Axis], values: Sequence[str]) -> list[str]:
    """Return the columns of a file of readings, those of the values last."""
    return ["setup", *(axis.column for axis in axes), "approach", *values]


def _sheet(axes: Sequence[Axis], values: Sequence[str], lines: Iterable[tuple[Place | Reading, Sequence[str]]]) -> str:
    """Return a file of readings.  lines : where each is, and the texts of its values"""
    rows = [heading(axes, values)]
    for each, texts in lines:
        at = (f"{to_unit(value, axis.unit):.6f}" for value, axis in zip(each.pose, axes, strict=True))
        rows.append([each.setup, *at, approach_text(axes, each.approach), *texts])
    return csv_text(rows)
