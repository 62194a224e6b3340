"""The lattice of a machine whose errors simply add up: without lever arms a row is a sum over the axes.

g(t) = g_0 + Σ_k g_k(t_k), the stacked splines of B&H eq. 28-33.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.candidates import knot_lattice, raster_positions
from axiscal.measurement.observation import Observation
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.numerics.remembered import remembered
from axiscal_core.machine import Machine
from axiscal_core.points import even_points

_PER_INTERVAL = 8
_ADDS_UP = 1e-12
"""Rounding of a sum over the axes; a lever arm that is missing is millions of times larger."""
_LOOKS = 3
"""Poses that are looked at: rows that do not add up differ at almost every pose."""


@remembered
def adds_up(errors: Machine, mounted: Setup) -> bool:
    """Return whether the rows of a set-up are sums over its axes, looked at in a few poses."""
    moves = mounted.moves
    if len(moves) == 1:
        return True
    if any(set(plane.axes) <= set(moves) for plane in errors.planes):
        return False
    park = np.array(mounted.park)
    poses = np.tile(park, (_LOOKS, len(moves) + 1, 1))
    for i, share in enumerate(even_points(_LOOKS, len(moves)).T):
        axis = errors.axes[moves[i]]
        poses[:, [0, i + 1], moves[i]] = (axis.travel[0] + axis.length * share)[:, None]
    flat = np.concatenate([park[None], poses.reshape(-1, len(park))])
    rows = Observation(errors, (mounted,)).numbers(0, flat, np.zeros_like(flat)).rows
    parked, rows = rows[0].ravel(), rows[1:].reshape(_LOOKS, len(moves) + 1, -1)
    apart = rows[:, 0] - parked - (rows[:, 1:] - parked).sum(axis=1)
    return bool(np.all(np.abs(apart) <= _ADDS_UP * np.abs(rows).max(axis=(0, 1))))


@dataclass(frozen=True, eq=False, slots=True)
class Grid:
    """Places positions of one axis, (p,), with the sign of the approach, (p,), and what they add.

    columns : (c,) of the rows that change along the axis; rows : (p, c); variances : (p,)
    """

    axis: int
    positions: Array
    signs: Array
    columns: NDArray[np.intp]
    rows: Array
    variances: Array


@dataclass(frozen=True, eq=False, slots=True)
class StackedStarts:
    """The lattice of one set-up: the row (n,) and variance of the parked pose, and what each axis adds."""

    row: Array
    variance: float
    grids: list[Grid]


@remembered
def stack_of(observation: Observation, setup: int) -> StackedStarts:
    """Return the lattice of a set-up that adds up."""
    mounted = observation.setups[setup]
    park = np.array([mounted.park])
    parked = observation.rows(setup, park, np.zeros_like(park))
    row, variance = parked.rows[0], float(parked.variances[0])
    return StackedStarts(row, variance, [_grid(observation, setup, axis, row, variance) for axis in mounted.moves])


def _grid(observation: Observation, setup: int, axis: int, parked: Array, variance: float) -> Grid:
    mounted = observation.setups[setup]
    positions = _positions(observation, setup, axis)
    signs = np.full(len(positions), float(mounted.sides[0]))
    if len(mounted.sides) > 1 and axis in observation.errors.reversing:
        positions, signs = np.tile(positions, 2), np.concatenate([signs, -signs])
    poses = np.tile(np.array(mounted.park), (len(positions), 1))
    approaches = np.zeros_like(poses)
    poses[:, axis], approaches[:, axis] = positions, signs
    seen = observation.rows(setup, poses, approaches)
    added = seen.rows - parked
    columns = np.flatnonzero(np.any(added != 0, axis=0))
    return Grid(axis, positions, signs, columns, added[:, columns], seen.variances - variance)


def _positions(observation: Observation, setup: int, axis: int) -> Array:
    mounted = observation.setups[setup]
    if mounted.raster[axis] > 0:
        return raster_positions(observation.machine, mounted, axis)
    return knot_lattice(observation, setup, axis, _PER_INTERVAL)
