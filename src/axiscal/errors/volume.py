"""Means over the working volume: E[H] and E[HᵀH] in closed form, also with lever arms and rotary axes.

Every lever is affine in each linear coordinate and of first order in the sine and cosine of each rotary one. So three
nodes on a linear axis and five on a rotary one give the product of two levers exactly. One-dimensional integrals
remain, of spline rows against the Lagrange functions of those nodes: a small tensor grid with vector-valued weights.

An error of two axes takes products of integrals along each axis, nothing in two dimensions. A row of a plane is its
lever times a function of one axis times a function of the other. The Lagrange functions of the levers' nodes make E[row
row'ᵀ] a sum over few nodes. Its terms are products of the levers there and, axis by axis, integrals of one or two such
functions.

The machine as it is and not to first order: deviations by the exact chain, and levers at the actual frames.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.kinematics import (
    Deviation,
    actual_deviation,
    composed,
    motion_of,
    small_motions,
    tool_motion,
    turn_between,
)
from axiscal.numerics import Array
from axiscal_core.machine import Machine
from axiscal_core.rigid import Motion
from axiscal_core.splines import gauss

_POSES = 8000
"""At once: of memory, not of the result."""


def deviation_of(model: Machine, coefficients: Array, poses: Array, approaches: Array) -> Deviation:
    """Return how the tool deviates by the exact chain.  coefficients : (size,); poses, approaches : (m, q)."""
    return actual_deviation(model, poses, small_motions(model, coefficients, poses, approaches))


def deviations_of(model: Machine, machines: Array, poses: Array, approaches: Array) -> Iterator[Deviation]:
    """Yield the same of many machines at the same poses.  machines : (n, size) of coefficients; poses : (m, q)"""
    at_once = max(_POSES // max(len(poses), 1), 1)
    rows = [term.rows(*term.at(poses)) for term in model.terms]
    for start in range(0, len(machines), at_once):
        some = machines[start : start + at_once]
        values = [own @ some[:, term.columns].T for own, term in zip(rows, model.terms, strict=True)]
        shape = len(model.terms), len(poses), len(some)
        moved = np.array(values).reshape(shape).swapaxes(1, 2).reshape(shape[0], -1)
        small = composed(model, moved, np.tile(approaches, (len(some), 1)))
        done = actual_deviation(model, np.tile(poses, (len(some), 1)), small)
        straight, turned = (part.reshape(len(some), len(poses), 3) for part in done)
        yield from (Deviation(*each) for each in zip(straight, turned, strict=True))


_H = 2.0**-100
"""A complex step: its square is below rounding, and a power of two rounds nothing itself."""


def levers_at(model: Machine, coefficients: Array, poses: Array) -> tuple[Array, Array]:
    """Return the levers of each term where the errors have moved the frames to; reversals at their middle.

    Of the TCP, m or m/rad, and of the tool's turn, (terms, m, 3) each, by complex steps of the exact chain.
    coefficients : (size,); poses : (m, q)
    """
    small = small_motions(model, coefficients, poses, np.zeros_like(poses))
    found = dict[tuple[str, int, int], Deviation]()
    ways = [(motion_of(term), term.axis, term.component % 3) for term in model.terms]
    for part, axis, along in set(ways):
        step = np.zeros(small.rotation.shape, dtype=complex)
        step[axis, :, along] = 1j * _H
        motion = tool_motion(model, poses, small._replace(**{part: getattr(small, part) + step}))
        turned = turn_between(motion.rotation.real, motion.rotation.imag / _H)
        found[part, axis, along] = Deviation(motion.translation.imag / _H, turned)
    straight, angular = (np.array([found[way][k] for way in ways]).reshape(-1, len(poses), 3) for k in range(2))
    return straight, angular


class MovedErrors(Machine):
    """The same errors with levers at the frames of a machine that is as believed, for what is known of it.

    machine : as described; point : (size,) where it is believed to be
    """

    machine: Machine
    point: Array

    def __init__(self, machine: Machine, point: Array) -> None:
        super().__init__(machine.axes, machine.errors, machine.tool, machine.held, machine.name, machine.nose)
        object.__setattr__(self, "machine", machine)
        object.__setattr__(self, "point", point)

    def __eq__(self, other: object) -> bool:
        return self is other

    def __hash__(self) -> int:
        return id(self)

    def levers(self, poses: Array, angular: bool = False) -> Array:
        """Return the TCP deviation, or the rotation of the tool, per unit of each term, (terms, m, 3)."""
        return levers_at(self, self.point, poses)[angular]

    def motion(self, poses: Array) -> Motion:
        """Return orientation and TCP of the tool.  poses : (m, q)"""
        return tool_motion(self, poses, small_motions(self, self.point, poses, np.zeros_like(poses)))


Box = tuple[tuple[float, float], ...]
Counted = tuple[bool, bool, bool]
"""Whether deviations along x, y and z of the workpiece frame count."""
EVERY_WAY: Counted = (True, True, True)


@dataclass(frozen=True, eq=False, slots=True)
class VolumeMoments:
    """Means over the volume; with H the rows of the directions that count, P H.

    mean : (3, size) E[H], of every direction; gram : (size, size) E[HᵀPH]
    squares : (terms,) E|P h|², h what a unit of a term does to the TCP, no alignment taken off: what is as fine as a
        rest, a step or a twist is none of the part's rigid motion
    counted : the directions that count
    """

    mean: Array
    gram: Array
    squares: Array
    counted: Counted = EVERY_WAY


@dataclass(frozen=True, eq=False, slots=True)
class AlongAxis:
    """One axis: nodes (k,) of the levers, positions (p,) of a quadrature, its weights times the Lagrange functions ℓ_i

    of these nodes (k, p), and their sums (k,), E[ℓ_i].
    """

    nodes: Array
    positions: Array
    weighted: Array
    plain: Array


@dataclass(frozen=True, eq=False, slots=True)
class SameAxes:
    """Terms of the same axes.

    terms : indices of these; owner : (n,) per column the position in `terms`; columns : (n,) where they stand in A
    rows : by axis what of each column runs along it, (p, n); a row is its lever times the product of these
    """

    terms: list[int]
    owner: NDArray[np.intp]
    columns: NDArray[np.intp]
    rows: Mapping[int, Array]


def whole_travel(model: Machine) -> Box:
    """Return the box of all travels, bounds per axis in chain order, m or rad."""
    return tuple(axis.travel for axis in model.axes)


def volume_moments(model: Machine, box: Box, counted: Counted = EVERY_WAY) -> VolumeMoments:
    """Return the means over poses spread evenly in the box.

    Readings come from both directions evenly, so a reversal has mean zero and is alone with its own axis.
    Cost: O(nodes · terms²) for the levers and O(size²) for the rest.
    """
    axes = [along_axis(model, k, bounds) for k, bounds in enumerate(box)]
    poses = np.stack([g.ravel() for g in np.meshgrid(*(a.nodes for a in axes), indexing="ij")], axis=1)
    levers = model.levers(poses).transpose(0, 2, 1).reshape(len(model.terms), 3, *(len(a.nodes) for a in axes))
    counts = levers[:, list(counted)]
    mean, weight = np.zeros((3, model.size)), np.zeros((model.size, model.size))
    groups = terms_by_axes(model, axes)
    for number, first in enumerate(groups):
        mean[:, first.columns] = _mean(axes, levers, first)
        for second in groups[: number + 1]:
            block = _crossed(axes, counts, first, second)
            weight[np.ix_(second.columns, first.columns)] = block.T
            weight[np.ix_(first.columns, second.columns)] = (block + block.T) / 2 if first is second else block
    _separate_reversals(model, mean, weight)
    squares = averaged([a.plain for a in axes], np.einsum("fc...,fc...->f...", counts, counts), ())
    return VolumeMoments(mean, weight, squares, counted)


def along_axis(model: Machine, axis: int, bounds: tuple[float, float]) -> AlongAxis:
    positions, weights = quadrature(model.knots_along(axis), bounds)
    nodes, shares = lagrange(positions, bounds, model.axes[axis].rotary)
    weighted = shares.T * weights
    return AlongAxis(nodes, positions, weighted, weighted.sum(axis=1))


def terms_by_axes(model: Machine, axes: Sequence[AlongAxis]) -> list[SameAxes]:
    """Return the terms with the same axes together."""
    found = dict[tuple[int, ...], list[int]]()
    for index, term in enumerate(model.terms):
        found.setdefault(tuple(sorted(term.axes)), []).append(index)
    return [_same_axes(model, axes, *each) for each in found.items()]


def _same_axes(model: Machine, axes: Sequence[AlongAxis], own: tuple[int, ...], terms: list[int]) -> SameAxes:
    each = [model.terms[i] for i in terms]
    columns = [np.arange(term.columns.start, term.columns.stop) for term in each]
    owner = np.repeat(np.arange(len(terms)), [len(mine) for mine in columns])
    sides = [{side.axis: side for side in term.sides} for term in each]
    rows = {axis: np.hstack([mine[axis].rows(axes[axis].positions) for mine in sides]) for axis in own}
    return SameAxes(terms, owner, np.concatenate(columns), rows)


def _mean(axes: Sequence[AlongAxis], levers: Array, mine: SameAxes) -> Array:
    """Return E[H] of terms, (3, n).  levers : (terms, 3, ...) at the nodes of all axes"""
    left = averaged([a.plain for a in axes], levers[mine.terms], tuple(mine.rows))[mine.owner]
    for axis, rows in mine.rows.items():
        left = np.einsum("nci...,in->nc...", left, axes[axis].weighted @ rows)
    return left.T


def _crossed(axes: Sequence[AlongAxis], levers: Array, first: SameAxes, second: SameAxes) -> Array:
    """Return E[rowᵀ row'] of terms with others, (n, m).  levers : (terms, c, ...) of the directions that count"""
    shared = tuple(sorted({*first.rows, *second.rows}))
    products = np.einsum("fc...,gc...->fg...", levers[first.terms], levers[second.terms])
    left = averaged([a.plain for a in axes], products, shared)[np.ix_(first.owner, second.owner)]
    for axis in shared:
        left = np.einsum("nmi...,inm->nm...", left, _integrals(axes[axis], axis, first, second))
    return left


def _integrals(line: AlongAxis, axis: int, first: SameAxes, second: SameAxes) -> Array:
    """Return E[ℓ_i φ φ'] along an axis, (k, n, m); φ is 1 where a row does not depend on it."""
    constant = np.ones((len(line.positions), 1))
    one, other = (each.rows.get(axis, constant) for each in (first, second))
    found = np.stack([(one * share[:, None]).T @ other for share in line.weighted])
    return np.broadcast_to(found, (len(line.weighted), len(first.columns), len(second.columns)))


def _separate_reversals(model: Machine, mean: Array, weight: Array) -> None:
    sign = np.zeros(model.size)
    for function in model.curves:
        if function.kind == "reversal":
            sign[function.columns] = function.axis + 1
    reversal = sign > 0
    mean[:, reversal] = 0.0
    weight[sign[:, None] != sign[None, :]] = 0.0
    weight[np.ix_(reversal, reversal)] /= 4.0


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
