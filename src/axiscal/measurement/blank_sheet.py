"""Places as a file of readings to fill in: what `estimate` reads, without the values."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.machine.axis import Axis
from axiscal.measurement.csv_cells import csv_text
from axiscal.measurement.place import Places
from axiscal.measurement.place_texts import approach_text
from axiscal.measurement.setup import Setup
from axiscal.units import to_unit


def blank_sheet(setups: Sequence[Setup], axes: Sequence[Axis], places: Places, values: Sequence[str]) -> str:
    """Return the text of the file.  values : names of the columns to fill in, such as value_um"""
    rows = [["setup", *(f"{axis.name}_{axis.unit}" for axis in axes), "approach", *values]]
    columns = (places.setups.tolist(), places.poses.tolist(), places.approaches.tolist())
    for setup, pose, approach in zip(*columns, strict=True):
        at = (f"{to_unit(value, axis.unit):.6f}" for value, axis in zip(pose, axes, strict=True))
        rows.append([setups[setup].name, *at, approach_text(axes, approach), *([""] * len(values))])
    return csv_text(rows)
