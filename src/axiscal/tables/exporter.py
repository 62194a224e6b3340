"""What a control is for tables: its limits as data, what writes its files, and what reads them.

Whoever writes for a control writes a class with these. Sampling the estimate, adding what was active, reading back and
comparing are the same for all, here and in `offer`. One reader serves twice: for the files just written and for those
that were active while the machine was measured.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

from axiscal.estimation.machine_estimate import Estimate
from axiscal.machine.description import Machine
from axiscal.tables.effect import Control, table_control
from axiscal.tables.export_options import ExportOptions
from axiscal.tables.loaded import Loaded, OldFile
from axiscal.tables.offer import Draft
from axiscal.tables.sampling import MOST_POINTS, Multiples, axis_tables, cross_tables
from axiscal.tables.surface import Mesh, with_height
from axiscal.tables.table import CompensationTable


@dataclass(frozen=True, slots=True)
class Written:
    """Files with what to know of them.

    files : text by name; steps : what rounding may leave of each axis, m or rad; notes : how to load the files
    holds, left_out : instead of those of the control, where the files decide
    built : a map with its points where the firmware has them, for files that do not say it
    """

    files: Mapping[str, str]
    steps: Mapping[str, float]
    notes: tuple[str, ...]
    holds: str = ""
    left_out: str = ""
    built: Mesh | None = None


def summed(steps: Iterable[tuple[str, float]]) -> dict[str, float]:
    """Return the sums by axis."""
    found = dict[str, float]()
    for axis, step in steps:
        found[axis] = found.get(axis, 0.0) + step
    return found


class Exporter(ABC):
    """A control that files are written for.

    holds, left_out : what its files hold, and what not, each a sentence for README.txt
    tried : whether a real control of this kind has been seen to take them
    """

    holds: ClassVar[str]
    left_out: ClassVar[str]
    tried: ClassVar[bool] = False

    @abstractmethod
    def make(self, estimate: Estimate, options: ExportOptions) -> Draft:
        """Return the files before they are tried; raises TableError."""

    @abstractmethod
    def load(self, files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
        """Return what the control makes of files; raises TableError, ReadingError."""

    def held(self, written: Written, machine: Machine, options: ExportOptions) -> Control:
        """Return what the control does with files that were just written."""
        return self.load([OldFile(*file) for file in written.files.items()], machine, options).control(machine)


class TableFormat(Exporter):
    """A control whose files are tables of positions with what each axis is off by there.

    points : that a table holds; grid : of its positions, m and rad, by the decimals that are written
    across : it moves an axis over another one; both_ways : that has a direction
    on_top : points that fit once old tables are added, None for `points`; even : they stay evenly spaced then
    """

    points: ClassVar[int] = MOST_POINTS
    grid: ClassVar[Multiples] = (None, None)
    across: ClassVar[bool] = True
    both_ways: ClassVar[bool] = False
    on_top: ClassVar[int | None] = None
    even: ClassVar[bool] = True

    @abstractmethod
    def write(self, tables: Sequence[CompensationTable], machine: Machine, options: ExportOptions) -> Written:
        """Return the files for tables; raises TableError for what they cannot hold."""

    def tables(self, estimate: Estimate, options: ExportOptions) -> tuple[CompensationTable, ...]:
        """Return what the files are to hold, that of the old ones added; raises TableError."""
        most = self.points
        own = axis_tables(estimate, options.spacing, most, self.grid)
        over = cross_tables(estimate, options.spacing, most, self.grid[0]) if self.across else ()
        over = over if self.both_ways else tuple(table.averaged() for table in over)
        fit = most if self.on_top is None else self.on_top
        return options.old.under_tables((*own, *over), estimate.machine, fit, even=self.even)

    def wanted(self, tables: Sequence[CompensationTable], machine: Machine) -> Control:
        """Return what the files are meant to do."""
        return table_control(machine, tables)

    def make(self, estimate: Estimate, options: ExportOptions) -> Draft:
        """Return the files with their tables; raises TableError."""
        machine, tables = estimate.machine, self.tables(estimate, options)
        written = self.write(tables, machine, options)
        held = self.held(written, machine, options)
        wanted = self.wanted(tables, machine)
        said = (written.holds or self.holds, written.left_out or self.left_out, written.notes)
        return Draft(written.files, held, wanted, written.steps, tables, *said, self.tried)


class MapFormat(Exporter):
    """A control of X, Y and Z whose files hold the height over the plane, and what else a printer knows."""

    @abstractmethod
    def content(self, estimate: Estimate, options: ExportOptions) -> Loaded:
        """Return what the files are to hold, that of the old ones added; raises TableError."""

    @abstractmethod
    def write(self, content: Loaded, machine: Machine, options: ExportOptions) -> Written:
        """Return the files."""

    def make(self, estimate: Estimate, options: ExportOptions) -> Draft:
        """Return the files; raises TableError."""
        estimate = with_height(estimate)
        machine, content = estimate.machine, self.content(estimate, options)
        written = self.write(content, machine, options)
        held, wanted = self.held(written, machine, options), content.control(machine)
        said = (written.holds or self.holds, written.left_out or self.left_out, written.notes)
        return Draft(written.files, held, wanted, written.steps, (), *said, self.tried, about=estimate)
