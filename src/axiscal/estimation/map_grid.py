"""The places of a bed map that was read: columns and rows on which a mesh of the same fineness lies."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.machine.description import Machine
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array

Grid = tuple[Array, Array]
"""Positions of X and of Y, m, evenly spaced."""

_FEWEST = 3
"""Columns and rows below which there is no grid to speak of."""
_SHARE = 0.5
"""Share of the grid that was read; a map with more gaps than places is none."""
_ALONG = 0.99
"""Cosine: a bed is probed along z, and no set-up is between."""
_SAME = 1e-6
"""m; a probe does not stand better."""


def map_grid(machine: Machine, setups: Sequence[Setup], readings: Sequence[Reading]) -> Grid | None:
    """Return the grid of the readings along z while X and Y move; None where they lie on none.

    At least half of its nodes are read: a round bed has none in the corners.
    """
    names = [axis.name for axis in machine.axes]
    if not {"X", "Y"} <= set(names):
        return None
    sides = names.index("X"), names.index("Y")
    reading = {s.name for s in setups if set(sides) <= set(s.moves) and abs(s.direction[2]) > _ALONG}
    poses = np.array([r.pose for r in readings if r.setup in reading]).reshape(-1, len(names))
    x, y = (_levels(poses[:, side]) for side in sides)
    places = {tuple(place) for place in np.round(poses[:, sides] / _SAME).astype(int).tolist()}
    if min(len(x), len(y)) < _FEWEST or not (_even(x) and _even(y)):
        return None
    return (x, y) if len(places) >= _SHARE * len(x) * len(y) else None


def _levels(values: Array) -> Array:
    """Return the different values, increasing; those a micrometre apart are one."""
    ordered = np.sort(values)
    first = np.r_[True, np.diff(ordered) > _SAME][: len(ordered)]
    levels: Array = ordered[first]
    return levels


def _even(levels: Array) -> bool:
    steps = np.diff(levels)
    return bool(np.ptp(steps) < 1e-3 * np.mean(steps))
