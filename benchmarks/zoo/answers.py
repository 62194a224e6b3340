"""A reader of what the program writes that shares nothing with its own: result.json, tables and what it says."""

from __future__ import annotations

import csv
import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from axiscal.numerics import Array
from tests.commands import Outcome


@dataclass(frozen=True, slots=True)
class HeightMap:
    """x, y : lines of the grid, mm; heights : (y, x) um"""

    x: Array
    y: Array
    heights: Array

    def at(self, x: Array, y: Array) -> Array:
        """Return heights between the points, um: bilinear, those of the edge outside, as the firmware takes them."""
        inside = np.clip(y, self.y[0], self.y[-1]), np.clip(x, self.x[0], self.x[-1])
        found: Array = RegularGridInterpolator((self.y, self.x), self.heights)(np.column_stack(inside))
        return found


@dataclass(frozen=True)
class Answer:
    """folder : of the results, with record and tables; outcome : of the command"""

    folder: Path
    outcome: Outcome

    @property
    def text(self) -> str:
        """All that a person is told on the last screen and beside it."""
        return f"{self.outcome.out}\n{self.outcome.err}"

    @cached_property
    def result(self) -> dict[str, Any]:
        """result.json; empty where the readings were refused."""
        path = self.folder / "result.json"
        return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}

    @property
    def withheld(self) -> bool:
        """Whether no U is promised."""
        return not self.result or bool(self.result["answer"]["withheld"])

    @property
    def expanded(self) -> float:
        """U of what the estimate says of the volume, um."""
        return float(self.result["U_um"])

    def expanded_with_tables(self, control: str = "csv") -> float:
        """Return U with the tables of a control, um; that of the estimate where none was written."""
        written = (table for table in self.result["tables"] if table["controller"] == control and table["file"])
        return next((float(table["U_um"]) for table in written), self.expanded)

    def axis_table(self, axis: str) -> tuple[Array, Array]:
        """Return positions, (p,) mm, and forward and reverse deviations of an axis over itself, (2, p) um.

        A table that was left out corrects nothing.
        """
        path = self.folder / "tables" / "csv" / f"{axis}.csv"
        if not path.exists():
            return np.array([0.0, 1.0]), np.zeros((2, 2))
        with path.open(encoding="utf-8", newline="") as file:
            rows = [row for row in csv.DictReader(file) if row["axis"] == axis]
        columns = [[float(row[name]) for row in rows] for name in ("position_mm", "forward_um", "reverse_um")]
        return np.array(columns[0]), np.array(columns[1:])

    def height_map(self) -> HeightMap:
        """Return the height map for RepRapFirmware."""
        text = (self.folder / "tables" / "reprapfirmware" / "heightmap.csv").read_text(encoding="utf-8")
        _, names, sizes, *rows = text.splitlines()
        size = dict(zip(names.split(","), map(float, sizes.split(",")), strict=True))
        x, y = (np.linspace(size[f"{a}min"], size[f"{a}max"], int(size[f"{a}num"])) for a in "xy")
        return HeightMap(x, y, 1000 * np.array([[float(cell) for cell in row.split(",")] for row in rows]))
