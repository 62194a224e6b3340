"""The first readings where two axes act together and nobody knows how much: nine over the plane, whatever is stated.

Scales that are not learnt yet choose places that learn the scales badly. On measured maps the bands then cover less
often (docs/evidence/planes.md). Corners, edges and middle are the even design too.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.estimation.case import Case
from axiscal.measurement.candidates import snapped
from axiscal.measurement.place import Places
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array

_SIDE = 3
"""Places along each axis."""
_FEWEST = 12
"""Of fewer readings nine are too many."""
_READ = 0.01
"""Share of each travel within which a place counts as read."""
_FELT = 1e-12
"""m/rad, 1, or rad/rad: rounding of a lever."""


def plane_start(case: Case, readings: Sequence[Reading], left: int | None) -> Places:
    """Return those of the nine that are not read yet; none where scales of a plane are not learnt, or few are to come.

    They are asked for where one set-up alone is there and moves just two axes that act together.
    left : how many readings may still come; None for any number
    """
    setups = case.description.setups
    none = Places.none(len(case.description.machine.axes))
    enough = left is None or left + len(readings) >= _FEWEST
    if len(setups) != 1 or len(readings) >= _SIDE**2 or not enough or not _learns_a_plane(case, setups[0]):
        return none
    poses = _nine(case, setups[0])
    spans = np.array([axis.length for axis in case.description.machine.axes])
    read = np.array([reading.pose for reading in readings]).reshape(-1, len(spans))
    away = np.abs(poses[:, None] - read) / spans
    fresh = ~np.any(np.all(away < _READ, axis=2), axis=1)
    sides = np.zeros_like(poses)
    sides[:, list(setups[0].moves)] = setups[0].sides[0]
    return Places.of_setup(0, poses[fresh], sides[fresh])


def _learns_a_plane(case: Case, setup: Setup) -> bool:
    """Return whether a set-up moves two axes alone that act together, sees it, and its size is to be learnt."""
    learnt = {owner for size in case.sizes.of if size.kind == "together" for owner in size.owners}
    levers = np.abs(case.observation.levers(0, np.array([setup.park])))[:, len(case.errors.functions) :, 0]
    seen = zip(case.errors.planes, levers.max(axis=0).tolist(), strict=True)
    plain = setup.chart is None and setup.base is None
    return plain and any(
        set(plane.axes) == set(setup.moves) and plane.name in learnt and lever > _FELT for plane, lever in seen
    )


def _nine(case: Case, setup: Setup) -> Array:
    """Return corners, edges and middle of where a set-up can be read, on its raster, each once, (m, q)."""
    machine = case.description.machine
    lines = [np.linspace(*setup.span(machine.axes[axis], axis), _SIDE) for axis in setup.moves]
    places = np.stack([grid.ravel() for grid in np.meshgrid(*lines, indexing="ij")], axis=1)
    poses = np.tile(np.array(setup.park), (len(places), 1))
    poses[:, list(setup.moves)] = places
    return np.unique(snapped(machine, setup, poses), axis=0)
