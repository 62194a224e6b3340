"""The mean deviation along an axis at a position of one axis, over all positions of the others.

A table over axis i that moves axis o takes away E[ δp · u_o | t_i ] at best, in least squares over the volume. It holds
the errors of axis i through their mean levers. Levers grow with the travel of axis i, so it holds the mean angular
errors of the other axes, too.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import Box
from axiscal.machine.kinematics import frames
from axiscal.numerics import Array
from axiscal.numerics.cubic import gauss

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
    ends = positions[[0, -1]]
    share = ((positions - ends[0]) / (ends[1] - ends[0]))[:, None]
    for axis in {f.axis for f in model.functions}:
        if axis == over:
            _add(rows, model, axis, _levers_over(model, box, moved, over, positions), positions, sign)
            continue
        _add_between(rows, model, axis, over, *_levers_of_other(model, box, moved, over, axis, ends), share)
    for index, plane in enumerate(model.planes, len(model.functions)):
        if over in plane.axes:
            _add_together(rows, model, box, moved, over, index, positions, share)
    return rows


def _between(ends: Array, share: Array) -> Array:
    """Return what is affine in the position from both its ends, (..., positions, n).  ends : (..., 2, n)"""
    first, last = np.moveaxis(ends[..., None, :], -3, 0)
    return np.asarray(first + share * (last - first))


def from_the_other_side(model: ErrorModel, over: int, rows: Array) -> Array:
    """Return the rows (…, size) of `mean_along` where positions are approached in the other direction."""
    result = rows.copy()
    for function in model.functions:
        if function.kind == "reversal" and function.axis == over:
            result[..., function.columns] *= -1.0
    return result


def turned(model: ErrorModel, box: Box, axis: int, positions: Array, sign: int) -> Array:
    """Return rows (positions, size) of the rotation of a rotary axis about its own line beyond its command."""
    poses, _ = _grid(model, box, axis, positions, None)
    poses = poses.reshape(len(positions), -1, poses.shape[1])[:, 0]
    direction = _motion(model, axis, poses)
    levers = np.zeros((len(model.terms), len(poses)))
    own = [i for i, f in enumerate(model.functions) if f.axis == axis]
    levers[own] = np.einsum("fmc,mc->fm", model.angular_levers(poses)[own], direction)
    return model.along(levers, poses, _approaches(poses, axis, sign))


def _seen_of(model: ErrorModel, owner: int, over: int) -> list[int]:
    """Return the functions of an axis that are seen along linear ones, reversals of the axis of the positions alone.

    A turn of a rotor about its own line is in its own table.
    """
    own = [i for i, f in enumerate(model.functions) if f.axis == owner and not taken_by_rotor(model, i)]
    return [i for i in own if owner == over or model.functions[i].kind != "reversal"]


def _levers_over(model: ErrorModel, box: Box, moved: Sequence[int], over: int, at: Array) -> Array:
    """Return the mean levers of the functions of the axis that positions are of, (moved, functions, at)."""
    poses, weights = _grid(model, box, over, at, None)
    return _levers_along(model, moved, _seen_of(model, over, over), poses, len(at)) @ weights


def _levers_of_other(
    model: ErrorModel, box: Box, moved: Sequence[int], over: int, owner: int, ends: Array
) -> tuple[Array, Array]:
    """Return positions (nodes,) of another axis, and the mean levers of its functions there times what each counts.

    levers : (moved, functions, ends, nodes)
    """
    poses, weights = _grid(model, box, over, ends, owner)
    at, of = np.unique(poses[: len(weights), owner], return_inverse=True)
    shares = np.zeros((len(weights), len(at)))
    shares[np.arange(len(weights)), of] = weights
    return at, _levers_along(model, moved, _seen_of(model, owner, over), poses, len(ends)) @ shares


def _levers_along(model: ErrorModel, moved: Sequence[int], functions: list[int], poses: Array, count: int) -> Array:
    """Return the levers of functions along moved axes, (moved, functions, count, nodes beside each)."""
    levers, rotations = model.levers(poses)[functions], frames(model.machine, poses).rotations
    along_axes = [rotations[o] @ np.array(model.machine.axes[o].direction) for o in moved]
    ways = np.array(along_axes).reshape(len(moved), len(poses), 3)  # of no axis too
    along: Array = np.einsum("fmc,omc->ofm", levers, ways)
    return along.reshape(len(moved), len(functions), count, len(poses) // count)


def _add(rows: Array, model: ErrorModel, over: int, levers: Array, positions: Array, sign: int) -> None:
    """Add what functions of the axis of the positions bring.  levers : (moved, functions, positions)"""
    for index, each in zip(_seen_of(model, over, over), np.moveaxis(levers, 1, 0), strict=True):
        function = model.functions[index]
        share = 0.5 * sign if function.kind == "reversal" else 1.0
        rows[:, :, function.columns] += share * each[:, :, None] * function.rows(positions)


def _add_between(rows: Array, model: ErrorModel, owner: int, over: int, at: Array, levers: Array, share: Array) -> None:
    """Add what functions of another axis bring: levers are affine in the position, so both ends tell.

    at : (nodes,) of it; levers : (moved, functions, ends, nodes); share : (positions, 1) of the way to the second end
    """
    for index, each in zip(_seen_of(model, owner, over), np.moveaxis(levers, 1, 0), strict=True):
        function = model.functions[index]
        rows[:, :, function.columns] += _between(each @ function.rows(at), share)


def _add_together(
    rows: Array, model: ErrorModel, box: Box, moved: Sequence[int], over: int, index: int, at: Array, share: Array
) -> None:
    """Add what an error of two axes does on average over the other one of them.

    at : (positions,); share : as of `_add_between`
    """
    plane = model.planes[index - len(model.functions)]
    own = plane.axes.index(over)
    poses, weights = _grid(model, box, over, at[[0, -1]], plane.axes[1 - own])
    beside = plane.sides[1 - own].rows(poses[: len(weights), plane.axes[1 - own]])[:, plane.pairs[:, 1 - own]]
    levers = _levers_along(model, moved, [index], poses, 2)[:, 0] * weights
    rows[:, :, plane.columns] += plane.sides[own].rows(at)[:, plane.pairs[:, own]] * _between(levers @ beside, share)


def taken_by_rotor(model: ErrorModel, index: int) -> bool:
    """Return whether an error turns a rotary axis about its own line, which its own table takes away."""
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

    Levers are affine in every linear coordinate, so its middle stands for its mean. The axis that owns the functions is
    integrated between its knots. Rotary axes take nodes that are exact for their sines and cosines.
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
