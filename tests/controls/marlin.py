"""Marlin by its formulas: its text is not here, and building it takes a board's tool chain.

`Planner::skew`: sx = x - y xy - z (xz - xy yz), sy = y - z yz. `mesh_bed_leveling::get_z`: along x between the nodes
below and above, then along y. The whole of `M425` is added when an axis turns.
"""

from __future__ import annotations

import re

import numpy as np

from axiscal.numerics import Array
from axiscal.tables.surface import Mesh
from axiscal.units import from_unit, to_unit

VERSION = "formulas"
_NODE = re.compile(r"M421 I(\d+) J(\d+) Z(\S+)")


def added(code: str, built: Mesh, poses: Array, ways: Array) -> Array:
    """Return what the firmware adds to X, Y, Z, (m, 3) m.

    built : has the points of the mesh where the firmware has them; poses : (m, 3) m; ways : (m, 3), -1 for backwards
    """
    at = np.asarray(to_unit(poses, "mm"))
    factor, lost = words_of(code, "M852"), words_of(code, "M425")
    xy, xz, yz = (factor.get(letter, 0.0) for letter in "IJK")
    moved = at.copy()
    moved[:, 0] -= at[:, 1] * xy + at[:, 2] * (xz - xy * yz)
    moved[:, 1] -= at[:, 2] * yz
    nodes = {(int(i), int(j)): float(z) for i, j, z in _NODE.findall(code)}
    x, y = (np.asarray(to_unit(grid, "mm")) for grid in (built.x, built.y))
    for place in moved if nodes else ():
        i, j = (min(max(int((p - g[0]) / (g[1] - g[0])), 0), len(g) - 2) for p, g in zip(place, (x, y), strict=False))
        below, above = (_line(place[0], x[i], nodes[i, n], x[i + 1], nodes[i + 1, n]) for n in (j, j + 1))
        place[2] += _line(place[1], y[j], below, y[j + 1], above)
    for k, axis in enumerate("XYZ"):
        moved[:, k] -= lost.get("F", 1.0) * lost.get(axis, 0.0) * (ways[:, k] < 0)
    return np.asarray(from_unit(moved - at, "mm"))


def _line(at: float, a1: float, z1: float, a2: float, z2: float) -> float:
    return z1 + (at - a1) * (z2 - z1) / (a2 - a1)


def words_of(code: str, command: str) -> dict[str, float]:
    """Return the numbers of a command by their letters."""
    (found,) = re.findall(rf"^{command} (.*)$", code, re.MULTILINE) or [""]
    return {word[0]: float(word[1:]) for word in found.split()}
