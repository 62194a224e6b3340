"""From the belief to one table per axis: what a correction of that axis alone can take away.

A carriage that is told to go c(t) less far moves the TCP by −c(t) along the axis. Over the volume the best c(t) in
the least-squares sense is the mean deviation along the axis at t, over all positions of the other axes: the
positioning error of the axis and, through the mean lever arm, its angular errors. What other axes contribute is
constant along t and belongs to their tables.
"""

from __future__ import annotations

import numpy as np

from axiscal.belief import Belief
from axiscal.compensation.table import CompensationTable
from axiscal.error_model.model import ErrorModel
from axiscal.error_model.volume import Box
from axiscal.machine.kinematics import frames
from axiscal.numerics import Array

_POINTS_PER_INTERVAL = 4
_MOST_POINTS = 129
_GAUSS = 12


def axis_tables(model: ErrorModel, belief: Belief, box: Box) -> tuple[CompensationTable, ...]:
    """Return a table for every axis along which the belief knows a deviation.

    belief : over the machine's coefficients first; box : the volume over which levers are averaged
    """
    return tuple(axis_table(model, belief, box, k) for k in _correctable(model))


def _correctable(model: ErrorModel) -> list[int]:
    named = {f.name.removesuffix("_reversal") for f in model.functions}
    return [k for k, axis in enumerate(model.machine.axes) if axis.positioning_error in named]


def axis_table(model: ErrorModel, belief: Belief, box: Box, axis: int) -> CompensationTable:
    """Return the table of one axis at evenly spaced positions over its travel."""
    positions = _positions(model, axis)
    forward, reverse = (_rows(model, box, axis, positions, sign) for sign in (1, -1))
    size = model.size
    factor = belief.factor[:size]
    std = np.sqrt(np.maximum(*(np.sum((rows @ factor) ** 2, axis=1) for rows in (forward, reverse))))
    own = model.machine.axes[axis]
    rest = sum(f.rest for f in model.functions if f.name == own.positioning_error)
    mean = belief.mean[:size]
    deviations = forward @ mean, reverse @ mean
    return CompensationTable(own.name, own.rotary, positions, *deviations, np.hypot(std, rest))


def _positions(model: ErrorModel, axis: int) -> Array:
    start, stop = model.machine.axes[axis].travel
    intervals = max((len(f.basis.knots) - 1 for f in model.functions if f.axis == axis), default=1)
    count = min(_POINTS_PER_INTERVAL * intervals, _MOST_POINTS - 1) + 1
    return np.linspace(start, stop, max(count, 2))


def _rows(model: ErrorModel, box: Box, axis: int, positions: Array, sign: int) -> Array:
    """Return the rows (m, size) of the mean deviation along the axis, approached in the direction of sign."""
    poses, weights = _poses(model, box, axis, positions)
    motion = _motion(model, axis, poses)
    levers = np.zeros((len(model.functions), len(poses)))
    own = [i for i, f in enumerate(model.functions) if f.axis == axis]
    if model.machine.axes[axis].rotary:
        levers[own] = np.einsum("fmc,mc->fm", model.angular_levers(poses)[own], motion)
    else:
        levers[own] = np.einsum("fmc,mc->fm", model.levers(poses)[own], motion)
    approaches = np.zeros_like(poses)
    approaches[:, axis] = sign
    rows = model.along(levers, poses, approaches).reshape(len(positions), len(weights), model.size)
    mean: Array = np.einsum("pwn,w->pn", rows, weights)
    return mean


def _motion(model: ErrorModel, axis: int, poses: Array) -> Array:
    """Return the direction in which the axis moves (or about which it turns) the TCP, (m, 3), workpiece frame."""
    direction: Array = frames(model.machine, poses).rotations[axis] @ np.array(model.machine.axes[axis].direction)
    return direction


def _poses(model: ErrorModel, box: Box, axis: int, positions: Array) -> tuple[Array, Array]:
    """Return poses (positions x nodes, q) with the weights (nodes,) of the other axes.

    Levers are affine in every linear coordinate, so its middle stands for its mean; rotary axes take Gauss nodes.
    """
    nodes, weights = [], []
    for k, bounds in enumerate(box):
        rotary = model.machine.axes[k].rotary and k != axis
        x, w = np.polynomial.legendre.leggauss(_GAUSS if rotary else 1)
        nodes.append(sum(bounds) / 2 + (bounds[1] - bounds[0]) / 2 * x)
        weights.append(w / 2)
    grid = np.stack([g.ravel() for g in np.meshgrid(*nodes, indexing="ij")], axis=1)
    share = np.prod(np.stack([g.ravel() for g in np.meshgrid(*weights, indexing="ij")]), axis=0)
    poses = np.tile(grid, (len(positions), 1))
    poses[:, axis] = np.repeat(positions, len(grid))
    return poses, share
