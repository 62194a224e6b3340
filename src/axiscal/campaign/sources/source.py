"""The protocol of a source: it answers questions for one reading at a time, or says why it cannot.

`sim[:SEED]` and `truth:FILE`: a virtual machine, with errors drawn from the prior or given as curves.

`csv:FILE`: readings that exist already, given in the order in which they are asked for.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from axiscal.document.ports import of_class
from axiscal.exceptions import ReadingError, SourceError
from axiscal.language.spoken import said
from axiscal.measurement.readers.csv_readings import Around, RawReading
from axiscal.measurement.readers.files import recognised
from axiscal.measurement.reading import approach_text, refuse_other_values, shown_approach, shown_pose
from axiscal.measurement.setup import Setup
from axiscal.units import format_quantity
from axiscal_core.axes import Axis

if TYPE_CHECKING:
    from axiscal.measurement.simulation import VirtualMachine


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

    def __post_init__(self) -> None:
        for value in (self.value, *self.others):
            of_class("Answer.value", value, float, int)


@dataclass(frozen=True, slots=True)
class Skip:
    """The reading cannot be taken, and why."""

    reason: str


@runtime_checkable
class Source(Protocol):
    """Something that takes readings. `read` raises SourceError when it cannot go on at all."""

    def read(self, request: Request) -> Answer | Skip:
        """Return the reading asked for."""

    def close(self) -> None:
        """Let go of whatever it holds, by itself nothing; may be called twice."""
        return


class SimulatedSource(Source):
    """A virtual machine as a source."""

    def __init__(self, machine: VirtualMachine, seed: int) -> None:
        self._machine, self._seed = machine, seed

    def read(self, request: Request) -> Answer:
        """Return the simulated reading."""
        from axiscal.measurement.simulation import by_number

        rng = next(by_number(self._seed, request.reading))
        value, *others = self._machine.read_all(request.setup, request.pose, request.approach, rng, request.seconds)
        return Answer(value, others=tuple(others))


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


class CsvSource(Source):
    """READINGS.csv, one row for each reading in the order asked; set-ups and places may be left out.

    A row that contradicts the question is refused.  Raises ReadingError for a file that is no such table, SourceError
    for one with fewer rows than an earlier run has used.
    taken : rows that it has used; setups : those that may be asked for, whose instruments may name columns
    """

    def __init__(self, path: Path, taken: int, setups: Sequence[Setup]) -> None:
        read = recognised(path, Around(setups=setups, bare=True))
        rows = read.readings
        if any(row.error or row.test for row in rows):
            what = "this is {title}, and no table of readings in the order asked"
            raise SourceError(what, "Evaluate it with `axiscal data estimate`", str(path), title=said(read.title))
        if taken > len(rows):
            what = "it has fewer readings than the {count} that the record has taken from it"
            raise SourceError(what, "Give the file the record was begun with", str(path), count=taken)
        self._file, self._count, self._rows = str(path), len(rows), iter(rows[taken:])

    def read(self, request: Request) -> Answer:
        """Return the next row's values; raises SourceError when there is none or it is of another position."""
        row = next(self._rows, None)
        if row is None:
            what = "there are {rows} readings in it, and reading {reading} was asked for"
            remedy = "Add readings, or ask for fewer by the target `readings`"
            raise SourceError(what, remedy, self._file, rows=self._count, reading=request.reading)
        if other := _other_place(row, request):
            what = "this row is of {found}, but reading {reading} is asked for at {asked}"
            remedy = "Give the readings in the order asked, or evaluate them as they are with `axiscal data estimate`"
            found, asked = other
            raise SourceError(what, remedy, self._file, row.line, found=found, reading=request.reading, asked=asked)
        try:
            refuse_other_values(request.setup, 1 + len(row.others), row.dimension)
        except ReadingError as other_kind:
            raise other_kind.placed(self._file, row.line) from None
        return Answer(row.value, row.std, row.others)


def _other_place(row: RawReading, request: Request) -> tuple[str, str] | None:
    """Return what a row is of and what is asked for, where these are not the same."""
    if row.setup not in ("", request.setup.name):
        return f"set-up '{row.setup}'", f"'{request.setup.name}'"
    axes = {axis.name: axis for axis in request.axes}
    asked = dict(zip(axes, request.pose, strict=True))
    for name, value in row.position.items():
        if name not in axes or abs(value - asked[name]) > _SAME[axes[name].rotary]:
            unit = axes[name].unit if name in axes else "mm"
            place = format_quantity(asked[name], unit, 9) if name in axes else said("none")
            return f"{name} = {format_quantity(value, unit, 9)}", f"{name} = {place}"
    sides = dict(zip(axes, request.approach, strict=True))
    if any(sides.get(name) != side for name, side in row.approach.items()):
        found = " ".join(f"{name}{'+' if side > 0 else '-'}" for name, side in row.approach.items())
        return f"approach {found}", approach_text(request.axes, request.approach) or "none"
    return None
