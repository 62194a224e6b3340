"""Means over the working volume, E[H] and E[HᵀH], over poses spread evenly in it; in closed form along an axis.

A rigid motion of the part is not an error: the part is aligned by probing before it is machined. Alignment with
T(p) = [I, −(p − p̄)×] (3 × 6) leaves H − T E[TᵀT]⁻¹ E[TᵀH] of H, and of the mean variance

    W = E[HᵀH] − E[TᵀH]ᵀ E[TᵀT]⁻¹ E[TᵀH].

Every lever is affine in each linear coordinate and of first order in the sine and cosine of each rotary one. So three
nodes on a linear axis and five on a rotary one give the product of two levers exactly. One-dimensional integrals
remain, of spline rows against the Lagrange functions of those nodes: a small tensor grid with vector-valued weights.

The machine as it is and not to first order: deviations by the exact chain, and levers at the actual frames.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

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
from axiscal_core import rigid
from axiscal_core.machine import Machine
from axiscal_core.points import even_points
from axiscal_core.rigid import Motion
from axiscal_core.splines import gauss

_POSES, _BLOCK = 8000, 1000
"""At once, of deviations and of rows: of memory, not of the result."""
_NO_MOTION = 1e-12
"""Share of the largest motion from which on one is none: of a part that is a point, or a line."""


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


def even_poses(box: Box, count: int) -> Array:
    """Return so many poses spread evenly in a box, (count, q)."""
    low, high = np.array(box).T
    return np.asarray(low + (high - low) * even_points(count, len(low)))


@dataclass(frozen=True, eq=False)
class Alignment:
    """What probing the part takes off.

    poses : (m, q) over which it is aligned, spread evenly; counted : the directions in which it is, x, y and z
    """

    errors: Machine
    poses: Array
    counted: Counted = EVERY_WAY

    @cached_property
    def _counts(self) -> Array:
        return np.array(self.counted, dtype=float)[:, None]

    @cached_property
    def _middle(self) -> Array:
        return np.asarray(self.errors.frames(self.poses).tcp.mean(axis=0), dtype=np.float64)

    def motions(self, poses: Array) -> Array:
        """Return T at poses, (m, 3, 6): what shifts and turns of the part do to the tool point."""
        away = self.errors.frames(poses).tcp - self._middle
        shifts = np.broadcast_to(np.eye(3), (len(poses), 3, 3))
        return np.concatenate([shifts, -rigid.skew(away)], axis=2)

    @cached_property
    def _found(self) -> Array:
        """The rigid motion of the part in each error, (6, size)."""
        motion = (self.motions(self.poses) * self._counts).reshape(-1, 6)
        crossed = np.zeros((6, self.errors.size))
        for at in range(0, len(self.poses), _BLOCK):
            part = self.poses[at : at + _BLOCK]
            rows = self.errors.rows_at(part, np.zeros_like(part)).reshape(-1, self.errors.size)
            crossed += motion[3 * at : 3 * (at + _BLOCK)].T @ rows
        return np.asarray(np.linalg.lstsq(motion.T @ motion, crossed, rcond=_NO_MOTION)[0], dtype=np.float64)

    def taken_off(self, poses: Array) -> Array:
        """Return what is taken off the rows at poses, (m, 3, size)."""
        return self.motions(poses) @ self._found

    def left(self, poses: Array, deviations: Array) -> Array:
        """Return deviations (m, 3) without their own rigid motion, found at the same poses, m."""
        motion = self.motions(poses)
        seen = (motion * self._counts).reshape(-1, 6)
        moved = np.linalg.lstsq(seen, (deviations * self._counts[:, 0]).ravel(), rcond=None)[0]
        return deviations - motion @ moved


def volume_moments(
    errors: Machine, poses: Array, alignment: Alignment | None = None, counted: Counted = EVERY_WAY
) -> VolumeMoments:
    """Return the means over poses, from both directions evenly; what an alignment takes off is taken off.

    poses : (m, q), spread evenly over the volume, those over which the part is aligned
    """
    mean, gram, squares = np.zeros((3, errors.size)), np.zeros((errors.size,) * 2), np.zeros(len(errors.terms))
    ways, sides = list(counted), reversals_of(errors)
    for at in range(0, len(poses), _BLOCK):
        part = poses[at : at + _BLOCK]
        levers = errors.levers(part).transpose(2, 0, 1)
        middle, above = (errors.along(levers, part, np.full_like(part, side)) for side in (0.0, 1.0))
        left = middle if alignment is None else middle - alignment.taken_off(part).swapaxes(0, 1)
        rows = left[ways].reshape(-1, errors.size)
        mean += left.sum(axis=1)
        gram += rows.T @ rows
        squares += np.sum(levers[ways] ** 2, axis=(0, 2))
        for columns in sides:
            own = (above[:, :, columns] - middle[:, :, columns])[ways].reshape(-1, len(columns))
            gram[np.ix_(columns, columns)] += own.T @ own
    if alignment is not None:
        mean[:] = 0.0
    count = len(poses)
    return VolumeMoments(mean / count, gram / count, squares / count, counted)


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


def reversals_of(model: Machine) -> list[list[int]]:
    """Return the columns of the reversals of each axis: the side of one axis says nothing of another's."""
    found = dict[int, list[int]]()
    for term in model.curves:
        if term.kind == "reversal":
            found.setdefault(term.axis, []).extend(range(term.columns.start, term.columns.stop))
    return [*found.values()]


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
