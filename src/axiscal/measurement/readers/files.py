"""Any file of readings, recognised by its first lines: READINGS.csv, ISO 230-2 tests, `.rtl`, exchange files, bed maps,
level surveys.
"""

from __future__ import annotations

from pathlib import Path

from axiscal.measurement.readers import bed_map, level_survey, own_csv, renishaw
from axiscal.measurement.readers.csv_readings import RawReading, of_positioning, read_readings
from axiscal.measurement.readers.positioning import PositioningRows, read_positioning
from axiscal.measurement.readers.text import TextFile, read_text


def read_any(path: str | Path) -> tuple[RawReading, ...]:
    """Read the readings of a file of any kind, in its order; raises ReadingError."""
    file = read_text(path)
    if renishaw.is_rtl(file):
        return of_positioning(renishaw.rtl_positioning(file))
    if own_csv.is_own(file):
        return tuple(_own(reading) for reading in own_csv.own_readings(file))
    if level_survey.is_survey(file):
        return tuple(_levelled(reading) for reading in level_survey.survey_readings(file))
    if bed_map.is_height_map(file):
        return tuple(_node(node) for node in bed_map.height_map(file))
    if bed_map.is_mesh(file):
        return tuple(_node(node) for node in bed_map.mesh(file))
    return read_readings(path)


def read_any_positioning(path: str | Path) -> PositioningRows:
    """Read an ISO 230-2 test, a table or a `.rtl` file; raises ReadingError."""
    file: TextFile = read_text(path)
    return renishaw.rtl_positioning(file) if renishaw.is_rtl(file) else read_positioning(path)


def _levelled(reading: level_survey.LevelReading) -> RawReading:
    at, towards = {reading.axis: reading.station}, {reading.axis: reading.direction}
    error = "" if reading.setup else "slope"
    return RawReading(
        reading.setup,
        at,
        towards,
        reading.value,
        None,
        "angle",
        reading.line,
        error=error,
        time=reading.time,
        base=reading.base,
    )


def _own(reading: own_csv.OwnReading) -> RawReading:
    approach = {reading.axis: reading.direction} if reading.direction else {}
    place, value = {reading.axis: reading.target}, (reading.value, reading.std)
    if reading.angular:
        return RawReading("", place, approach, *value, "angle", reading.line, error=reading.error)
    return RawReading("", place, approach, *value, "length", reading.line, error=reading.error)


def _node(node: bed_map.Node) -> RawReading:
    """Return the reading of a node: where the bed is high the tool is too low over it, by as much."""
    return RawReading("", {"X": node.x, "Y": node.y}, {}, -node.height, None, "length", node.line, error="z")
