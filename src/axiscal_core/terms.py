"""An error as it adds to the deviation: rows over its unknowns, their covariance, cells of what these do not follow.

Of a curve the unknowns are its control values: independent ones (B&H eq. 16), or Matérn where a length is stated. On a
cyclic spline the distance is the chord of the circle, which keeps the kernel positive definite. In a wave, cosine and
sine of k turns a period have s²/k², k = 1…K. Each step has s², the mean level of steps none. A scale adds the
coordinate times one unknown.

What two axes do together is I(x, y) = m_x(x)ᵀ A m_y(y), bicubic, beside the curves that each axis has alone. Let s be
the std, R Matérn-5/2 (or 3/2) at the knots, and P = 1 − 11ᵀ/n, which takes the mean off along each side. So no row or
column mean of A is free: it is in the curves (Gu and Wahba 1993).

    cov vec A = s² (P R_x P) ⊗ (P R_y P) = s² (F_x F_xᵀ) ⊗ (F_y F_yᵀ),    A = F_x Z F_yᵀ,    Z ~ N(0, s²)

F the eigenvectors of P R P times the roots of their eigenvalues. The unknowns are the entries of Z that hold all but a
ten-thousandth of the variance; the others count as rest. Their rows are the products of rows F_xᵀ m_x and F_yᵀ m_y.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import reduce
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal_core.axes import Axis
from axiscal_core.eigen import settled
from axiscal_core.errors import Error, Kind
from axiscal_core.refusals import Array
from axiscal_core.splines import (
    Constant,
    CyclicSpline,
    NaturalSpline,
    Repeated,
    Segments,
    Spline,
    distances,
    even_knots,
    matern,
    matern_by_length,
    ramp,
)

CELLS, ASIDE = 8, 2e-4
"""Cells of a knot interval, within which a rest is one value; they begin so far before a knot, m or rad.

