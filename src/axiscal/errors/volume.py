"""Means over the working volume: E[H] and E[HᵀH] in closed form, also with lever arms and rotary axes.

Every lever is affine in each linear coordinate and of first order in the sine and cosine of each rotary one. So three
nodes on a linear axis and five on a rotary one give the product of two levers exactly. One-dimensional integrals
remain, of spline rows against the Lagrange functions of those nodes: a small tensor grid with vector-valued weights.

An error of two axes takes products of integrals along each axis, nothing in two dimensions. A row of a plane is its
lever times a function of one axis times a function of the other. The Lagrange functions of the levers' nodes make E[row
row'ᵀ] a sum over few nodes. Its terms are products of the levers there and, axis by axis, integrals of one or two such
functions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from axiscal.errors.model import ErrorModel, Term
from axiscal.errors.plane import PlaneError
from axiscal.numerics import Array
from axiscal.numerics.cubic import gauss

Box = tuple[tuple[float, float], ...]
Counted = tuple[bool, bool, bool]
"""Whether deviations along x, y and z of the workpiece frame count."""
EVERY_WAY: Counted = (True, True, True)


@dataclass(frozen=True, eq=False, slots=True)
class VolumeMoments:
    """Means over the volume; with H the rows of the directions that count, P H.

    mean : (3, size) E[H], of every direction; gram : (size, size) E[HᵀPH]
    levers : by term E|P h|², h what a unit of it does to the TCP (of a reversal: half a unit, either way), no alignment
        taken off: what is as fine as a rest, a step or a twist is none of the part's rigid motion
    rest : E of the rest's share of the TCP variance, m²; counted : the directions that count
    """

    mean: Array
    gram: Array
    levers: Mapping[str, float]
    rest: float
    counted: Counted = EVERY_WAY

    @property
    def beyond_shift(self) -> Array:
        """E[HᵀPH] less E[PH]ᵀE[PH], the part that is one shift of the whole volume, (size, size)."""
        shift = self.mean[list(self.counted)]
        beyond: Array = self.gram - shift.T @ shift
        return beyond


@dataclass(frozen=True, eq=False, slots=True)
class _AxisMoments:
    """One axis: nodes (k,), E[ℓ_i] (k,), E[m ℓ_i] (k, n) and E[m mᵀ ℓ_i] (k, n, n) over the rows m of its functions.

    functions : indices of these; owner : per column the position in `functions`; columns : where they stand in A
    """

    nodes: Array
    plain: Array
    single: Array
    double: Array
    functions: list[int]
    owner: list[int]
    columns: list[int]


def whole_travel(model: ErrorModel) -> Box:
    """Return the box of all travels, bounds per axis in chain order, m or rad."""
    return tuple(axis.travel for axis in model.machine.axes)


def volume_moments(model: ErrorModel, box: Box, counted: Counted = EVERY_WAY) -> VolumeMoments:
    """Return the means over poses spread evenly in the box.

    Readings come from both directions evenly, so a reversal has mean zero and is alone with its own axis.
    Cost: O(nodes · functions²) for the levers and O(size²) for the rest; a few ms for five axes.
    """
    axes = [_axis_moments(model, k, bounds) for k, bounds in enumerate(box)]
    poses = np.stack([g.ravel() for g in np.meshgrid(*(a.nodes for a in axes), indexing="ij")], axis=1)
    levers = model.levers(poses).transpose(0, 2, 1).reshape(len(model.terms), 3, *(len(a.nodes) for a in axes))
    counts = levers[:, list(counted)]
    mean, weight = np.zeros((3, model.size)), np.zeros((model.size, model.size))
    for k, first in enumerate(axes):
        mean[:, first.columns] = _mean(levers, axes, k)
        for other in range(k, len(axes)):
            block = _two_axes(counts, axes, k, other) if other > k else _same_axis(counts, axes, k)
            weight[np.ix_(first.columns, axes[other].columns)] = block
            weight[np.ix_(axes[other].columns, first.columns)] = block.T
    add_planes(model, box, levers, counted, mean, weight)
    _separate_reversals(model, mean, weight)
    squares = averaged([a.plain for a in axes], np.einsum("fc...,fc...->f...", counts, counts), ())
    return VolumeMoments(mean, weight, *levers_and_rest(model, squares), counted)


def _axis_moments(model: ErrorModel, axis: int, bounds: tuple[float, float]) -> _AxisMoments:
    functions = [i for i, f in enumerate(model.functions) if f.axis == axis]
    own = [model.functions[i] for i in functions]
    points, weights = quadrature([f.basis.knots for f in own], bounds)
    nodes, shares = lagrange(points, bounds, model.machine.axes[axis].rotary)
    rows = np.hstack([f.basis.rows(points) for f in own]) if own else np.zeros((len(points), 0))
    weighted = shares.T * weights
    double = np.stack([rows.T @ (rows * share[:, None]) for share in weighted])
    owner = [i for i, f in enumerate(own) for _ in range(f.basis.size)]
    columns = [c for f in own for c in range(f.columns.start, f.columns.stop)]
    return _AxisMoments(nodes, weighted.sum(axis=1), weighted @ rows, double, functions, owner, columns)


def _products(levers: Array, first: _AxisMoments, second: _AxisMoments) -> Array:
    """Scalar products of the levers of two axes' functions on the grid, (functions, functions, grid)."""
    result: Array = np.einsum("fc...,gc...->fg...", levers[first.functions], levers[second.functions])
    return result


