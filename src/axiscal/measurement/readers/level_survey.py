"""A level survey as it is written down at the machine: stations, and what the level showed there and back.

    # level survey
    # base = 100 mm
    # division = 0.02 mm/m
    X_mm,forward_div,back_div
    50,12.0,12.5
    150,11.0,11.0
    50,12.5,

The first column names the axis along which the level is stepped; a station is where the middle of its base stands.
Readings are slopes (`um/m`, `mm/m`), angles (`arcsec`, `urad`, …) or divisions (`div`), whose value is then stated. A
station that comes again, as the first one does at the end, is one more reading. Without base the level rides on what
moves. `# setup = name` says which set-up it was where several could have been.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace

from axiscal.exceptions import UnitError
from axiscal.measurement.readers.csv_readings import Around, Found, RawReading, read_times
from axiscal.measurement.readers.csv_table import LENGTHS, SLOPES, TEXT, Column, CsvTable, Row, axis_names, table_of
from axiscal.measurement.readers.text_file import TextFile
from axiscal.units import parse_quantity

_MARK = "# level survey"
_KEYS = ("setup", "base", "division")
_KEY = re.compile(r"#\s*([A-Za-z]+)\s*=\s*(.*?)\s*")
_PASSES = ("forward", "back")


def is_survey(file: TextFile) -> bool:
    """Return whether the first line says that this is a survey."""
    return file.lines[0].strip().lower() == _MARK


@dataclass(frozen=True, slots=True)
class _Head:
    """What the lines before the table say.  base : m; division : rad"""

    setup: str = ""
    base: float | None = None
    division: float | None = None


def survey_readings(file: TextFile, around: Around) -> Found:
    """Return the readings, first those of the way there, then those of the way back; raises ReadingError."""
    head, table = _head(file), table_of(file)
    station, ways, clock = _columns(table, head)
    _refuse_unread(table, ways, clock)
    places = [row.quantity(station) for row in table.rows]
    upward = places[-1 if len(places) < 3 else len(places) // 2] >= places[0]  # the last may close the circle
    lines = list(zip(table.rows, places, read_times(table.rows, clock), strict=True))
    found, error = list[RawReading](), "" if head.setup else "slope"
    for way in ways:
        onward = way.stem == _PASSES[0]
        for row, place, time in lines if onward else reversed(lines):
            if row.text(way):
                at, towards = {station.stem: place}, {station.stem: 1 if upward == onward else -1}
                value = _angle(row, way, head)
                read = RawReading(head.setup, at, towards, value, None, "angle", row.line, error=error)
                found.append(replace(read, time=time, base=head.base))
    return Found(tuple(found))


def _head(file: TextFile) -> _Head:
    said: dict[str, str] = {}
    lines: dict[str, int] = {}
    for number, text in _remarks(file):
        found = _KEY.fullmatch(text)
        if found is None:
            continue
        key = found[1].lower()
        if key not in _KEYS or key in said:
            what = "{key!r} is said twice" if key in said else "{key!r} is not known"
            raise file.fail(what, "known are {known}; a remark goes without =", number, key=key, known=", ".join(_KEYS))
        said[key], lines[key] = found[2], number
    try:
        key = "base"
        base = parse_quantity(said[key], "length") if key in said else None
        key = "division"
        division = parse_quantity(said[key], "angle") if key in said else None
    except UnitError as fault:
        raise file.fail(fault.what, fault.remedy, lines[key]) from None
    for key, value, example in (("base", base, "100 mm"), ("division", division, "0.02 mm/m")):
        if value is not None and value <= 0:
            what, remedy = "{key} = {text} is not above zero", "write it as # {key} = {example}"
            raise file.fail(what, remedy, lines[key], key=key, text=said[key], example=example)
    return _Head(said.get("setup", ""), base, division)


def _remarks(file: TextFile) -> Iterator[tuple[int, str]]:
    """Yield the lines before the table that begin with #, after the first."""
    for number, line in enumerate(file.lines[1:], 2):
        text = line.strip()
        if text and not text.startswith("#"):
            return
        if text:
            yield number, text


def _columns(table: CsvTable, head: _Head) -> tuple[Column, list[Column], Column | None]:
    """Return the column of stations, those of readings, the way there first, and that of times."""
    station = next((column for column in table.columns if column.stem in axis_names(table)), None)
    places = {} if station is None else {station.stem: LENGTHS}  # a second one is not known
    table.allow({**places, **dict.fromkeys(_PASSES, SLOPES), "time": TEXT})
    ways = [column for stem in _PASSES for column in table.all_of(stem)]
    if station is None or not ways:
        what = "there is no column of readings, such as forward_um/m"
        what = "there is no column of stations, such as X_mm" if station is None else what
        raise table.fail(what, "name it in the header; found: {known}", known=table.header)
    if len({way.stem for way in ways}) < len(ways):
        raise table.fail("a way is named twice", "give one column forward, and one back")
    if head.division is None and any(way.unit == "div" for way in ways):
        raise table.fail("readings are in divisions, and the value of one is not said", "write # division = 0.02 mm/m")
    return station, ways, next(iter(table.all_of("time")), None)


def _angle(row: Row, way: Column, head: _Head) -> float:
    return row.number(way) * (head.division or 0.0) if way.unit == "div" else row.quantity(way)


def _refuse_unread(table: CsvTable, ways: list[Column], clock: Column | None) -> None:
    for row in table.rows:
        filled = sum(bool(row.text(way)) for way in ways)
        if not filled:
            raise row.fail("the station has no reading", "write what the level showed, or take out the line")
        if filled > 1 and clock is not None:
            what = "the line has two readings, and one time"
            raise row.fail(what, "write the way back in lines of its own where times are given")