Places are round numbers, and stand at knots: a correction must not leave a cell."""
WAVE_KNOTS = 8
"""A cyclic spline of so many follows a sine within 1.2 thousandths (tests/numerics/test_repeated.py)."""
JOINT = 1e-3
"""m, or rad: over so much a reading head goes from one piece of a scale to the next (an assumption)."""
_CUT = 1e-4
"""Share of the variance that the products left out may hold together."""
_SHORTER = 0.5
"""Of the stated lengths: readings may teach shorter ones, and the products that these need are kept as well."""
_NOUGHT = 1e-12
"""Eigenvalues of this share are the rounding of zero."""


class Side(NamedTuple):
    """One axis of an error.

    axis : its index in a pose; error : knots and length along it; spline : over its travel
    basis : F (n, r) = U √λ, of a curve the control values themselves; values : λ, (r,), one of a curve
    which : (c,) column of it each unknown multiplies; None of a curve
    """

    axis: int
    error: Error
    spline: Spline
    basis: Array
    values: Array
    which: NDArray[np.intp] | None = None

    @property
    def key(self) -> tuple[object, ...]:
        """What sides with the same rows and cells have in common."""
        chosen = () if self.which is None else (self.basis.tobytes(), self.which.tobytes())
        return self.axis, self.spline.size, self.spline.knots.tobytes(), *chosen

    @property
    def own(self) -> NDArray[np.intp] | slice:
        """The columns of F that unknowns multiply."""
        return slice(None) if self.which is None else self.which

    def rows(self, positions: Array) -> Array:
        """Return what of the rows runs along this axis, at positions, (m, c)."""
        rows = self.spline.rows(positions)
        return rows if self.which is None else (rows @ self.basis)[:, self.which]

    def gram(self) -> Array:
        """Return the integral of these rows, rᵀ r over the travel, (c, c)."""
        return (self.basis.T @ self.spline.gram() @ self.basis)[self.own][:, self.own]

    def unknowns(self, control: Array) -> Array:
        """Return the unknowns of control values, (c, d).  control : (n, d)"""
        return ((self.basis / self.values).T @ control)[self.own]

    @property
    def cell_count(self) -> int:
        """Number of cells along the axis: eight in a knot interval, within each of which the rest is shared."""
        return CELLS * (len(self.spline.knots) - 1)

    @property
    def cell(self) -> float:
        """Length of a cell, m or rad."""
        return float(np.ptp(self.spline.knots)) / self.cell_count

    def cells(self, positions: Array) -> NDArray[np.int64]:
        """Return the number of the cell at each position (m,)."""
        along = np.floor((positions - self.spline.knots[0] + ASIDE) / self.cell)
        cells: NDArray[np.int64] = np.clip(along, 0, self.cell_count - 1).astype(np.int64)
        return cells

    def correlation(self, stretch: float) -> Array:
        """Return P R P at the stated length times a factor, (n, n)."""
        length = None if self.error.length is None else self.error.length * stretch
        return centred(covariance(replace(self.error, length=length), self.spline))

    def by_length(self, stretch: float) -> Array:
        """Return its derivative by the logarithm of the length."""
        apart = distances(self.spline)
        if self.error.length is None:
            return np.zeros_like(apart)
        return centred(matern_by_length(apart / (self.error.length * stretch), self.error.smoothness))

    def shares(self, correlation: Array) -> Array:
        """Return the variances of the eigenvectors where P R P is another, (c,)."""
        vectors = self.basis / np.sqrt(self.values)
        shares: Array = np.einsum("nc,nm,mc->c", vectors, correlation, vectors)
        return shares[self.own]


@dataclass(frozen=True, eq=False, slots=True)
class Term:
    """One error, a function of one axis or of two.

    error : what is known of it beforehand, whose name, kind, component and std it has
    linear : whether its axis is a carriage
    axis : whose frame it moves, of two the later one in the chain; sides : in the order of its name
    covariance : (c, c) prior of the unknowns; columns : where they stand in A
    rest : standard deviation of what the rows do not follow, m or rad, shared by readings in one cell
    """

    error: Error
    axis: int
    linear: bool
    sides: tuple[Side, ...]
    covariance: Array
    rest: float
    columns: slice
    name: str = field(init=False)
    kind: Kind = field(init=False)
    component: int = field(init=False)
    std: float = field(init=False)

    def __post_init__(self) -> None:
        for key in ("name", "kind", "component", "std"):
            object.__setattr__(self, key, getattr(self.error, key))

    @property
    def axes(self) -> tuple[int, ...]:
        """The axes whose positions it is a function of."""
        return tuple(side.axis for side in self.sides)

    @property
    def spline(self) -> Spline:
        """The spline of a curve; of a plane along its first axis."""
        return self.sides[0].spline

    @property
    def length(self) -> float | None:
        """Over which the control values of a curve are alike; None where that is not so, and where they are nothing."""
        error = self.error
        alike = self.spline.size > 1 and not error.repeats and not error.joints and error.std > 0
        return error.length if alike and not error.sides else None

    @property
    def ramp(self) -> Array | None:
        """The effect of one standard deviation of the scale on the control values, (n,); None without scale."""
        scale = self.error.scale
        return np.asarray(scale * ramp(self.spline), dtype=np.float64) if scale else None

    @property
    def stated_shape(self) -> bool:
        """Whether it repeats with a period, steps at joints or is of two axes: no curve that may be anything."""
        return len(self.sides) > 1 or bool(self.error.repeats or self.error.joints)

    @property
    def angular(self) -> bool:
        """Whether the error is a rotation."""
        return self.component >= 3

    @property
    def cell_count(self) -> int:
        """Number of cells, of a plane those of both axes together."""
        return math.prod(side.cell_count for side in self.sides)

    def at(self, poses: Array) -> list[Array]:
        """Return the positions of each of its axes at poses (m, q): (m,) each."""
        return [poses[:, side.axis] for side in self.sides]

    def rows(self, *at: Array) -> Array:
        """Return the rows at positions of each of its axes, (m,): (m, c)."""
        first, *others = map(Side.rows, self.sides, at)
        return reduce(np.multiply, others, first) if others else first

    def cells(self, *at: Array) -> NDArray[np.int64]:
        """Return the number of the cell at positions of each of its axes, (m,)."""
        found, *others = (side.cells(one) for side, one in zip(self.sides, at, strict=True))
        for side, more in zip(self.sides[1:], others, strict=True):
            found = found * side.cell_count + more
        return found

    def gram(self) -> Array:
        """Return the integral of rows rowsᵀ over its axes in closed form, G_x ⊗ G_y of two: (c, c)."""
        return reduce(np.multiply, [side.gram() for side in self.sides])

    def taken_from(self, other: Term) -> Array:
        """Return the map (c, d) from another model's unknowns of the same error, read at the knots of this one."""
        pairs = zip(self.sides, other.sides, strict=True)
        return reduce(np.multiply, [a.unknowns(b.rows(a.spline.control_positions)) for a, b in pairs])

    def loosened(self, rest: float) -> Array:
        """Return the variances (c,) that a rest which was not followed gives the unknowns, at most those beforehand."""
        scale = reduce(np.multiply, [side.values[side.own] for side in self.sides])
        return np.minimum(rest**2 / scale, np.diagonal(self.covariance))

    def prior(self, std: float, stretch: tuple[float, ...], by: int | None = None) -> Array:
        """Return the covariance of products with another std, and other lengths by a factor each, (c, c).

        by : along which side it is the derivative by the logarithm of that factor; None for none
        """
        result = np.array(std**2)
        for number, (side, factor) in enumerate(zip(self.sides, stretch, strict=True)):
            found = side.by_length(factor) if number == by else side.correlation(factor)
            inverse = side.basis / side.values
            result = result * (inverse.T @ found @ inverse)[side.own][:, side.own]
        return result


