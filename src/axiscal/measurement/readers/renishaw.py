"""Renishaw `.rtl`: a positioning test as laser software exports it, in sections `NAME::`.

Targets wrap over lines, indices count from 1, odd runs go up and even runs down unless the flags say that all go up.
Deviations are read as micrometres and targets as millimetres, for the file does not say. Angles differ from program to
program, so a rotary axis is refused where the axis is known.

Rows of an ISO 230-2 test: `target_mm,direction,run,deviation_um`, or `target_deg` and `deviation_arcsec`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from axiscal.measurement.readers.csv_table import ANGLES, LENGTHS, TEXT, Column, CsvTable, Row, TextFile
from axiscal.units import from_unit

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


_ONE_WAY = "1"
_SHORTENED = "export it again from the laser software; the file seems to be cut or edited"


def is_rtl(file: TextFile) -> bool:
    """Return whether the file begins like a `.rtl` file."""
    return next((line.strip() for line in file.lines if line.strip()), "") == "HEADER::"


def rtl_positioning(file: TextFile) -> PositioningRows:
    """Return the readings of a `.rtl` file; raises ReadingError."""
    sections = dict(_sections(file))
    targets, one_way = _targets(file, sections)
    rows: dict[tuple[int, int], PositioningRow] = {}
    for line, text in _deviations(file, sections):
        run, index, row = _row(file, line, text, targets, one_way)
        if (run, index) in rows:
            what = "run {run} has target {index} already, in line {earlier}"
            raise file.fail(what, "keep one of the two", line, run=run, index=index, earlier=rows[run, index].line)
        rows[run, index] = row
    if not rows:
        raise file.fail("there are no deviations", _SHORTENED)
    return PositioningRows(file.name, False, tuple(rows.values()))


def _sections(file: TextFile) -> Iterator[tuple[str, list[tuple[int, str]]]]:
    """Yield the lines of each section with their numbers; empty lines are left out."""
    name, lines = "", list[tuple[int, str]]()
    for number, line in enumerate(file.lines, 1):
        text = line.strip()
        if text.endswith("::"):
            yield name, lines
            name, lines = text[:-2].strip().upper(), []
        elif text:
            lines.append((number, text))
    yield name, lines


def _targets(file: TextFile, sections: dict[str, list[tuple[int, str]]]) -> tuple[list[float], bool]:
    """Return the targets in m, and whether all runs go up."""
    lines = sections.get("TARGET DATA")
    if lines is None:
        raise file.fail("there is no section TARGET DATA::", _SHORTENED)
    stated, targets, one_way, inside = None, list[float](), False, False
    for number, text in lines:
        key, colon, rest = text.partition(":")
        if colon:
            inside = key.strip().lower() == "targets"
            if key.strip().lower() == "target-count":
                stated = (number, rest.strip())
            if key.strip().lower() == "flags":
                one_way = rest.split()[1:2] == [_ONE_WAY]
            text = rest
        if inside:
            targets += [from_unit(value, "mm") for value in file.numbers(text.split(), "target", number)]
    if not targets:
        raise file.fail("there are no targets", _SHORTENED, lines[0][0] if lines else None)
    if stated is not None and stated[1] != str(len(targets)):
        what = "{stated} targets are announced, and there are {count}"
        raise file.fail(what, _SHORTENED, stated[0], stated=stated[1], count=len(targets))
    if len(set(targets)) < len(targets):
        raise file.fail("a target is named twice", "name each once", lines[0][0])
    return targets, one_way


def _deviations(file: TextFile, sections: dict[str, list[tuple[int, str]]]) -> list[tuple[int, str]]:
    lines = sections.get("DEVIATIONS")
    if lines is None:
        raise file.fail("there is no section DEVIATIONS::", _SHORTENED)
    return [(number, text) for number, text in lines if not text.lower().startswith("run target data")]


def _row(file: TextFile, line: int, text: str, targets: list[float], one_way: bool) -> tuple[int, int, PositioningRow]:
    words = text.split()
    if len(words) != 3 or not (words[0].isdecimal() and words[1].isdecimal()):
        raise file.fail("{text!r} is not run, target and deviation", _SHORTENED, line, text=text[:40])
    run, index = int(words[0]), int(words[1])
    if run < 1 or not 1 <= index <= len(targets):
        what = "target {index} of run {run} is not there: targets go from 1 to {count}"
        raise file.fail(what, _SHORTENED, line, index=index, run=run, count=len(targets))
    up = one_way or run % 2 == 1
    deviation = from_unit(file.number(words[2], "deviation", line), "um")
    number = run if one_way else (run + 1) // 2
    return run, index, PositioningRow(targets[index - 1], 1 if up else -1, number, deviation, line)
