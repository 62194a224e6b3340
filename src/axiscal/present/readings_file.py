"""All readings of a campaign as a CSV file, for spreadsheets and where the report lists the first ones alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from axiscal.campaign.campaign import Campaign
from axiscal.measurement.readers.csv_readings import FOUND
from axiscal.measurement.readers.csv_table import csv_text
from axiscal.measurement.reading import units_of, value_columns
from axiscal.present.answer import number
from axiscal.present.result import HistoryRow
from axiscal.units import to_unit

READINGS = "readings.csv"
"""Its name."""


def readings_csv(campaign: Campaign, history: Sequence[HistoryRow]) -> bytes:
    """Return the file of all readings, the same in every language; raises SummaryError for a figure not finite."""
    return csv_text(_lines(campaign, history)).encode("utf-8", "replace")


def _lines(campaign: Campaign, history: Sequence[HistoryRow]) -> Iterator[Sequence[str]]:
    """Yield the lines; what `axiscal data estimate` reads, and what was found beside it."""
    described, readings = campaign.description, campaign.state.readings
    setups = [described.setup(reading.setup) for reading in readings]
    values = list(dict.fromkeys(column for setup in setups for column in value_columns(setup)))
    units = [units_of(setup)[0] for setup in setups]
    stds = list(
        dict.fromkeys(f"std_{u}" for u, reading in zip(units, readings, strict=True) if reading.std is not None)
    )
    clock = ["time"] if all(reading.time is not None for reading in readings) else []
    drawn = ["check"] if any(reading.check for reading in readings) else []
    axes = described.machine.axes if readings else ()
    columns = {axis.name: f"{axis.name}{'_radius' * axis.diameters}_{axis.unit}" for axis in axes}
    names = ["reading", "setup", *columns.values(), "approach", *values, *stds, *clock, *drawn]
    yield [*names, *FOUND]
    for row, reading, setup, unit in zip(history[1:], readings, setups, units, strict=True):
        cells = {"reading": str(row.reading), "setup": reading.setup, "approach": row.approach}
        cells |= {columns[axis]: f"{each:.12g}" for axis, each in (row.position or {}).items()}
        cells |= zip(value_columns(setup), map(_figure, (row.value, *row.others)), strict=True)
        cells |= {f"std_{unit}": "" if reading.std is None else _figure(to_unit(reading.std, unit))}
        cells |= {"time": f"{_figure(reading.time)} s", "check": "yes" * reading.check}
        found = [*map(_figure, (row.innovation, row.surprise)), "no" if row.rejected else "yes"]
        yield [*(cells.get(name, "") for name in names), *found, *map(_figure, (row.rms_um, row.minutes))]


def _figure(value: float | None) -> str:
    return "" if value is None else f"{number(value, 'a figure of a CSV file'):.6g}"
