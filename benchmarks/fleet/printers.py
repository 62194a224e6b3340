"""Bed maps of printers of one type by as many owners: one map a machine, and one description for all of them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array

DATA = Path(__file__).resolve().parents[3] / "shared" / "data" / "sisters"
"""The maps are not part of the project."""
SIDE = 7
"""Nodes along each axis, over the central 70 % of the bed, which most maps reach."""
_WITHIN = (0.15, 0.85)
_BEYOND = 0.04
"""Share of the bed by which a map may be short of that, and is carried on."""
_MACHINE = """name = "{name}"
chain = "w-b-X-Y-t"
[axes.X]
travel = ["0 mm", "{bed:.9g} mm"]
[axes.Y]
travel = ["0 mm", "{bed:.9g} mm"]
[errors]
B0X = {{ std = "1 mrad" }}
A0Y = {{ std = "1 mrad" }}
EZX = {{ std = "50 um", knots = 9, length = "{length:.9g} mm" }}
EZY = {{ std = "50 um", knots = 9, length = "{length:.9g} mm" }}
EZXY = {{ std = "25 um", knots = 9, length = ["{length:.9g} mm", "{length:.9g} mm"], rest = "5 um" }}
"""
_CAMPAIGN = """machine = "machine.toml"
usual = "off"
sure = "{sure}"
[target]
readings = 16
[[setups]]
name = "probe"
instrument = "probe"
direction = "z"
moves = ["X", "Y"]
noise = "2 um"
unknowns = {{ zero = "1 mm" }}
reach = {{ X = ["0 mm", "{bed:.9g} mm"], Y = ["0 mm", "{bed:.9g} mm"] }}
"""
_LENGTH = 0.35
"""Of the travel; a round figure for all types, as for single maps."""


@dataclass(frozen=True, eq=False)
class Printer:
    """name : of its owner and repository; bed : m; heights : (49,) m at `nodes`, row by row"""

    name: str
    bed: float
    heights: Array

    @property
    def nodes(self) -> Array:
        """Where the heights are, (49, 2) m."""
        line = self.bed * np.linspace(*_WITHIN, SIDE)
        return np.column_stack([np.tile(line, SIDE), np.repeat(line, SIDE)])

    def described(self, learning: bool = False, prior: str = "") -> CampaignDescription:
        """Return its campaign.  learning : sizes are learnt from the readings; prior : what its type has taught"""
        bed = 1e3 * self.bed
        machine = _MACHINE.format(name=self.name, bed=bed, length=_LENGTH * bed)
        sure = "roughly" if learning else "exactly"
        campaign = _CAMPAIGN.format(bed=bed, sure=sure)
        return campaign_from_texts(campaign, "campaign.toml", machine, "machine.toml", prior_text=prior)

    def readings(self, nodes: Sequence[int]) -> tuple[Reading, ...]:
        """Return what is read at some of the nodes."""
        at = self.nodes
        return tuple(Reading("probe", tuple(at[node].tolist()), (1, 1), float(self.heights[node])) for node in nodes)

    def write_record(self, folder: Path) -> Path:
        """Write its record of all nodes, and return the file."""
        file = folder / f"{self.name}.axiscal"
        with Campaign.create(file, self.described()) as campaign:
            campaign.adopt(self.readings(range(SIDE * SIDE)))
        return file


def types() -> list[str]:
    """Return the names of the types."""
    return sorted(path.name for path in DATA.iterdir() if path.is_dir())


def printers(kind: str) -> list[Printer]:
    """Return the machines of a type whose maps reach far enough: of each the median of its maps, node by node."""
    found = []
    for path in sorted((DATA / kind).glob("*.json")):
        document = json.loads(path.read_text(encoding="utf-8"))
        bed = float(document["nominal_bed_mm"])
        maps = [heights for each in document["maps"] if (heights := _heights(each, bed)) is not None]
        if maps:
            found.append(Printer(path.stem, 1e-3 * bed, np.median(maps, axis=0)))
    return found


def _heights(document: dict[str, list[float]], bed: float) -> Array | None:
    """Return the heights of a map at the nodes, (49,) m, tilt and offset taken off; None where it does not reach."""
    x, y, grid = (np.array(document[name], dtype=float) for name in ("x_mm", "y_mm", "z_mm"))
    low, high = (share * bed for share in _WITHIN)
    slack = _BEYOND * bed
    if min(len(x), len(y)) < 4 or not np.all(np.isfinite(grid)):
        return None
    if any(line.min() > low + slack or line.max() < high - slack for line in (x, y)):
        return None
    line = np.linspace(low, high, SIDE)
    x_order, y_order = np.argsort(x), np.argsort(y)
    rows = np.array([np.interp(line, x[x_order], row[x_order]) for row in grid[y_order]])
    heights = 1e-3 * np.array([np.interp(line, y[y_order], column) for column in rows.T]).T.ravel()
    return heights - plane_of(heights)


def plane_of(heights: Array) -> Array:
    """Return the plane of least squares through heights at the nodes, (49,)."""
    basis = plane_basis()
    plane: Array = basis @ (basis.T @ heights)
    return plane


def plane_basis() -> Array:
    """Return three orthonormal columns that span offset and tilt, (49, 3)."""
    line = np.linspace(-1, 1, SIDE)
    columns = np.column_stack([np.ones(SIDE**2), np.tile(line, SIDE), np.repeat(line, SIDE)])
    return np.asarray(np.linalg.qr(columns)[0])
