"""Tests of one axis as tables, and circles: `target_mm,direction,run,deviation_um`, a column a run, or `angle_deg`.

Deviations in arcsec over targets in mm are an angular test. `actual_mm` is where the axis stood, in place of the
deviation; `axis` names the axis of each line. A table with a column a run has headers such as `Pos;1+;1-;2+;2-`; it is
in mm and um where it names no unit and its values can be no mm. A direction is + or -, forward or reverse, CCW (+) or
CW. Where no column says it, targets are come to in the order of their lines.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Literal

from axiscal.language.spoken import later, said
from axiscal.machine.error_names import AXIS_NAME
from axiscal.measurement.readers.columns import LENGTHS, STEMS, TEXT, TILTS, Column, run_of, sign_of, unread, whole
from axiscal.measurement.readers.csv_readings import Around, Found, RawReading, Test, read_times
from axiscal.measurement.readers.csv_table import Cell, CsvTable, header_of, table_of
from axiscal.measurement.readers.text_file import TextFile
from axiscal.units import said_quantity

_BOTH = LENGTHS + TILTS
_READ = ("deviation", "actual")
"""Of a reading: how far off the axis stood, or where."""
_BESIDE = dict.fromkeys(("direction", "run", "setup", "axis", "time"), TEXT) | dict.fromkeys(_READ, _BOTH)
_RADII = later("these are radii, and no deviations"), later("take the radius off them")
_MIXED = (
    later("the columns mix lengths and angles"),
    later("give a file for each test, such as target_mm with deviation_um, or target_deg with deviation_arcsec"),
)
_UNITS = later("write Pos_mm and 1+_um in the header, or such")
_UNKNOWN = later("direction {text!r} is not known")
_NO_RUN, _NUMBERED = later("run {text!r} is not a whole number"), later("number the runs 1, 2, 3, ...")
_TOWARDS = later("write + for the approach in the positive direction, - for the negative one")
_TURN = re.compile(r"(?<![a-z])c?cw(?![a-z])", re.IGNORECASE)
_AXIS = "|".join(word for word, stem in STEMS.items() if stem == "axis")
_NAMED = re.compile(rf"\s*+(?:{_AXIS})[^\S\t]*+[:;,=\t]\s*+({AXIS_NAME})(?:[-\s]*+(?:{_AXIS}))?[\s;,]*+", re.IGNORECASE)
_STROKE = 5e-3
"""m, further than any ball bar reads."""
_ALIKE = 0.02
"""Share of a target: no axis is as far off at each."""
_UNIT_IN_WORDS = re.compile(r"\b(inch(es)?|in|thou|zoll|pouces?|mm|[uµμ]m|microns?)\b", re.IGNORECASE)


def test_of(file: TextFile) -> Literal["circle", "wide", "long"] | None:
    """Return which test the columns are of: wide has a column a run, long a line a reading; None of no test."""
    first, *others = header_of(file, _words(file)) or (Column("", "", None),)
    stems, turning = {column.stem for column in (first, *others)}, any(column.unit in TILTS for column in others)
    if first.stem == "angle" and any(run_of(column.stem) for column in others):
        return "wide" if turning else "circle"
    if first.stem == "target" and others and not stems & {"direction", "deviation", "actual", "setup"}:
        return "wide"
    if {"angle", "direction"} <= stems and not any(each.stem == "deviation" and each.unit in TILTS for each in others):
        return "circle"
    return "long" if stems & {"target", "direction", "run", *_READ} and "setup" not in stems else None


def axis_named(file: TextFile) -> str:
    """Return the axis that a line such as `Axis: X` names, or the column of targets; "" where none does."""
    found = filter(None, map(_NAMED.fullmatch, file.lines))
    return next((each[1].upper() for each in found), "") or _lettered(file)


def _lettered(file: TextFile) -> str:
    """Return the axis that the column of targets is called, "" where it is called otherwise."""
    stems = {column.stem for column in header_of(file, STEMS)}
    letters = [stem for stem in stems if re.fullmatch(AXIS_NAME, stem)]
    others = stems.difference(letters)
    test = others & {*_READ} or (others and all(map(run_of, others)))
    return letters[0] if len(letters) == 1 and test and not others & {"target", "angle"} else ""


def _words(file: TextFile) -> dict[str, str]:
    return STEMS | {_lettered(file).lower(): "target"}


def axis_test(file: TextFile, around: Around) -> Found:
    """Return the readings of a test, with a line or a column for each; raises ReadingError where one stands twice.

    The order of the lines numbers the runs where no column does.
    """
    table, test = table_of(file, words=_words(file)), test_of(file)
    told = [row.of("direction") for row in table.rows] if (sides := table.all_of("direction")) else []
    words = [*((cell, cell.text) for cell in told), *((table, column.name) for column in table.columns)]
    for where, text in words if test != "circle" else ():  # whose way round ISO 230-4 states
        if _TURN.search(text):
            seen = "which sign {text!r} has depends on the side that one looks from"
            raise where.fail(seen, _TOWARDS, text=text[:40])
    silent = any(column.stem == "angle" and not column.unit for column in table.columns)
    if silent and any(abs(row.of("angle").number()) > 2 * math.pi for row in table.rows):  # above a turn in rad
        table = table.with_columns(replace(c, stated="deg" if c.stem == "angle" else c.stated) for c in table.columns)
    if not sides and test != "long":
        return _in_columns(file, table)
    place = "angle" if table.all_of("angle") else "target"
    what = next((stem for stem in _READ if table.all_of(stem)), "deviation")
    table.allow({place: TILTS if place == "angle" else _BOTH} | _BESIDE)
    at = table.one_of(place, "angle_deg" if place == "angle" else "target_mm")
    read = table.one_of(what, f"{what}_um")
    if place == "angle" and table.all_of("actual"):
        raise table.fail(*_RADII)
    ways = [] if sides or place == "angle" else _by_order([row.of(place).quantity() for row in table.rows])
    note = said("angles in deg (it names no unit)") if silent else ""
    if ways:
        note = said("sides by the order of its targets (it names no direction)")
    else:
        table.one_of("direction", "direction")
        ways = [row.of("direction").meant(sign_of, _UNKNOWN, _TOWARDS) for row in table.rows]
    found = distinct(file, _lines(table, place, ways, read, _kind(table, at, read)))
    _refuse_positions(table, found)
    return _with_gaps(found, len(table.rows), note)


def _with_gaps(found: tuple[RawReading, ...], cells: int, note: str) -> Found:
    """Return readings with how many could stand there, where some are missing."""
    return Found(found, cells if len(found) < cells else 0, note)


def _by_order(targets: Sequence[float]) -> list[int]:
    """Return from which side each target is come to, by the target before it; the first by the one after it.

    A target that stands twice has another side the second time, where the axis turns; none are returned where it does
    not turn there, or never moves.
    """
    steps = [(after > before) - (after < before) for before, after in pairwise(targets)]
    ways = list[int]()
    for number, step in enumerate(steps):
        before, after = ways[-1:] or [0], next((each for each in steps[number:] if each), 0)
        if not step and before[0] * after != -1:
            return []
        ways.append(step or after)
    return [*ways[:1], *ways]


def _lines(table: CsvTable, place: str, ways: Sequence[int], read: Column, kind: Test) -> Iterator[RawReading]:
    """Yield the reading of each line that has one, with what stands beside it; raises ReadingError.

    ways : of each line, +1 or −1; read : the column of deviations, or of where the axis stood
    """
    times = Counter[tuple[str, float, int]]()
    for row, seconds, way in zip(table.rows, read_times(table), ways, strict=True):
        moved, target, value = row.of("axis").text, row.of(place), row.of(read.stem)
        times[at := (moved, target.quantity(), way)] += 1
        run = times[at]
        if table.all_of("run"):
            run = row.of("run").meant(whole, _NO_RUN, _NUMBERED)
        if unread(value.text):
            continue
        found = _read(target, way, run, value, kind)
        if (stood := row.of("actual")).text:
            off = stood.quantity() - target.quantity()
            slack = stood.rounding() + min(stood.rounding(), target.rounding()) + value.rounding()
            if abs(off - found.value) > slack and value != stood:
                what = "{column} {text} is not where the axis stood less its target"
                raise row.fail(what, "give one of both, actual less target", column=read.name, text=value.text)
            found = replace(found, value=off if value == stood else found.value)
        yield replace(found, setup=row.of("setup").text, axis=moved, time=seconds)


def _in_columns(file: TextFile, table: CsvTable) -> Found:
    """Return the readings of a table with a column for each run, there and back; raises ReadingError."""
    if file.unit:
        table.allow(dict.fromkeys((column.stem for column in table.columns), _BOTH))
    silent = not (file.unit or any(column.unit or column.stem == "angle" for column in table.columns))
    if silent and any(map(_UNIT_IN_WORDS.search, file.lines[: table.line - 1])):
        raise table.fail("a title names a unit, and no column does", _UNITS)
    of_length = table.columns[0].stem == "target"
    usual = ["mm" if of_length else "", "um" if of_length and table.columns[0].unit in (None, "mm") else ""]
    table = table.with_columns(replace(c, stated=c.stated or usual[k > 0]) for k, c in enumerate(table.columns))
    target, *others = table.columns
    kinds, found = {_kind(table, target, column) for column in others}, list[RawReading]()
    if len(kinds) > 1:
        raise table.fail(*_MIXED)
    for at, column in enumerate(others, 1):
        if (run := run_of(column.stem)) is None:
            what = "column '{column}' names no run with its direction"
            raise table.fail(what, "write it as in 1+ or 1-, or take it out", column=column.name[:40])
        cells = ((row.cell(0), row.cell(at)) for row in table.rows[:: run[1]])
        found += [_read(place, run[1], run[0], cell, *kinds) for place, cell in cells if not unread(cell.text)]
    unsaid = not file.unit and any(column.unit is None for column in others)
    _refuse_positions(table, found, 1e3 if unsaid else 1.0)
    targets, values = [each.position[""] for each in found], [1e3 * each.value for each in found]
    if unsaid and found and max(values) - min(values) <= _ALIKE * (max(targets) - min(targets)):
        raise table.fail("the deviations name no unit, and may be in mm as well as in um", _UNITS)
    note = said("in mm and um (it names no unit)") if silent else said("deviations in um (it names no unit)")
    return _with_gaps(distinct(file, found), len(table.rows) * len(others), note if unsaid else "")


def _refuse_positions(table: CsvTable, found: Sequence[RawReading], scale: float = 1.0) -> None:
    """Raise ReadingError where what was read is as large as the target each time, or further than a ball bar reads.

    scale : of a deviation whose unit nobody has named, to that of the targets
    """
    away = [(each.position[""], each.value * scale) for each in found if each.position[""]]
    if found[:1] and found[0].test == "circle" and min(abs(each.value) for each in found) > _STROKE:
        raise table.fail(*_RADII)
    if away and found[0].test == "positioning" and all(abs(abs(v) - abs(t)) < _ALIKE * abs(t) for t, v in away):
        what = "the deviations are as large as the targets each time"
        raise table.fail(what, "give deviations, or name a column of positions actual_mm")


def _kind(table: CsvTable, target: Column, deviation: Column) -> Test:
    """Return which test it is, by what targets and deviations are; raises ReadingError for lengths over angles."""
    if target.stem == "angle" and deviation.dimension == "length":
        return "circle"
    if (target.dimension, deviation.dimension) == ("angle", "length"):
        raise table.fail(*_MIXED)
    return "positioning" if target.dimension == deviation.dimension else "angular"


def distinct(file: TextFile, readings: Iterable[RawReading]) -> tuple[RawReading, ...]:
    """Return readings of a test; raises ReadingError where one stands twice, or none is there."""
    seen = dict[tuple[str, float, int, int], RawReading]()
    for each in readings:
        first = seen.setdefault((each.axis, each.position[""], each.approach[""], each.run), each)
        if first is not each:
            what = "target {target}, direction {direction}, run {run} was read in line {earlier} already"
            target = said_quantity(each.position[""], "deg" if each.target_dimension == "angle" else "mm")
            at = {"target": target, "direction": "+" if each.approach[""] > 0 else "-", "run": each.run}
            raise file.fail(what, "give each reading its own run number", each.line, earlier=first.line, **at)
    if not seen:
        raise file.fail("there are no deviations", "write those that were read, or export the file again")
    return tuple(seen.values())


def _read(target: Cell, way: int, run: int, value: Cell, test: Test) -> RawReading:
    of = (target.quantity(), {"": way}, value.quantity(), None, value.column.dimension, value.line)
    return RawReading("", {"": of[0]}, *of[1:], test=test, run=run, rounding={"": target.rounding()})
