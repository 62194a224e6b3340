"""Set-ups that read one number anywhere over two linear axes: where they stand, and between what knots."""

from __future__ import annotations

import numpy as np

from axiscal.measurement.breaks import breaks_along, smoothness_along
from axiscal.measurement.observation import Observation, directions_of
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array

EXACT = 1e-8
"""Rounding of a polynomial of degree 8 in both coordinates, with room; a wrong degree is off by thousandths."""


def on_free_plane(observation: Observation, setup: int) -> bool:
    """Return whether a set-up reads one number while two linear axes move, wherever they are."""
    mounted = observation.setups[setup]
    axes = [observation.machine.axes[axis] for axis in mounted.moves]
    plain = mounted.chart is None and mounted.station is None and mounted.base is None
    return len(axes) == 2 and plain and len(directions_of(mounted)) == 1 and not any(axis.rotary for axis in axes)


def plane_poses(mounted: Setup, places: Array) -> Array:
    """Return the poses (m, q) at places (m, 2) of the two axes that move; the others are parked."""
    poses = np.tile(np.array(mounted.park), (len(places), 1))
    poses[:, list(mounted.moves)] = places
    return poses


def plane_pieces(observation: Observation, setup: int) -> tuple[tuple[Array, Array], tuple[int, int]]:
    """Return where rows are no longer one polynomial, along both axes, and the degree in each between."""
    first, second = observation.setups[setup].moves
    breaks = breaks_along(observation, first, setup), breaks_along(observation, second, setup)
    degree = smoothness_along(observation, first, setup)[0], smoothness_along(observation, second, setup)[0]
    return breaks, degree
