"""The same figures as CSV files, for spreadsheets: readings, curves, constants, volume, budget."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from hashlib import sha256
from typing import NamedTuple

from axiscal.answers.digits import coordinate, number
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.language.spoken import said
from axiscal.measurement.readers.csv_table import csv_text
from axiscal.present.sentences import axis_unit, standardised
from axiscal.present.summary import CurveSummary, HistoryRow, Summary

LISTED = 1000
"""Twenty pages; a matter of taste: nobody reads more on paper, and 20,000 take a minute and gigabytes to set."""

Rows = Iterator[Sequence[str]]
READINGS = "readings.csv"
"""The file that has every reading."""


def data_files(summary: Summary) -> dict[str, bytes]:
    """Return what each file holds by its name; raises SummaryError for a figure that is not finite."""
    return {
        READINGS: readings_csv(summary),
        "curves.csv": _file(_curves([*summary.curves, *summary.reversals])),
        "constants.csv": _file(_constants(summary)),
        "volume.csv": _file(_volume(summary)),
        "budget.csv": _file(_budget(summary)),
    }


def readings_csv(summary: Summary) -> bytes:
    """Return the file of all readings, the same in every language; raises SummaryError as `data_files`."""
    return _file(_readings(summary))


def _file(rows: Rows) -> bytes:
    return csv_text(rows).encode("utf-8", "replace")


def _readings(summary: Summary) -> Rows:
    axes = list(dict.fromkeys(axis for row in summary.history for axis in row.position or {}))
    names = [f"{axis}_{axis_unit(axis)}" for axis in axes]
    further = max((len(row.others) for row in summary.history), default=0)
    yield [
        "reading",
        "setup",
        *names,
        "approach",
        "value",
        "unit",
        "less_expected",
        "surprise",
        "used",
        "rms_um",
        "minutes",
        *(f"value_{2 + k}" for k in range(further)),
    ]
    for row in summary.history:
        if row.position is None:
            continue
        at = [_place(row.position.get(axis)) for axis in axes]
        value, left, z = row.value_um, row.innovation, standardised(row)
        said = [row.approach, _figure(value), row.unit, _figure(left), _figure(z), "no" if row.rejected else "yes"]
        others = [*map(_figure, row.others), *[""] * (further - len(row.others))]
        yield [str(row.reading), row.setup or "", *at, *said, _figure(row.rms_um), _figure(row.minutes), *others]


def _curves(curves: Sequence[CurveSummary]) -> Rows:
    yield ["error", "axis", "position", "position_unit", "mean", "half_width_95", "before_95", "unit"]
    for each in curves:
        for at, mean, std, prior in zip(each.position, each.mean, each.std, each.prior_std, strict=True):
            figures = [_figure(mean), _figure(BAND * std), _figure(BAND * prior)]
            yield [each.name, each.axis, _figure(at), each.position_unit, *figures, each.value_unit]


def _constants(summary: Summary) -> Rows:
    yield ["constant", "is", "mean", "half_width_95", "before_95", "unit"]
    for each in summary.constants:
        figures = [_figure(each.mean), _figure(BAND * each.std), _figure(BAND * each.prior_std)]
        yield [each.name, each.words, *figures, each.unit]


def _volume(summary: Summary) -> Rows:
    kinds = ("found", "left", "half_width_95")
    yield [*(f"{name}_mm" for name in "xyz"), *(f"{kind}_{name}_um" for kind in kinds for name in "xyz")]
    volume = summary.volume
    if volume is None:
        return
    for k, at in enumerate(volume.tcp_mm):
        left = volume.left_um[k] if volume.left_um else (None, None, None)
        yield [_figure(each) for each in (*at, *volume.found_um[k], *left, *volume.half_um[k])]


def _budget(summary: Summary) -> Rows:
    yield ["source", "rms_um", "share"]
    for row in summary.budget:
        yield [row.words, _figure(row.rms_um), _figure(row.share)]


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
