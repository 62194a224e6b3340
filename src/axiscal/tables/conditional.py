"""The mean deviation along an axis at a position of one axis, over all positions of the others.

A table over axis i that moves axis o takes away E[ δp · u_o | t_i ] at best, in least squares over the volume. It holds
the errors of axis i through their mean levers. Levers grow with the travel of axis i, so it holds the mean angular
errors of the other axes, too. The means are those of the volume, in closed form, but for axis i.

Every lever is affine in each linear coordinate and of first order in the sine and cosine of each rotary one. So three
nodes on a linear axis and five on a rotary one give the product of two levers exactly. One-dimensional integrals
remain, of spline rows against the Lagrange functions of those nodes: a small tensor grid with vector-valued weights.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.errors.volume import Box
from axiscal.numerics import Array
from axiscal_core.machine import Machine
from axiscal_core.splines import gauss


@dataclass(frozen=True, eq=False, slots=True)
class _AlongAxis:
    """What a mean along one axis needs.

    nodes : (k,) of the levers; positions : (p,) of a quadrature
    weighted : (k, p) its weights times the Lagrange functions ℓ_i of the nodes; plain : (k,) their sums, E[ℓ_i]
    """

    nodes: Array
    positions: Array
    weighted: Array
    plain: Array


@dataclass(frozen=True, eq=False, slots=True)
class _SameAxes:
    """Terms of the same axes.

    terms : indices of these; owner : (n,) per column the position in `terms`; columns : (n,) where they stand in A
    rows : by axis what of each column runs along it, (p, n); a row is its lever times the product of these
    """

    terms: list[int]
    owner: NDArray[np.intp]
    columns: NDArray[np.intp]
    rows: Mapping[int, Array]


def mean_along(model: Machine, box: Box, moved: Sequence[int], over: int, positions: Array, sign: int) -> Array:
    """Return rows (moved, positions, size) of E[ δp · u_o | t_over ] for every linear axis o in `moved`.

    sign : +1 or -1, the direction in which the position was approached
    What rotary axes turn too far is left out: their own tables take it away.
    """
    nodes, shares = _lagrange(positions, (positions[0], positions[-1]), rotary=False)
    axes = [_along(model, k, bounds) for k, bounds in enumerate(box)]
    axes[over] = _AlongAxis(nodes, positions, shares.T, np.ones(len(nodes)))
    levers = np.moveaxis(_levers_along(model, axes, moved, over, sign), 2 + over, 2)
    others = [k for k in range(len(axes)) if k != over]
    rows = np.zeros((len(moved), len(positions), model.size))
    for group in _terms_by_axes(model, axes):
        own = [k for k in others if k in group.rows]
        kept = tuple(others.index(k) for k in own)
        left = _averaged([axes[k].plain for k in others], levers[group.terms], kept)[group.owner]
        for k in own:
            left = np.einsum("noij...,jn->noi...", left, axes[k].weighted @ group.rows[k])
        rows[:, :, group.columns] = np.einsum("noi,pi->opn", left, shares) * group.rows.get(over, 1.0)
    return rows


def _along(model: Machine, axis: int, bounds: tuple[float, float]) -> _AlongAxis:
    """Return one axis of a mean, also where it stands."""
    if bounds[0] == bounds[1]:
        place, one = np.array(bounds[:1]), np.ones(1)
        return _AlongAxis(place, place, one[:, None], one)
    positions, weights = _quadrature(model.knots_along(axis), bounds)
    nodes, shares = _lagrange(positions, bounds, model.axes[axis].rotary)
    weighted = shares.T * weights
    return _AlongAxis(nodes, positions, weighted, weighted.sum(axis=1))


def _levers_along(model: Machine, axes: Sequence[_AlongAxis], moved: Sequence[int], over: int, sign: int) -> Array:
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


def _terms_by_axes(model: Machine, axes: Sequence[_AlongAxis]) -> list[_SameAxes]:
    """Return the terms with the same axes together."""
    found = dict[tuple[int, ...], list[int]]()
    for index, term in enumerate(model.terms):
        found.setdefault(tuple(sorted(term.axes)), []).append(index)
    return [_same_axes(model, axes, *each) for each in found.items()]


def _same_axes(model: Machine, axes: Sequence[_AlongAxis], own: tuple[int, ...], terms: list[int]) -> _SameAxes:
    each = [model.terms[i] for i in terms]
    columns = [np.arange(term.columns.start, term.columns.stop) for term in each]
    owner = np.repeat(np.arange(len(terms)), [len(mine) for mine in columns])
    sides = [{side.axis: side for side in term.sides} for term in each]
    rows = {axis: np.hstack([mine[axis].rows(axes[axis].positions) for mine in sides]) for axis in own}
    return _SameAxes(terms, owner, np.concatenate(columns), rows)


_GAUSS = 10
"""Points of Gauss: exact for degree 19, and squares of cubics times levers have 8."""
_SHORT_TURN = 1.0
"""rad: over less, the moments of sine and cosine cancel, so polynomials stand for them; near it both hold."""
_POLYNOMIAL_NODES = 12
"""Sine and cosine over half a radian either way to rounding."""


def _quadrature(knots: list[Array], bounds: tuple[float, float]) -> tuple[Array, Array]:
    """Composite Gauss-Legendre between all knots in the bounds, weights summing to one."""
    start, stop = bounds
    inner = np.unique(np.concatenate([*knots, np.linspace(start, stop, 5)]))
    breaks = np.concatenate([[start], inner[(inner > start) & (inner < stop)], [stop]])
    nodes, weights = gauss(breaks, _GAUSS)
    return nodes.ravel(), weights.ravel() / (stop - start)


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


def _averaged(plain: Sequence[Array], values: Array, kept: tuple[int, ...]) -> Array:
    """Average an array (..., grid) over every axis that is not kept.  plain : of each axis E[ℓ_i] (k,)"""
    lead = values.ndim - len(plain)
    for k in reversed(range(len(plain))):
        if k not in kept:
            values = np.tensordot(values, plain[k], axes=([lead + k], [0]))
    return values