def _mean(levers: Array, axes: list[_AxisMoments], k: int) -> Array:
    axis = axes[k]
    own = averaged([a.plain for a in axes], levers[axis.functions], (k,))[axis.owner]
    result: Array = np.einsum("nci,in->cn", own, axis.single)
    return result


def _same_axis(levers: Array, axes: list[_AxisMoments], k: int) -> Array:
    axis = axes[k]
    products = averaged([a.plain for a in axes], _products(levers, axis, axis), (k,))[np.ix_(axis.owner, axis.owner)]
    block = np.einsum("nmi,inm->nm", products, axis.double)
    result: Array = (block + block.T) / 2
    return result


def _two_axes(levers: Array, axes: list[_AxisMoments], k: int, other: int) -> Array:
    first, second = axes[k], axes[other]
    products = averaged([a.plain for a in axes], _products(levers, first, second), (k, other))
    half = np.einsum("ngij,in->ngj", products[first.owner], first.single)
    result: Array = np.einsum("nmj,jm->nm", half[:, second.owner], second.single)
    return result


def _separate_reversals(model: ErrorModel, mean: Array, weight: Array) -> None:
    sign = np.zeros(model.size)
    for function in model.functions:
        if function.kind == "reversal":
            sign[function.columns] = function.axis + 1
    reversal = sign > 0
    mean[:, reversal] = 0.0
    weight[sign[:, None] != sign[None, :]] = 0.0
    weight[np.ix_(reversal, reversal)] /= 4.0


def levers_and_rest(model: ErrorModel, squares: Array) -> tuple[Mapping[str, float], float]:
    """Return the mean square levers of the terms by name, and the rests' share of the TCP variance, m².

    squares : (terms,) mean squares of the levers
    """
    levers = dict(zip((term.name for term in model.terms), (_sides(model) * squares).tolist(), strict=True))
    return MappingProxyType(levers), float(model.rests**2 @ squares)


def of_rests(model: ErrorModel, moments: VolumeMoments) -> VolumeMoments:
    """Return the means of a model that differs from theirs in the rests of its errors: nothing else follows these."""
    squares = np.array([moments.levers[term.name] for term in model.terms]) / _sides(model)
    rest = float(model.rests**2 @ squares)
    return moments if rest == moments.rest else replace(moments, rest=rest)


def _sides(model: ErrorModel) -> Array:
    """Return what half a unit, either way, makes of the square of a lever, (terms,)."""
    return np.array([0.25 if term.kind == "reversal" else 1.0 for term in model.terms])


def add_planes(
    model: ErrorModel,
    box: tuple[tuple[float, float], ...],
    levers: Array,
    counted: tuple[bool, bool, bool],
    mean: Array,
    gram: Array,
) -> None:
    """Set the part of planes in E[H] (3, size) and E[HᵀH] (size, size), in place.

    levers : (terms, 3, ...) at the nodes of all axes; counted : the directions in which they count in E[HᵀH]
    """
    if not model.planes:
        return
    axes = [_line(model, axis, bounds) for axis, bounds in enumerate(box)]
    counts = levers[:, list(counted)]
    for index, plane in enumerate(model.planes, len(model.functions)):
        mean[:, plane.columns] = _mean_of_planes(axes, levers[index], plane)
        for other, term in enumerate(model.terms[: index + 1]):
            block = _crossed(axes, np.einsum("c...,c...->...", counts[index], counts[other]), plane, term)
            gram[plane.columns, term.columns] = block
            gram[term.columns, plane.columns] = block.T


