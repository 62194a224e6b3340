"""A level survey as it is written down at the machine: stations, and what the level showed there and back.

The first column names the axis along which the level is stepped; a station is where the middle of its base stands.
Readings are slopes (`um/m`, `mm/m`), angles (`arcsec`, `urad`, …) or divisions (`div`), whose value is then stated. A
station that comes again, as the first one does at the end, is one more reading. Without base the level rides on what
moves. `# setup = name` says which set-up it was where several could have been.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

from axiscal.exceptions import InputError
from axiscal.measurement.readers.columns import LENGTHS, OF_READINGS, SIGNS, SLOPES, TEXT
from axiscal.measurement.readers.csv_readings import Around, Found, RawReading, read_times
from axiscal.measurement.readers.csv_table import CsvTable, table_of
from axiscal.measurement.readers.text_file import TextFile
from axiscal.units import within

_KEYS = ("setup", "base", "division")
_LEAST = 1e-9
"""m or rad: no base and no division is as small."""
_KEY = re.compile(r"#\s*([A-Za-z]+)\s*([=:]?)\s*(.*)")
_PASSES = ("forward", "back")
_WORDS = OF_READINGS | {word: _PASSES[sign < 0] for word, sign in SIGNS.items()}
"""Passes by what they may be called."""


TITLE = re.compile(r"(?i)[ \t;,]*# level survey\b[^=]*")
"""First line of a survey."""
_Head = dict[str, Any]
"""What the lines before the table say: set-up, base, m, division, rad."""


def survey_readings(file: TextFile, around: Around) -> Found:
    """Return the readings, first those of the way there, then those of the way back; raises ReadingError."""
    head, table = _head(file), table_of(file, words=_WORDS)
    station, ways = _columns(table, head)
    places = [row.of(station).quantity() for row in table.rows]
    upward = places[-1 if len(places) < 3 else len(places) // 2] >= places[0]  # the last may close the circle
    times, found, setup = read_times(table), list[RawReading](), head.get("setup", "")
    for row, time in zip(table.rows, times, strict=True):
        filled = sum(bool(row.of(way).text) for way in ways)
        if not filled:
            raise row.fail("the station has no reading", "write what the level showed, or take out the line")
        if filled > 1 and time is not None:
            what = "the line has two readings, and one time"
            raise row.fail(what, "write the way back in lines of its own where times are given")
    lines = list(zip(table.rows, places, times, strict=True))
    for way in ways:
        onward = way == _PASSES[0]
        for row, place, time in lines if onward else reversed(lines):
            if (cell := row.of(way)).text:
                towards = {station: 1 if upward == onward else -1}
                value = cell.number() * head["division"] if cell.column.unit == "div" else cell.quantity()
                read = RawReading(setup, {station: place}, towards, value, None, "angle", row.line, error="slope")
                found.append(replace(read, time=time, base=head.get("base")))
    return Found(tuple(found))


def _head(file: TextFile) -> _Head:
    """Return what the lines that begin with # say; raises ReadingError."""
    said = _Head()
    for number, line in enumerate(file.lines[1:], 2):
        if (text := line.strip(" \t;,")) and not text.startswith("#"):
            break
        if (found := _KEY.fullmatch(text)) is None or (found[2] != "=" and found[1].lower() not in _KEYS):
            continue
        key, value = found[1].lower(), found[3].rstrip()
        if key not in _KEYS or key in said:
            what = "{key!r} is said twice" if key in said else "{key!r} is not known"
            raise file.fail(what, "known are {known}; a remark goes without =", number, key=key, known=", ".join(_KEYS))
        try:
            said[key] = value if key == "setup" else _size(value, key)
        except InputError as fault:
            raise file.fail(fault.what, fault.remedy, number) from None
    return said


def _size(text: str, key: str) -> float:
    """Return a base, m, or a division, rad, which may be a rise over a length: 0.0005 in/10 in; raises InputError."""
    rise, _, run = text.partition("/")
    if run.strip()[:1].isdigit():
        return within(rise, "length", _LEAST) / within(run, "length", _LEAST)
    return within(text, "length" if key == "base" else "angle", _LEAST)


def _columns(table: CsvTable, head: _Head) -> tuple[str, list[str]]:
    """Return what the column of stations holds, and those of readings, the way there first."""
    station = next(iter(table.axes), "X")  # a second one is not known
    table.allow({station: LENGTHS, **dict.fromkeys(_PASSES, SLOPES), "time": TEXT})
    ways = [way for way in _PASSES if table.all_of(way)] or [_PASSES[0]]
    columns = [table.one_of(station, f"{station}_mm"), *(table.one_of(way, f"{way}_um/m") for way in ways)]
    if "division" not in head and any(column.unit == "div" for column in columns):
        raise table.fail("readings are in divisions, and the value of one is not said", "write # division = 0.02 mm/m")
    return station, ways
