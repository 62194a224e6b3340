"""The mean deviation along an axis at a position of one axis, over all positions of the others.

A table over axis i that moves axis o takes away E[ δp · u_o | t_i ] at best, in least squares over the volume. It holds
the errors of axis i through their mean levers. Levers grow with the travel of axis i, so it holds the mean angular
errors of the other axes, too. The means are those of the volume, in closed form, but for axis i.

Every lever is affine in each linear coordinate and of first order in the sine and cosine of each rotary one. So three
nodes on a linear axis and five on a rotary one give the product of two levers exactly. One-dimensional integrals
remain, of spline rows against the Lagrange functions of those nodes: a small tensor grid with vector-valued weights.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.errors.volume import Box
from axiscal.numerics import Array
from axiscal_core.machine import Machine
from axiscal_core.splines import gauss


def mean_along(model: Machine, box: Box, moved: int, over: int, positions: Array, sign: int) -> Array:
    """Return rows (positions, size) of E[ δp · u_o | t_over ] of a linear axis o.

    moved : the axis o; sign : +1 or -1, the direction in which the position was approached
    What rotary axes turn too far is left out: their own tables take it away.
    """
    nodes, shares = _lagrange(positions, (positions[0], positions[-1]), rotary=False)
    axes = [_along(model, k, bounds) for k, bounds in enumerate(box)]
    axes[over] = nodes, positions, shares.T
    levers = np.moveaxis(_levers_along(model, [nodes for nodes, *_ in axes], moved, over, sign), 1 + over, 1)
    rows = np.zeros((len(positions), model.size))
    for term, lever in zip(model.terms, levers, strict=True):
        sides, left = {side.axis: side for side in term.sides}, lever[..., None]
        for k, (_, at, weighted) in enumerate(axes):  # one axis of the grid after another
            if k == over:
                continue
            along = weighted @ sides[k].rows(at) if k in sides else weighted.sum(axis=1)[:, None]
            left = np.einsum("ij...n,jn->i...n", left, along)
        rows[:, term.columns] = (shares @ left) * (sides[over].rows(positions) if over in sides else 1.0)
    return rows


def _along(model: Machine, axis: int, bounds: tuple[float, float]) -> tuple[Array, Array, Array]:
    """Return what a mean along one axis needs, also where it stands: by Gauss between all knots.

    That is the nodes (k,) of the levers, the positions (p,) of a quadrature, and (k, p) its weights, whose sum is one,
    times the Lagrange functions of the nodes.
    """
    start, stop = bounds
    if start == stop:
        return np.array([start]), np.array([start]), np.ones((1, 1))
    inner = np.unique(np.concatenate([*model.knots_along(axis), np.linspace(start, stop, 5)]))
    breaks = np.concatenate([[start], inner[(inner > start) & (inner < stop)], [stop]])
    positions, weights = (each.ravel() for each in gauss(breaks, _GAUSS))
    nodes, shares = _lagrange(positions, bounds, model.axes[axis].rotary)
    return nodes, positions, shares.T * (weights / (stop - start))


def _levers_along(model: Machine, nodes: Sequence[Array], moved: int, over: int, sign: int) -> Array:
    """Return the levers of all terms along an axis, (terms, ...) at the nodes of all axes."""
    grid = np.meshgrid(*nodes, indexing="ij")
    poses = np.stack([each.ravel() for each in grid], axis=1)
    ways = model.frames(poses).rotations[moved] @ np.array(model.axes[moved].direction)
    counted = np.array([_counted(model, index, over, sign) for index in range(len(model.terms))])
    found: Array = np.einsum("f,fmc,mc->fm", counted, model.levers(poses), ways)
    return found.reshape(len(counted), *grid[0].shape)


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


_GAUSS = 10
"""Points of Gauss: exact for degree 19, and squares of cubics times levers have 8."""
_SHORT_TURN = 1.0
"""rad: over less, the moments of sine and cosine cancel, so polynomials stand for them; near it both hold."""
_POLYNOMIAL_NODES = 12
"""Sine and cosine over half a radian either way to rounding."""


def _lagrange(points: Array, bounds: tuple[float, float], rotary: bool) -> tuple[Array, Array]:
    """Return the nodes (k,) and the Lagrange functions at the points (m, k): the space products of levers live in."""
    start, stop = bounds
    middle: float = (start + stop) / 2
    half: float = (stop - start) / 2
    trigonometric = rotary and half > _SHORT_TURN / 2
    count = 5 if trigonometric else _POLYNOMIAL_NODES if rotary else 3
    even: Array = np.arange(count, dtype=float)
    offsets: Array = -np.cos(np.pi * (even + 0.5) / count) * half
    if trigonometric:
        offsets = half * (2 * even + 1 - count) / count
    space = _trigonometric if trigonometric else np.polynomial.chebyshev.chebvander
    scale = 1.0 if trigonometric else half
    at_nodes = space(offsets / scale, 4 if trigonometric else count - 1)
    at_points = space((points - middle) / scale, 4 if trigonometric else count - 1)
    functions: Array = np.asarray(np.linalg.solve(at_nodes.T, at_points.T).T, dtype=float)
    return middle + offsets, functions


def _trigonometric(angle: Array, order: int) -> Array:
    harmonics = [f(n * angle) for n in range(1, order // 2 + 1) for f in (np.cos, np.sin)]
    return np.stack([np.ones_like(angle), *harmonics], axis=1)
