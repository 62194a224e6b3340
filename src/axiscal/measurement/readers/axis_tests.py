"""Tests of one axis as tables, and circles: `target_mm,direction,run,deviation_um`, a column a run, or `angle_deg`.

Deviations in arcsec over targets in mm are an angular test. A table with a column a run has headers such as
`Pos;1+;1-;2+;2-`; it is in mm and um where it names no unit. Headers are English, German, French, Spanish or Italian.
A direction is + or -, forward or reverse, CCW or CW (counter-clockwise is positive).
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace

from axiscal.language.spoken import said
from axiscal.measurement.readers.csv_readings import Around, Found, RawReading, Test
from axiscal.measurement.readers.csv_table import (
    ANGLES,
    LENGTHS,
    TEXT,
    Column,
    CsvTable,
    Row,
    header_of,
    table_of,
)
from axiscal.measurement.readers.text_file import TextFile
from axiscal.units import said_quantity

_OF_TEST = {"target": LENGTHS + ANGLES, "direction": TEXT, "run": TEXT, "deviation": LENGTHS + ANGLES}
_OF_CIRCLE = {"angle": ANGLES, "direction": TEXT, "deviation": LENGTHS}
_CALLED = {
    "target": "target pos pos. position soll sollposition ziel zielposition cible consigne posición posicion posizione",
    "direction": "direction dir richtung sens dirección direccion direzione verso",
    "run": "run cycle lauf messlauf durchgang zyklus passage pasada ciclo passata",
    "deviation": "deviation dev error abweichung fehler écart ecart erreur desviación desviacion scostamento errore",
    "angle": "angle winkel ángulo angulo angolo",
}
_STEMS = {word: stem for stem, words in _CALLED.items() for word in words.split()}
_WAYS = {
    +1: "+ forward forwards fwd positive pos up ccw vor vorwärts vorwaerts hin aller avant adelante avanti",
    -1: "- reverse rev backward backwards back negative neg down cw rück zurück rückwärts rueckwaerts retour arrière "
    "atrás atras indietro",
}
"""Words of directions by their sign."""
_SIGNS = {word: sign for sign, words in _WAYS.items() for word in words.split()}
_PARTS = re.compile(r"\d{1,9}|[+-]|[^\W\d_]+")
_RUN = re.compile(r"[0-9]{1,9}")


def is_circle(file: TextFile) -> bool:
    """Return whether the columns are those of a circular test."""
    return {column.stem for column in _named(header_of(file))} >= _OF_CIRCLE.keys()


def is_long(file: TextFile) -> bool:
    """Return whether a column is one of an ISO 230-2 test, and none names a set-up."""
    stems = {column.stem for column in _named(header_of(file))}
    return bool(stems & _OF_TEST.keys()) and "setup" not in stems


def is_wide(file: TextFile) -> bool:
    """Return whether each column after the targets is one run in one direction."""
    first, *others = _named(header_of(file)) or (Column("", "", None),)
    return first.stem == "target" and bool(others) and all(_run_of(column) for column in others)


def circle(file: TextFile, around: Around) -> Found:
    """Return the readings of a circular test; raises ReadingError."""
    table = _renamed(file)
    angle, direction, deviation = table.needed(_OF_CIRCLE | {"setup": TEXT}, "angle_deg", "direction", "deviation_um")
    named = next(iter(table.all_of("setup")), None)
    read = (_read(row, angle, _direction(row, direction), 0, deviation, "circle") for row in table.rows)
    if named is not None:
        read = (replace(each, setup=row.text(named)) for each, row in zip(read, table.rows, strict=True))
    return Found(tuple(read))


def long_table(file: TextFile, around: Around) -> Found:
    """Return the readings of a table with a line for each; raises ReadingError, also for one that stands twice."""
    table = _renamed(file)
    target, direction, run, deviation = table.needed(_OF_TEST, "target_mm", "direction", "run", "deviation_um")
    kind = _kind(table, target, deviation)
    rows = ((row, _direction(row, direction), _run(row, run)) for row in table.rows)
    return Found(distinct(file, [_read(row, target, way, number, deviation, kind) for row, way, number in rows]))


def wide_table(file: TextFile, around: Around) -> Found:
    """Return the readings of a table with a column for each run, there and back; raises ReadingError."""
    table = _renamed(file)
    if file.unit:
        table.allow(dict.fromkeys((column.stem for column in table.columns), LENGTHS + ANGLES))
    target, *others = (
        replace(column, stated=column.stated or ("um" if number else "mm"))
        for number, column in enumerate(table.columns)
    )
    found, kinds = list[RawReading](), {_kind(table, target, column) for column in others}
    if len(kinds) > 1:
        raise table.fail("some runs are lengths, and some are angles", "give a file for each test")
    (kind,) = kinds
    for column in others:
        run, way = _run_of(column) or (0, 0)
        rows = [row for row in table.rows[::way] if row.text(column)]
        found += [_read(row, target, way, run, column, kind) for row in rows]
    silent = not (file.unit or target.unit or any(column.unit for column in others))
    return Found(distinct(file, found), note=said("in mm and um (it names no unit)") if silent else "")


def _kind(table: CsvTable, target: Column, deviation: Column) -> Test:
    """Return which test it is, by what targets and deviations are; raises ReadingError for lengths over angles."""
    if (target.dimension, deviation.dimension) == ("angle", "length"):
        what = "'{target}' and '{deviation}' mix a length and an angle"
        remedy = "use target_mm with deviation_um, or target_deg with deviation_arcsec"
        raise table.fail(what, remedy, target=target.name, deviation=deviation.name)
    return "positioning" if target.dimension == deviation.dimension else "angular"


def distinct(file: TextFile, readings: Iterable[RawReading]) -> tuple[RawReading, ...]:
    """Return readings of a test; raises ReadingError where one stands twice, or none is there."""
    seen = dict[tuple[float, int, int], RawReading]()
    for each in readings:
        key = (each.position[""], each.approach[""], each.run)
        if key in seen:
            what = "target {target}, direction {direction}, run {run} was read in line {earlier} already"
            target = said_quantity(key[0], "deg" if each.target_dimension == "angle" else "mm")
            at = {"target": target, "direction": "+" if key[1] > 0 else "-", "run": each.run}
            raise file.fail(what, "give each reading its own run number", each.line, earlier=seen[key].line, **at)
        seen[key] = each
    if not seen:
        raise file.fail("there are no deviations", "write those that were read, or export the file again")
    return tuple(seen.values())


def _named(columns: Iterable[Column]) -> tuple[Column, ...]:
    """Return the columns with the stems of a test, whatever the language of their headers."""
    return tuple(replace(column, stem=_STEMS.get(column.stem.lower(), column.stem)) for column in columns)


def _renamed(file: TextFile) -> CsvTable:
    table = table_of(file)
    return replace(table, columns=_named(table.columns))


def _run_of(column: Column) -> tuple[int, int] | None:
    """Return the run and the direction that a header such as `1+` or `Run 2 reverse` names, None for another."""
    words = _PARTS.findall(column.stem.lower().replace("\N{MINUS SIGN}", "-"))
    runs = [word for word in words if _RUN.fullmatch(word)]
    ways = [_SIGNS[word] for word in words if word in _SIGNS]
    others = [word for word in words if word not in _SIGNS and word not in runs and _STEMS.get(word) != "run"]
    return (int(runs[0]), ways[0]) if len(runs) == len(ways) == 1 and not others else None


def _direction(row: Row, column: Column) -> int:
    text = row.text(column)
    sign = _SIGNS.get(text.lower().replace("\N{MINUS SIGN}", "-"))
    if sign is None:
        remedy = "write + for the approach in the positive direction, - for the negative one"
        raise row.fail("direction {text!r} is not known", remedy, text=text[:40])
    return sign


def _run(row: Row, column: Column) -> int:
    text = row.text(column)
    if not _RUN.fullmatch(text):
        raise row.fail("run {text!r} is not a whole number", "number the runs 1, 2, 3, ...", text=text[:40])
    return int(text)


def _read(row: Row, target: Column, way: int, run: int, value: Column, test: Test) -> RawReading:
    at, read = row.quantity(target), row.quantity(value)
    return RawReading("", {"": at}, {"": way}, read, None, value.dimension, row.line, test=test, run=run)
