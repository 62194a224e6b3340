"""Measured maps of beds and plates: nodes, heights, and one description of a machine for all of them."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from axiscal.numerics import Array

DATA = Path(__file__).resolve().parents[3] / "shared" / "data" / "plane"
"""The measured maps are not part of the project."""

_MACHINE = """chain = "w-b-X-Y-t"
[axes.X]
travel = ["0 mm", "{x:.9g} mm"]
[axes.Y]
travel = ["0 mm", "{y:.9g} mm"]
[errors]
EZX = {{ std = "50 um", length = "{along:.9g} mm"{rest} }}
EZY = {{ std = "50 um", length = "{across:.9g} mm"{rest} }}
{plane}"""
_PLANE = 'EZXY = {{ std = "25 um", knots = 9, length = ["{0:.9g} mm", "{1:.9g} mm"], rest = "5 um" }}\n'
_CAMPAIGN = """machine = "map"
usual = "off"
[target]
readings = {count}
[[setups]]
name = "probe"
instrument = "probe"
direction = "z"
moves = ["X", "Y"]
noise = "2 um"
reach = {{ X = ["0 mm", "{x:.9g} mm"], Y = ["0 mm", "{y:.9g} mm"] }}
raster = {{ X = "{dx:.9g} mm", Y = "{dy:.9g} mm" }}
"""
_LENGTH = 0.35
"""Of the travel; a round figure for all maps."""


@dataclass(frozen=True, eq=False)
class Plane:
    """One map.  x, y : of its columns and rows, m, from 0; nodes : (m, 2) that were measured; heights : (m,) m."""

    name: str
    x: Array
    y: Array
    nodes: Array
    heights: Array

    @classmethod
    def of(cls, name: str, x: Array, y: Array, grid: Array) -> Plane:
        """Return the map of a grid (rows y, columns x), m, NaN where it was not measured."""
        row, column = np.nonzero(np.isfinite(grid))
        return cls(name, x, y, np.column_stack([x[column], y[row]]), grid[row, column])

    @property
    def span(self) -> Array:
        """Lengths of both sides, m, (2,)."""
        return np.array([self.x[-1], self.y[-1]])

    def nearest(self, place: Array) -> int:
        """Return the index of the node nearest to a place (2,), in shares of the sides."""
        return int(np.argmin(np.sum(((self.nodes - place) / self.span) ** 2, axis=1)))

    def texts(self, count: int, together: bool) -> tuple[str, str]:
        """Return campaign and machine for so many readings.  together : with the error of both axes"""
        x, y = (1e3 * self.span).tolist()
        along, across = _LENGTH * x, _LENGTH * y
        plane, rest = (_PLANE.format(along, across), "") if together else ("", ', rest = "5 um"')
        machine = _MACHINE.format(x=x, y=y, along=along, across=across, plane=plane, rest=rest)
        steps = {"dx": 1e3 * self.x[1], "dy": 1e3 * self.y[1]}
        return _CAMPAIGN.format(count=count, x=x, y=y, **steps), machine


def maps() -> Iterator[Plane]:
    """Yield all maps: Klipper meshes of one printer, height maps of four others, a granite plate bare and covered."""
    for mesh in json.loads((DATA / "klipper" / "neptune4.json").read_text()):
        x, y = (np.linspace(0, 1e-3 * (mesh[f"max_{a}"] - mesh[f"min_{a}"]), mesh[f"n{a}"]) for a in "xy")
        yield Plane.of(f"Neptune 4, {mesh['file'][8:23]}", x, y, 1e-3 * np.array(mesh["points_mm"]))
    for path in sorted((DATA / "rrf").glob("*.csv")):
        yield _height_map(path)
    for path in sorted(DATA.glob("ASTRAL*.csv")):
        yield _plate(path)


def _height_map(path: Path) -> Plane:
    """A RepRapFirmware height map; outside a round bed nothing was probed."""
    _, keys, numbers, *rows = path.read_text().splitlines()
    head = dict(zip(keys.split(","), map(float, numbers.split(",")), strict=True))
    grid = 1e-3 * np.array([[float(word) for word in row.split(",")] for row in rows])
    x, y = (1e-3 * head[f"{a}spacing"] * np.arange(int(head[f"{a}num"]), dtype=np.float64) for a in "xy")
    if head["radius"] > 0:
        far = np.hypot(*np.meshgrid(x + 1e-3 * head["xmin"], y + 1e-3 * head["ymin"]))
        grid = np.where(far <= 1e-3 * head["radius"], grid, np.nan)
    return Plane.of(path.stem, x, y, grid)


def _plate(path: Path) -> Plane:
    """Heights of a granite plate, seen by a camera."""
    rows = [row for row in csv.reader(path.read_text().splitlines()) if row and row[0].isdigit()]
    points = 1e-3 * np.array([[float(word) for word in row[1:4]] for row in rows])
    x, y = (np.unique(points[:, k].round(5)).astype(np.float64) for k in (0, 1))
    grid = np.full((len(y), len(x)), np.nan)
    for east, north, height in points:
        grid[np.argmin(np.abs(y - north)), np.argmin(np.abs(x - east))] = height
    return Plane.of(path.stem.removeprefix("ASTRAL_GRANITE_VISION_"), x - x[0], y - y[0], grid)