def term_of(error: Error, axes: Sequence[Axis], start: int) -> Term:
    """Return an error on its axes, its unknowns from column `start` on."""
    if error.sides:
        return _plane(error, axes, start)
    side = _side(error, axes)
    columns, spread = slice(start, start + side.spline.size), covariance(error, side.spline)
    return Term(error, side.axis, not axes[side.axis].rotary, (side,), spread, error.first_rest, columns)


def _plane(error: Error, axes: Sequence[Axis], start: int) -> Term:
    whole = [_with_eigenvectors(_side(side, axes)) for side in error.sides]
    first, second = (side.shares(side.correlation(_SHORTER)) for side in whole)
    pairs = kept(first, second, _CUT)
    own = pairs if error.std else pairs[:0]
    parts, count = zip(whole, own.T, strict=True), len(own)
    sides = tuple(side._replace(which=mine) for side, mine in parts)
    at = max(side.axis for side in sides)
    columns = slice(start, start + count)
    bare = Term(error, at, not axes[at].rotary, sides, np.eye(count), error.first_rest, columns)
    rest = float(np.hypot(error.first_rest, error.std * np.sqrt(_lost(bare))))
    return replace(bare, covariance=bare.prior(error.std, error.stretch), rest=rest)


def kept(first: Array, second: Array, cut: float) -> NDArray[np.intp]:
    """Return the products of two lists of variances (r,), (s,) that hold all but a share, the largest first, (c, 2)."""
    products = np.outer(first, second).ravel()
    order = np.argsort(-products, kind="stable")
    held = np.cumsum(products[order]) / products.sum()
    count = int(np.searchsorted(held, 1 - cut)) + 1
    return np.stack(np.unravel_index(np.sort(order[:count]), (len(first), len(second))), axis=1)


def centred(correlation: Array) -> Array:
    """Return P R P, P = 1 − 11ᵀ/n."""
    across = correlation - correlation.mean(axis=0)
    result: Array = across - across.mean(axis=1, keepdims=True)
    return result


def _side(error: Error, axes: Sequence[Axis]) -> Side:
    axis = [each.name for each in axes].index(error.axis)
    spline = spline_of(error, axes[axis])
    return Side(axis, error, spline, np.eye(spline.size), np.ones(spline.size))


def spline_of(error: Error, axis: Axis) -> Spline:
    """Return the spline of an error over the travel of its axis: a constant, cyclic for a full turn, else natural.

    A wave has a cyclic one over each period; steps have levels between their joints.
    """
    if error.period is not None and error.repeats:
        return Repeated(*axis.travel, error.period, WAVE_KNOTS * error.waves)
    if error.joints:
        return Segments(*axis.travel, error.joints, JOINT)
    if error.count < 2:
        return Constant(*axis.travel)
    return (CyclicSpline if axis.cyclic else NaturalSpline)(even_knots(*axis.travel, error.count))


def covariance(error: Error, spline: Spline) -> Array:
    """Return the prior covariance of the control values, (size, size)."""
    if error.repeats:
        turns = 2 * np.pi * np.arange(spline.size) / spline.size
        each = [np.cos(k * (turns[:, None] - turns)) / k**2 for k in range(1, error.waves + 1)]
        waves: Array = error.std**2 * np.sum(each, axis=0)
        return waves
    if error.joints:
        level = np.tri(spline.size, spline.size, -1)[:, :-1]
        above = level - level.mean(axis=0)
        steps: Array = error.std**2 * above @ above.T
        return steps
    if error.length is None or spline.size == 1:
        curve = np.eye(spline.size)
    else:
        curve = matern(distances(spline) / error.length, error.smoothness)
    along = (error.scale or 0.0) * ramp(spline)
    return np.asarray(error.std**2 * curve + np.outer(along, along))


def _with_eigenvectors(side: Side) -> Side:
    """Return one axis of a plane, with all eigenvectors of P R P."""
    values, vectors = np.linalg.eigh(side.correlation(1.0))
    large = values > _NOUGHT * values[-1]
    values, vectors = values[large][::-1], vectors[:, large][:, ::-1]
    return side._replace(basis=settled(values, vectors) * np.sqrt(values), values=values)


def _lost(term: Term) -> float:
    """Return the mean variance, per std², that the products left out have at the knots."""
    if not len(term.covariance):
        return 0.0
    whole, held = 1.0, np.ones(len(term.covariance))
    for side, stretch in zip(term.sides, term.error.stretch, strict=True):
        correlation = side.correlation(stretch)
        whole *= float(np.trace(correlation)) / len(correlation)
        held *= side.shares(correlation) / len(correlation)
    return max(whole - float(held.sum()), 0.0)
