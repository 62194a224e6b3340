"""The mean deviation along an axis at a position of one axis, over all positions of the others.

A table over axis i that moves axis o takes away E[ δp · u_o | t_i ] at best, in least squares over the volume. It holds
the errors of axis i through their mean levers. Levers grow with the travel of axis i, so it holds the mean angular
errors of the other axes, too. The means are those of the volume, in closed form, but for axis i.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.errors.volume import AlongAxis, Box, along_axis, averaged, lagrange, terms_by_axes
from axiscal.numerics import Array
from axiscal_core.machine import Machine


def mean_along(model: Machine, box: Box, moved: Sequence[int], over: int, positions: Array, sign: int) -> Array:
    """Return rows (moved, positions, size) of E[ δp · u_o | t_over ] for every linear axis o in `moved`.

    sign : +1 or -1, the direction in which the position was approached
    What rotary axes turn too far is left out: their own tables take it away.
    """
    nodes, shares = lagrange(positions, (positions[0], positions[-1]), rotary=False)
    axes = [_along(model, k, bounds) for k, bounds in enumerate(box)]
    axes[over] = AlongAxis(nodes, positions, shares.T, np.ones(len(nodes)))
    levers = np.moveaxis(_levers_along(model, axes, moved, over, sign), 2 + over, 2)
    others = [k for k in range(len(axes)) if k != over]
    rows = np.zeros((len(moved), len(positions), model.size))
    for group in terms_by_axes(model, axes):
        own = [k for k in others if k in group.rows]
        kept = tuple(others.index(k) for k in own)
        left = averaged([axes[k].plain for k in others], levers[group.terms], kept)[group.owner]
        for k in own:
            left = np.einsum("noij...,jn->noi...", left, axes[k].weighted @ group.rows[k])
        rows[:, :, group.columns] = np.einsum("noi,pi->opn", left, shares) * group.rows.get(over, 1.0)
    return rows


def _along(model: Machine, axis: int, bounds: tuple[float, float]) -> AlongAxis:
    """Return one axis of a mean, also where it stands."""
    if bounds[0] < bounds[1]:
        return along_axis(model, axis, bounds)
    place, one = np.array(bounds[:1]), np.ones(1)
    return AlongAxis(place, place, one[:, None], one)


def _levers_along(model: Machine, axes: Sequence[AlongAxis], moved: Sequence[int], over: int, sign: int) -> Array:
    """Return the levers of all terms along moved axes, (terms, moved, ...) at the nodes of all axes."""
    grid = np.meshgrid(*(axis.nodes for axis in axes), indexing="ij")
    poses = np.stack([each.ravel() for each in grid], axis=1)
    rotations = model.frames(poses).rotations
    along_axes = [rotations[o] @ np.array(model.axes[o].direction) for o in moved]
    ways = np.array(along_axes).reshape(len(moved), len(poses), 3)  # of no axis too
    counted = np.array([_counted(model, index, over, sign) for index in range(len(model.terms))])
    found: Array = np.einsum("f,fmc,omc->fom", counted, model.levers(poses), ways)
    return found.reshape(len(counted), len(moved), *grid[0].shape)


def _counted(model: Machine, index: int, over: int, sign: int) -> float:
    """Return how much of an error is seen along linear axes: reversals, and planes, of the axis of the positions alone.

    A turn of a rotor about its own line is in its own table.
    """
    if index >= len(model.curves):
        return float(over in model.terms[index].axes)
    function = model.curves[index]
    if taken_by_rotor(model, index):
        return 0.0
    return 0.5 * sign * (function.axis == over) if function.kind == "reversal" else 1.0


def turned(model: Machine, box: Box, axis: int, positions: Array, sign: int) -> Array:
    """Return rows (positions, size) of the rotation of a rotary axis about its own line beyond its command."""
    poses = np.tile(np.mean(box, axis=1), (len(positions), 1))
    poses[:, axis] = positions
    direction = model.frames(poses).rotations[axis] @ np.array(model.axes[axis].direction)
    levers = np.zeros((len(model.terms), len(poses)))
    own = [i for i, f in enumerate(model.curves) if f.axis == axis]
    levers[own] = np.einsum("fmc,mc->fm", model.levers(poses, angular=True)[own], direction)
    approaches = np.zeros_like(poses)
    approaches[:, axis] = sign
    return model.along(levers, poses, approaches)


def taken_by_rotor(model: Machine, index: int) -> bool:
    """Return whether an error turns a rotary axis about its own line, which its own table takes away."""
    function = model.curves[index]
    axis = model.axes[function.axis]
    return axis.rotary and function.angular and bool(abs(axis.direction[function.component % 3]) > 0.5)
