"""The column `time` of a table of readings: a date with a time, a time of day, or a time since the beginning."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import UTC, datetime

from axiscal.exceptions import UnitError
from axiscal.measurement.readers.csv_table import Column, Row
from axiscal.units import parse_quantity

_CLOCK = re.compile(r"([01]?\d|2[0-3]):([0-5]\d)(?::([0-5]\d(?:\.\d+)?))?", re.ASCII)
_DAY = re.compile(r"\d{4}-?(\d{2}-?\d{2}|W\d{2}(-?\d)?)", re.ASCII)
_REMEDY = "write it as 2026-11-20T14:05:30, 14:05:30 or 95 min, and the lines in the order of time"


def read_times(rows: Sequence[Row], column: Column | None) -> list[float | None]:
    """Return the seconds of each row after the first; None where there is no such column.

    Raises ReadingError for a cell that is empty or no time, and for a time before that of the line above.
    """
    if column is None:
        return [None] * len(rows)
    found: list[float | None] = []
    kinds = set[str]()
    first = last = None
    for row in rows:
        kind, seconds = _time(row, column)
        first, kinds = seconds if first is None else first, kinds | {kind}
        if len(kinds) > 1:
            raise row.fail(f"time {row.text(column)!r} is written unlike those above", _REMEDY)
        if last is not None and seconds < last:
            raise row.fail(f"time {row.text(column)!r} is before that of the line above", _REMEDY)
        last = seconds
        found.append(seconds - first)
    return found


def _time(row: Row, column: Column) -> tuple[str, float]:
    """Return how a time is written, and its seconds from wherever such times begin."""
    text = row.text(column)
    clock = _CLOCK.fullmatch(text)
    if clock is not None:
        return "clock", 3600.0 * int(clock[1]) + 60.0 * int(clock[2]) + float(clock[3] or 0.0)
    try:
        return "since", parse_quantity(text, "time")
    except UnitError:
        pass
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        raise row.fail(f"time {text[:40]!r} is no time", _REMEDY) from None
    if _DAY.fullmatch(text):  # all readings of a day at once, and no drift between them
        raise row.fail(f"time {text!r} is a day without a time of day", _REMEDY)
    if moment.tzinfo is None:
        return "date", moment.replace(tzinfo=UTC).timestamp()
    return "date with zone", moment.timestamp()
