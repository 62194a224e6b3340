"""Means over the working volume: E[H] and E[HᵀH] in closed form, also with lever arms and rotary axes.

Every lever is affine in each linear coordinate and of first order in the sine and cosine of each rotary one. So three
nodes on a linear axis and five on a rotary one give the product of two levers exactly. One-dimensional integrals
remain, of spline rows against the Lagrange functions of those nodes: a small tensor grid with vector-valued weights.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from axiscal.errors.lever_nodes import averaged, lagrange, quadrature
from axiscal.errors.model import ErrorModel
from axiscal.errors.plane_moments import add_planes
from axiscal.numerics import Array

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
