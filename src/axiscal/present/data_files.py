"""All readings as a CSV file, for spreadsheets and where the report lists the first ones alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from hashlib import sha256
from typing import NamedTuple

from axiscal.answers.digits import coordinate, number
from axiscal.language.spoken import said
from axiscal.measurement.readers.csv_readings import FOUND
from axiscal.measurement.readers.csv_table import csv_text
from axiscal.present.sentences import axis_unit, standardised
from axiscal.present.summary import HistoryRow, Summary

LISTED = 1000
"""Twenty pages; a matter of taste: nobody reads more on paper, and 20,000 take a minute and gigabytes to set."""

READINGS = "readings.csv"
"""Its name."""


def readings_csv(summary: Summary) -> bytes:
    """Return the file of all readings, the same in every language; raises SummaryError for a figure not finite."""
    return csv_text(_readings(summary)).encode("utf-8", "replace")


def _readings(summary: Summary) -> Iterator[Sequence[str]]:
    """Yield the lines; what `axiscal data estimate` reads, and what was found beside it."""
    rows = [row for row in summary.history if row.position is not None]
    axes = list(dict.fromkeys(axis for row in rows for axis in row.position or {}))
    values = list(dict.fromkeys(column for row in rows for column in row.columns))
    stds = list(dict.fromkeys(f"std_{row.unit}" for row in rows if row.std is not None))
    clock = ["time"] if all(row.time is not None for row in rows) else []
    names = ["reading", "setup", *(f"{axis}_{axis_unit(axis)}" for axis in axes), "approach", *values, *stds, *clock]
    yield [*names, *FOUND]
    for row in rows:
        cells = {"reading": str(row.reading), "setup": row.setup or "", "approach": row.approach}
        cells |= {f"{axis}_{axis_unit(axis)}": _place((row.position or {}).get(axis)) for axis in axes}
        cells |= zip(row.columns, map(_figure, row.values), strict=True)
        cells |= {f"std_{row.unit}": _figure(row.std), "time": f"{_figure(row.time)} s"}
        found = [*map(_figure, (row.innovation, standardised(row))), "no" if row.rejected else "yes"]
        yield [*(cells.get(name, "") for name in names), *found, *map(_figure, (row.rms_um, row.minutes))]


def _place(value: float | None) -> str:
    return "" if value is None else f"{coordinate(value, 'a position in a CSV file'):.12g}"


def _figure(value: float | None) -> str:
    return "" if value is None else f"{number(value, 'a figure of a CSV file'):.6g}"


class ReadingsListed(NamedTuple):
    """rows : that are listed; words : where the others are, empty where there are none."""

    rows: Sequence[HistoryRow]
    words: str


def listed(summary: Summary) -> ReadingsListed:
    """Return the readings that are listed; raises SummaryError for a figure that is not finite."""
    rows = [row for row in summary.history if row.position]
    if len(rows) <= LISTED:
        return ReadingsListed(rows, "")
    words = said(
        "The first {count} of {whole} readings are listed here. All of them stand in {file} of the results, whose "
        "SHA-256 is {hash}.",
        count=LISTED,
        whole=len(rows),
        file=f"data/{READINGS}",
        hash=sha256(readings_csv(summary)).hexdigest(),
    )
    return ReadingsListed(rows[:LISTED], words)
