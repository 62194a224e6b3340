"""The protocol of a source: it answers questions for one reading at a time, or says why it cannot.

`sim[:SEED]` and `truth:FILE`: a virtual machine, with errors drawn from the prior or given as curves.

`csv:FILE`: readings that exist already, given in the order in which they are asked for.
"""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from axiscal.exceptions import SourceError
from axiscal.machine import Axis
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.readers.csv_table import Column, Row, read_table
from axiscal.measurement.reading import approach_text, reading_unit, shown_approach, shown_pose
from axiscal.measurement.setup import Setup
from axiscal.units import dimension_of, to_unit

if TYPE_CHECKING:
    from axiscal.measurement.simulation import VirtualMachine


class SimulatedSource:
    """A virtual machine as a source.

    The noise of a reading depends on its number only, so that a run that is resumed is the same run.
    """

    def __init__(self, machine: VirtualMachine, seed: int) -> None:
        self._machine, self._seed = machine, seed

    def read(self, request: Request) -> Answer:
        """Return the simulated reading."""
        import numpy as np

        rng = np.random.default_rng((self._seed, request.reading))
        value, *others = self._machine.read_all(request.setup, request.pose, request.approach, rng, request.seconds)
        return Answer(value, others=tuple(others))

    def close(self) -> None:
        """Nothing is held."""


@dataclass(frozen=True, slots=True)
class Request:
    """A reading that is wanted.

    reading : its number from 1; axes : of the machine, in chain order
    pose : (n_axes,) m or rad; approach : (n_axes,) +1, -1, or 0 where it does not matter
    seconds : of machine time since the campaign began, where somebody counts them
    """

    reading: int
    setup: Setup
    axes: tuple[Axis, ...]
    pose: tuple[float, ...]
    approach: tuple[int, ...]
    seconds: float = 0.0

    def message(self) -> dict[str, object]:
        """Return the request as the document that is sent to an `exec:` command: positions in mm and deg."""
        return {
            "reading": self.reading,
            "setup": self.setup.name,
            "instrument": self.setup.instrument,
            "direction": list(self.setup.direction),
            "position": shown_pose(self.axes, self.pose),
            "approach": shown_approach(self.axes, self.approach),
            "units": {axis.name: axis.unit for axis in self.axes},
        }


@dataclass(frozen=True, slots=True)
class Answer:
    """The reading: value in m or rad; its standard deviation likewise, or None for the set-up's noise.

    others : the values along y and z where an instrument reads three directions
    live : it was taken just now, so that the clock tells when; else the seconds of the plan do
    """

    value: float
    std: float | None = None
    others: tuple[float, ...] = ()
    live: bool = field(default=False, compare=False)


@dataclass(frozen=True, slots=True)
class Skip:
    """The reading cannot be taken, and why."""

    reason: str


class Source(Protocol):
    """Something that takes readings. `read` raises SourceError when it cannot go on at all."""

    def read(self, request: Request) -> Answer | Skip:
        """Return the reading asked for."""

    def close(self) -> None:
        """Let go of whatever it holds; may be called twice."""


def at_the_terminal(text: str) -> str:
    """Ask on a line of its own and return what is typed; raises SourceError where nobody can answer."""
    sys.stderr.write("\n" * sys.stderr.isatty() + text)  # the line before shows how far the run is
    sys.stderr.flush()
    line = sys.stdin.readline()
    if not line:
        what = "the machine waits for a person, and nobody is there to answer"
        raise SourceError(what, "Give the command in a terminal, beside the machine")
    return line


_SAME = {False: 1e-6, True: math.radians(1e-5)}
"""How far a row may stand from the position asked for: 1 um, or 1e-5 deg for a rotary axis."""


