"""Means over the volume of errors of two axes: products of integrals along each axis, nothing in two dimensions.

A row of a plane is its lever times a function of one axis times a function of the other. The Lagrange functions of the
levers' nodes make E[row row'ᵀ] a sum over few nodes. Its terms are products of the levers there and, axis by axis,
integrals of one or two such functions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.errors.lever_nodes import averaged, lagrange, quadrature
from axiscal.errors.model import ErrorModel, Term
from axiscal.errors.plane import PlaneError
from axiscal.numerics import Array


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
        mean[:, plane.columns] = _mean(axes, levers[index], plane)
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


def _mean(axes: list[_AlongAxis], levers: Array, plane: PlaneError) -> Array:
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