@dataclass(frozen=True, eq=False, slots=True)
class _AlongAxis:
    """One axis: positions (p,) of a quadrature, weights times the Lagrange functions (k, p), and their sums (k,)."""

    positions: Array
    weighted: Array
    plain: Array


def _line(model: ErrorModel, axis: int, bounds: tuple[float, float]) -> _AlongAxis:
    knots = [f.basis.knots for f in model.functions if f.axis == axis]
    knots += [each for plane in model.planes for each in plane.knots_along(axis)]
    positions, weights = quadrature(knots, bounds)
    _, shares = lagrange(positions, bounds, model.machine.axes[axis].rotary)
    weighted = shares.T * weights
    return _AlongAxis(positions, weighted, weighted.sum(axis=1))


def _factor(term: Term, axis: int, positions: Array) -> Array | None:
    """Return what of a term's rows runs along an axis, (p, c); None where they do not depend on it."""
    if not isinstance(term, PlaneError):
        return term.rows(positions) if term.axis == axis else None
    for side, own, index in zip(term.sides, term.axes, term.pairs.T, strict=True):
        if own == axis:
            return side.rows(positions)[:, index]
    return None


def _mean_of_planes(axes: list[_AlongAxis], levers: Array, plane: PlaneError) -> Array:
    """Return E[H] of a plane, (3, c).  levers : (3, ...) at the nodes of all axes"""
    low, high = sorted(plane.axes)
    left = averaged([line.plain for line in axes], levers, (low, high))
    first, second = (axes[a].weighted @ _needed(plane, a, axes[a].positions) for a in (low, high))
    result: Array = np.einsum("xij,ic,jc->xc", left, first, second)
    return result


def _needed(plane: PlaneError, axis: int, positions: Array) -> Array:
    factor = _factor(plane, axis, positions)
    assert factor is not None  # one of its own axes
    return factor


def _crossed(axes: list[_AlongAxis], products: Array, plane: PlaneError, term: Term) -> Array:
    """Return E[rowᵀ row'] of a plane with a term, (c, d).  products : of their levers at the nodes"""
    shared = tuple(sorted({*plane.axes, *term.axes}))
    left = averaged([line.plain for line in axes], products, shared)
    first, *others = (_integrals(axes[axis], axis, plane, term) for axis in shared)
    block = np.tensordot(left, first, axes=(0, 0))
    for each in others:
        lead = (None,) * (block.ndim - 3)
        block = np.sum(block * each[(slice(None), *lead)], axis=0)
    width = term.columns.stop - term.columns.start
    return np.broadcast_to(block, (len(plane.pairs), width))


def _integrals(line: _AlongAxis, axis: int, plane: PlaneError, term: Term) -> Array:
    """Return E[ℓ_i φ φ'] along an axis, (k, c or 1, d or 1)."""
    first, second = (_factor(each, axis, line.positions) for each in (plane, term))
    if first is None and second is not None:
        return (line.weighted @ second)[:, None, :]
    if first is not None and second is None:
        return (line.weighted @ first)[:, :, None]
    assert first is not None  # the axis is one of theirs
    assert second is not None
    return np.stack([(first * share[:, None]).T @ second for share in line.weighted])


_GAUSS = 10
"""Points of Gauss: exact for degree 19, and squares of cubics times levers have 8."""
_SHORT_TURN = 1.0
"""rad: over less, the moments of sine and cosine cancel, so polynomials stand for them; near it both hold."""
_POLYNOMIAL_NODES = 12
"""Sine and cosine over half a radian either way to rounding."""


def quadrature(knots: list[Array], bounds: tuple[float, float]) -> tuple[Array, Array]:
    """Composite Gauss-Legendre between all knots in the bounds, weights summing to one."""
    start, stop = bounds
    inner = np.unique(np.concatenate([*knots, np.linspace(start, stop, 5)]))
    breaks = np.concatenate([[start], inner[(inner > start) & (inner < stop)], [stop]])
    nodes, weights = gauss(breaks, _GAUSS)
    return nodes.ravel(), weights.ravel() / (stop - start)


def lagrange(points: Array, bounds: tuple[float, float], rotary: bool) -> tuple[Array, Array]:
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


def averaged(plain: Sequence[Array], values: Array, kept: tuple[int, ...]) -> Array:
    """Average an array (..., grid) over every axis that is not kept.  plain : of each axis E[ℓ_i] (k,)"""
    lead = values.ndim - len(plain)
    for k in reversed(range(len(plain))):
        if k not in kept:
            values = np.tensordot(values, plain[k], axes=([lead + k], [0]))
    return values
