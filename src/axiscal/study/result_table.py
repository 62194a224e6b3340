"""The results of a study as a table: one row for each case, in the order of the study, as CSV or Parquet."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from axiscal.record.durable import write_whole
from axiscal.study.figures_kept import FIGURES
from axiscal.study.study_case import canonical, key_of
from axiscal.study.study_file import Study
from axiscal.study.work import Done

Row = dict[str, Any]


def rows_of(study: Study, found: Mapping[str, Done]) -> list[Row]:
    """Return a row for each case that has a result or an error."""
    rows = list[Row]()
    for choices, draw in study.ways():
        drawn = study.drawn_values(draw)
        for machine in range(study.machines):
            done = found.get(key_of(choices, draw, machine))
            if done is not None:
                result = done.result or {}
                row: Row = {"machine": machine, **({"draw": draw} if study.drawn else {})}
                row |= {key: _cell(value) for key, value in {**choices, **drawn}.items()}
                row |= {FIGURES[name].column: result.get(FIGURES[name].column) for name in study.keep}
                rows.append({**row, "error": done.error})
    return rows


def _cell(value: Any) -> Any:
    """Return a value of the grid as one cell of a table has it."""
    return value if isinstance(value, str | int | float | bool) else canonical(value)


def write_table(folder: Path, rows: list[Row]) -> Path:
    """Write cases.parquet where pyarrow is installed, else cases.csv, and return the file; raises OSError."""
    if find_spec("pyarrow") is not None:
        return _parquet(folder / "cases.parquet", rows)
    path, text = folder / "cases.csv", io.StringIO()
    table = csv.DictWriter(text, list(rows[0]) if rows else [], lineterminator="\n")
    table.writeheader()
    table.writerows(rows)
    write_whole(path, text.getvalue().encode())
    return path


def _parquet(path: Path, rows: list[Row]) -> Path:
    import pyarrow
    import pyarrow.parquet

    columns = {name: _column([row[name] for row in rows]) for name in (rows[0] if rows else [])}
    sink = pyarrow.BufferOutputStream()
    pyarrow.parquet.write_table(pyarrow.table(columns), sink)
    write_whole(path, sink.getvalue().to_pybytes())
    return path


def _column(values: list[Any]) -> list[Any]:
    """Return values of one type: as text where a grid mixes types."""
    kinds = {type(value) for value in values if value is not None}
    if len(kinds) <= 1:
        return values
    if kinds == {int, float}:
        return [None if value is None else float(value) for value in values]
    return [None if value is None else str(value) for value in values]