class CsvSource:
    """A table with a column `value_um` or `value_urad`, one row per reading.

    Further columns of READINGS.csv (setup, X_mm, approach) may be there; a row that contradicts the question is
    refused. Raises ReadingError for a file that is no such table.
    """

    def __init__(self, path: Path) -> None:
        self._table = table = read_table(path)
        self._rows: Iterator[Row] = iter(table.rows)
        self._values, self._stds = table.all_of("value"), table.all_of("std")
        texts = {column.stem: column for column in table.columns if column.unit is None}
        self._setup, self._approach = texts.pop("setup", None), texts.pop("approach", None)
        self._places = [c for c in table.columns if c.unit is not None and c.stem not in ("value", "std")]
        if not self._values:
            raise table.fail("there is no column 'value_um' or 'value_urad'", "Name the column of the readings so")
        if texts:
            remedy = "Known are setup, approach, value_um, value_urad, std_um, and positions such as X_mm"
            raise table.fail("column '{column}' is not known", remedy, column=next(iter(texts)))

    def read(self, request: Request) -> Answer:
        """Return the next row's value; raises SourceError when there is none or it is of another position."""
        row = next(self._rows, None)
        if row is None:
            what = "there are {rows} readings in it, and reading {reading} was asked for"
            remedy = "Add readings, or ask for fewer by the target `readings`"
            raise SourceError(what, remedy, self._table.file, rows=len(self._table.rows), reading=request.reading)
        self._refuse_other_place(row, request)
        return self._answer(row, request)

    def close(self) -> None:
        """Nothing is held."""

    def pass_over(self, count: int) -> None:
        """Leave out rows that an earlier run has used; raises SourceError if there are not so many."""
        for _ in range(count):
            if next(self._rows, None) is None:
                what = "it has fewer readings than the {count} that the record has taken from it"
                raise SourceError(what, "Give the file the record was begun with", self._table.file, count=count)

    def _answer(self, row: Row, request: Request) -> Answer:
        column = row.only_filled(self._values)
        if column is None:
            raise row.fail("there is no value", "Write the number that was read, or take out the line")
        _refuse_other_dimension(row, column, request)
        spread = row.only_filled(self._stds)
        if spread is None:
            return Answer(row.quantity(column))
        _refuse_other_dimension(row, spread, request)
        if (std := row.quantity(spread)) <= 0:
            remedy = "Give a std above 0, or leave it empty"
            raise row.fail("{spread} {text} is not positive", remedy, spread=spread.name, text=row.text(spread))
        return Answer(row.quantity(column), std)

    def _refuse_other_place(self, row: Row, request: Request) -> None:
        if self._setup and row.text(self._setup) not in ("", request.setup.name):
            raise _other(row, f"set-up '{row.text(self._setup)}'", f"'{request.setup.name}'", request)
        for column in self._places:
            self._refuse_other_coordinate(row, column, request)
        if self._approach:
            # a row may leave axes out, or all of them
            text = row.text(self._approach)
            asked = approach_text(request.axes, request.approach)
            if not set(re.split(r"[\s;]+", text)) <= {"", *asked.split()}:
                raise _other(row, f"approach {text}", asked or "none", request)

    def _refuse_other_coordinate(self, row: Row, column: Column, request: Request) -> None:
        names = [axis.name for axis in request.axes]
        if column.stem not in names:
            remedy = "The machine has {names}"
            raise row.fail("there is no axis '{stem}'", remedy, stem=column.stem, names=", ".join(names))
        if not row.text(column):
            return
        axis, asked = request.axes[names.index(column.stem)], request.pose[names.index(column.stem)]
        if abs(row.quantity(column) - asked) > _SAME[axis.rotary]:
            unit = column.unit or ""
            raise _other(
                row, f"{column.name} = {row.text(column)}", f"{axis.name} = {to_unit(asked, unit):.9g} {unit}", request
            )


def _refuse_other_dimension(row: Row, column: Column, request: Request) -> None:
    reads = INSTRUMENTS[request.setup.instrument].reads
    if dimension_of(column.unit or "") != reads:
        what = "'{column}' is filled, but the {instrument} reads a length"
        what = "'{column}' is filled, but the {instrument} reads an angle" if reads == "angle" else what
        remedy, unit = "Give the value as value_{unit}", reading_unit(request.setup)
        raise row.fail(what, remedy, column=column.name, instrument=request.setup.instrument, unit=unit)


def _other(row: Row, found: str, asked: str, request: Request) -> SourceError:
    what = "this row is of {found}, but reading {reading} is asked for at {asked}"
    remedy = "Give the readings in the order asked, or evaluate them as they are with `axiscal data estimate`"
    return SourceError(what, remedy, row.file, row.line, found=found, reading=request.reading, asked=asked)
