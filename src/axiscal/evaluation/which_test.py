"""Which test a file holds, by its columns, and the figures of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from axiscal.evaluation.circles import Circular, circular
from axiscal.evaluation.diagonals import Diagonals, diagonals
from axiscal.evaluation.kinematic import Kinematic, kinematic
from axiscal.evaluation.one_axis import Positioning, arranged, evaluate, read_iso230
from axiscal.evaluation.spindles import ErrorMotion, error_motion
from axiscal.measurement.readers.around import CIRCLE, HELD, TURNS, circle_of, held_paths, turns_of
from axiscal.measurement.readers.csv_table import CsvTable, read_table
from axiscal.measurement.readers.positioning import positioning_rows
from axiscal.measurement.readers.renishaw import is_rtl
from axiscal.measurement.readers.text import read_text

Figures = Positioning | Circular | Diagonals | ErrorMotion | Kinematic


def figures_of(path: str | Path) -> Figures:
    """Return the figures of the standard that a file is a test of; raises ReadingError, EvaluationError."""
    if is_rtl(read_text(path)):
        return evaluate(read_iso230(path))
    table = read_table(path)
    stems = {column.stem for column in table.columns}
    if stems >= HELD:
        return kinematic(held_paths(table))
    if stems >= TURNS:
        return error_motion(turns_of(table))
    if stems >= CIRCLE:
        return circular(circle_of(table))
    if "diagonal" in stems:
        return diagonals({name: arranged(positioning_rows(part)) for name, part in _by_diagonal(table).items()})
    return evaluate(read_iso230(path))


def _by_diagonal(table: CsvTable) -> dict[str, CsvTable]:
    """Return the rows of each diagonal as a separate table."""
    column = table.one_of("diagonal", "diagonal")
    columns = tuple(each for each in table.columns if each is not column)
    names = dict.fromkeys(row.text(column) for row in table.rows)
    return {
        name: replace(table, columns=columns, rows=tuple(row for row in table.rows if row.text(column) == name))
        for name in names
    }
