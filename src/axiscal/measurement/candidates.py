"""Candidates for a reading: poses spread evenly over what the set-ups allow, with the directions of approach."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from axiscal.error_model.volume import Box
from axiscal.machine.description import Machine
from axiscal.measurement.breaks import knots_along
from axiscal.measurement.chart_places import chart_candidates
from axiscal.measurement.observation import Observation
from axiscal.measurement.place import Places
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.numerics.spread import even_points


def spread(machine: Machine, setups: tuple[Setup, ...], count: int) -> Places:
    """Return about `count` candidates, shared evenly between the set-ups."""
    each = max(2, count // max(1, len(setups)))
    return Places.joined([Places.of_setup(i, *_of_setup(machine, setup, each)) for i, setup in enumerate(setups)])


def _of_setup(machine: Machine, setup: Setup, count: int) -> tuple[Array, Array]:
    if setup.chart is not None:
        return chart_candidates(machine, setup, setup.chart, count)
    moves = list(setup.moves)
    unit = even_points(count, 2 * len(moves))
    poses = np.tile(np.array(setup.park), (count, 1))
    low, high = np.array([setup.span(machine.axes[k], k) for k in moves]).reshape(-1, 2).T
    span = high - low
    poses[:, moves] = low + span * unit[:, : len(moves)] if len(moves) > 1 else low + span * even_points(count, 1)
    return snapped(machine, setup, poses), _approaches(machine, setup, unit[:, len(moves) :] > 0.5)


def _approaches(machine: Machine, setup: Setup, positive: NDArray[np.bool_]) -> Array:
    result = np.zeros((len(positive), len(machine.axes)))
    result[:, list(setup.moves)] = np.where(positive, setup.sides[0], setup.sides[-1])
    return result


def snapped(machine: Machine, setup: Setup, poses: Array) -> Array:
    """Return poses (m, q) moved to the nearest multiples of the set-up's raster that lie in the travel."""
    result = poses.copy()
    for k in setup.moves:
        if setup.raster[k] > 0:
            first, last = raster_range(machine, setup, k)
            result[:, k] = np.clip(np.round(poses[:, k] / setup.raster[k]), first, last) * setup.raster[k]
    return result


def raster_range(machine: Machine, setup: Setup, axis: int) -> tuple[int, int]:
    """Return the lowest and highest multiple of the raster in the travel of an axis."""
    low, high = (end / setup.raster[axis] for end in setup.span(machine.axes[axis], axis))
    return int(np.ceil(low - 1e-9)), int(np.floor(high + 1e-9))


def raster_positions(machine: Machine, setup: Setup, axis: int) -> Array:
    """Return the multiples of the raster in the travel of an axis, (p,) m or rad."""
    first, last = raster_range(machine, setup, axis)
    return setup.raster[axis] * np.arange(first, last + 1, dtype=np.float64)


def knot_lattice(observation: Observation, setup: int, axis: int, parts: int) -> Array:
    """Return the knots of an axis as a set-up meets them, and the ends, each stretch cut in equal parts, (p,)."""
    knots = knots_along(observation, axis, setup)
    inside = knots[:-1, None] + np.diff(knots)[:, None] * (np.arange(parts) / parts)
    return np.append(inside.ravel(), knots[-1])


def corners(box: Box) -> Array:
    """Return the corners of a box of poses, (2^q, q)."""
    return np.stack([g.ravel() for g in np.meshgrid(*box, indexing="ij")], axis=1)
