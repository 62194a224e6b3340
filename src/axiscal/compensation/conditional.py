"""The mean deviation along an axis at a position of one axis, over all positions of the others.

E[ δp · u_o | t_i ] is what a table over axis i that moves axis o can take away at best, in the least-squares sense
over the volume. It holds the errors of axis i through their mean levers and, since levers grow with the travel of
axis i, the mean angular errors of the other axes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.error_model.model import ErrorModel
from axiscal.error_model.volume import Box
from axiscal.machine.kinematics import frames
from axiscal.numerics import Array
from axiscal.numerics.quadrature import gauss

_TURN = 5
"""Even points around a turn: exact for the first and second harmonic, and levers have no more."""
_ARC = 8
"""Points of Gauss: sine and cosine over a part of a turn to rounding; a linear coordinate needs the middle alone."""
_GAUSS = 5
"""Points of Gauss: exact for polynomials of degree 9, and a cubic times a lever has 4."""


def mean_along(model: ErrorModel, box: Box, moved: Sequence[int], over: int, positions: Array, sign: int) -> Array:
    """Return rows (moved, positions, size) of E[ δp · u_o | t_over ] for every linear axis o in `moved`.

    sign : +1 or -1, the direction in which the position was approached
    What rotary axes turn too far is left out: their own tables take it away.
    """
    rows = np.zeros((len(moved), len(positions), model.size))
    for axis in {f.axis for f in model.functions}:
        if axis == over:
            rows += _seen(model, box, moved, over, axis, positions, sign)
            continue
        ends = positions[[0, -1]]
        share = ((positions - ends[0]) / (ends[1] - ends[0]))[:, None]
        both = _seen(model, box, moved, over, axis, ends, 0)
        columns = np.flatnonzero(both.any(axis=(0, 1)))
        first, last = np.moveaxis(both[:, :, None, columns], 1, 0)
        rows[:, :, columns] += first + share * (last - first)
    for index, plane in enumerate(model.planes, len(model.functions)):
        if over in plane.axes:
            rows += _together(model, box, moved, over, index, positions)
    return rows


def turned(model: ErrorModel, box: Box, axis: int, positions: Array, sign: int) -> Array:
    """Return rows (positions, size) of the rotation of a rotary axis about its own line beyond its command."""
    poses, _ = _grid(model, box, axis, positions, None)
    poses = poses.reshape(len(positions), -1, poses.shape[1])[:, 0]
    direction = _motion(model, axis, poses)
    levers = np.zeros((len(model.terms), len(poses)))
    own = [i for i, f in enumerate(model.functions) if f.axis == axis]
    levers[own] = np.einsum("fmc,mc->fm", model.angular_levers(poses)[own], direction)
    return model.along(levers, poses, _approaches(poses, axis, sign))


def _seen(model: ErrorModel, box: Box, moved: Sequence[int], over: int, owner: int, at: Array, sign: int) -> Array:
    """Return the rows (moved, at, size) that the functions of one axis bring."""
    poses, weights = _grid(model, box, over, at, None if owner == over else owner)
    levers = model.levers(poses)
    others = [i for i, f in enumerate(model.functions) if f.axis != owner or _taken_by_rotor(model, i)]
    levers[others] = 0.0
    levers[len(model.functions) :] = 0.0
    return _along_moves(model, moved, over, levers, (poses, weights), len(at), sign)


def _together(model: ErrorModel, box: Box, moved: Sequence[int], over: int, index: int, at: Array) -> Array:
    """Return the rows (moved, at, size) of what an error of two axes does on average over the other one of them."""
    (other,) = set(model.terms[index].axes) - {over}
    poses, weights = _grid(model, box, over, at, other)
    levers = model.levers(poses)
    levers[np.arange(len(levers)) != index] = 0.0
    return _along_moves(model, moved, over, levers, (poses, weights), len(at), 0)


def _along_moves(
    model: ErrorModel, moved: Sequence[int], over: int, levers: Array, grid: tuple[Array, Array], count: int, sign: int
) -> Array:
    """Return the mean rows (moved, count, size) along each moved axis.

    levers : (terms, m, 3); grid : poses (m, q) and weights of the nodes beside each position
    """
    poses, weights = grid
    result = np.empty((len(moved), count, model.size))
    for n, o in enumerate(moved):
        along = np.einsum("fmc,mc->fm", levers, _motion(model, o, poses))
        rows = model.along(along, poses, _approaches(poses, over, sign))
        result[n] = np.einsum("pwn,w->pn", rows.reshape(count, len(weights), model.size), weights)
    return result


def _taken_by_rotor(model: ErrorModel, index: int) -> bool:
    function = model.functions[index]
    axis = model.machine.axes[function.axis]
    return axis.rotary and function.angular and bool(abs(axis.direction[function.component % 3]) > 0.5)


def _motion(model: ErrorModel, axis: int, poses: Array) -> Array:
    """Return the direction in which the axis moves (or about which it turns) the TCP, (m, 3), workpiece frame."""
    direction: Array = frames(model.machine, poses).rotations[axis] @ np.array(model.machine.axes[axis].direction)
    return direction


def _approaches(poses: Array, axis: int, sign: int) -> Array:
    approaches = np.zeros_like(poses)
    approaches[:, axis] = sign
    return approaches


def _grid(model: ErrorModel, box: Box, over: int, at: Array, owner: int | None) -> tuple[Array, Array]:
    """Return poses (at x nodes, q) with the weights (nodes,) of the axes other than `over`.

    Levers are affine in every linear coordinate, so its middle stands for its mean; the axis that owns the functions
    is integrated between its knots; rotary axes take nodes that are exact for their sines and cosines.
    """
    nodes, weights = [], []
    for k, bounds in enumerate(box):
        x, w = (np.zeros(1), np.ones(1)) if k == over else _nodes(model, k, bounds, k == owner)
        nodes.append(x)
        weights.append(w)
    grid = np.stack([g.ravel() for g in np.meshgrid(*nodes, indexing="ij")], axis=1)
    share = np.prod(np.stack([g.ravel() for g in np.meshgrid(*weights, indexing="ij")]), axis=0)
    poses = np.tile(grid, (len(at), 1))
    poses[:, over] = np.repeat(at, len(grid))
    return poses, share


def _nodes(model: ErrorModel, axis: int, bounds: tuple[float, float], owner: bool) -> tuple[Array, Array]:
    """Return nodes and weights that sum to one."""
    start, stop = bounds
    if start == stop:
        return np.array([start]), np.ones(1)
    rotary = model.machine.axes[axis].rotary
    if owner:
        own = [f.basis.knots for f in model.functions if f.axis == axis]
        knots = np.unique(np.concatenate([*own, *(k for plane in model.planes for k in plane.knots_along(axis))]))
        extra = np.linspace(start, stop, 9) if rotary else np.array(bounds)
        breaks = np.unique(np.concatenate([knots[(knots > start) & (knots < stop)], extra]))
        nodes, weights = gauss(breaks, _GAUSS)
    elif rotary and abs(stop - start - 2 * np.pi) < 1e-9:
        return start + 2 * np.pi * np.arange(_TURN) / _TURN, np.full(_TURN, 1 / _TURN)
    else:
        nodes, weights = gauss(np.array(bounds), _ARC if rotary else 1)
    return nodes.ravel(), weights.ravel() / (stop - start)
