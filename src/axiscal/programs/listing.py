"""The readings of a program as tables: where and when each is taken, and the form for their values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from axiscal.machine.axis import Axis
from axiscal.measurement.readers.csv_table import csv_text
from axiscal.measurement.reading import approach_text, columns_of
from axiscal.measurement.setup import Setup


@dataclass(frozen=True, slots=True)
class Listed:
    """A reading as the program has it: coordinates as written there, mm or deg.

    number : in the plan; seconds : from the start at the first reading until the axes stand, stops not counted
    """

    number: int
    seconds: float
    setup: Setup
    axes: tuple[Axis, ...]
    coordinates: tuple[str, ...]
    approach: tuple[int, ...]

    @property
    def sides(self) -> str:
        """The approach as readings files write it: "X+ Y-"."""
        return approach_text(self.axes, self.approach)


def listing(readings: Sequence[Listed]) -> str:
    """Return the list that goes with a program: number, time, set-up, every coordinate, approach."""
    header = ["reading", "time_s", "setup", *_axis_columns(readings[0].axes), "approach"]
    rows = [[str(r.number), f"{r.seconds:.1f}", r.setup.name, *r.coordinates, r.sides] for r in readings]
    return csv_text([header, *rows])


def form(readings: Sequence[Listed]) -> str:
    """Return readings.csv, the last columns to be filled in for `axiscal data estimate`; parked axes stay empty."""
    values = columns_of([reading.setup for reading in readings])
    header = ["reading", "setup", *_axis_columns(readings[0].axes), "approach", *values]
    rows = [header]
    for each in readings:
        moving = {each.axes[k].name for k in each.setup.moves}
        at = [text if axis.name in moving else "" for axis, text in zip(each.axes, each.coordinates, strict=True)]
        sides = " ".join(side for side in each.sides.split() if side[:-1] in moving)
        rows.append([str(each.number), each.setup.name, *at, sides, *[""] * len(values)])
    return csv_text(rows)


def _axis_columns(axes: Sequence[Axis]) -> list[str]:
    return [f"{axis.name}_{axis.unit}" for axis in axes]
