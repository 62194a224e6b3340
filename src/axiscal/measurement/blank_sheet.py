"""Places as a file of readings to fill in, and readings as such a file: what `estimate` reads."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.machine.axis import Axis
from axiscal.measurement.csv_cells import csv_text
from axiscal.measurement.place import Places
from axiscal.measurement.place_texts import approach_text
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.units import to_unit


def blank_sheet(setups: Sequence[Setup], axes: Sequence[Axis], places: Places, values: Sequence[str]) -> str:
    """Return the text of the file.  values : names of the columns to fill in, such as value_um"""
    rows = [[*_head(axes), *values]]
    columns = (places.setups.tolist(), places.poses.tolist(), places.approaches.tolist())
    for setup, pose, approach in zip(*columns, strict=True):
        rows.append([*_at(axes, setups[setup].name, pose, approach), *([""] * len(values))])
    return csv_text(rows)


def filled_sheet(axes: Sequence[Axis], readings: Sequence[Reading]) -> str:
    """Return the text of the file of readings that have three values each, to a picometre.

    Where a reading has a standard deviation of its own, the file has a column for it, empty for the others.
    """
    own = any(reading.std is not None for reading in readings)
    rows = [[*_head(axes), *(f"value_{c}_um" for c in "xyz"), *(["std_um"] if own else [])]]
    for reading in readings:
        numbers = [*reading.values, *([reading.std] if own else [])]
        texts = ("" if each is None else f"{to_unit(each, 'um'):.6f}" for each in numbers)
        rows.append([*_at(axes, reading.setup, reading.pose, reading.approach), *texts])
    return csv_text(rows)


def _head(axes: Sequence[Axis]) -> list[str]:
    return ["setup", *(f"{axis.name}_{axis.unit}" for axis in axes), "approach"]


def _at(axes: Sequence[Axis], setup: str, pose: Sequence[float], approach: Sequence[float]) -> list[str]:
    at = (f"{to_unit(value, axis.unit):.6f}" for value, axis in zip(pose, axes, strict=True))
    return [setup, *at, approach_text(axes, approach)]
