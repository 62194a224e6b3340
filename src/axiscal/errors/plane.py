"""The error of two axes together: I(x, y) = m_x(x)ᵀ A m_y(y), bicubic, beside the curves that each axis has alone.

Let s be the std, R Matérn-5/2 (or 3/2) at the knots, and P = 1 − 11ᵀ/n, which takes the mean off along each side. So no
row or column mean of A is free: it is in the curves (Gu and Wahba 1993).

    cov vec A = s² (P R_x P) ⊗ (P R_y P) = s² (F_x F_xᵀ) ⊗ (F_y F_yᵀ),    A = F_x Z F_yᵀ,    Z ~ N(0, s²)

F the eigenvectors of P R P times the roots of their eigenvalues. The unknowns are the entries of Z that hold all but a
ten-thousandth of the variance; the others count as rest. Their rows are (F_xᵀ m_x) ⊗ (F_yᵀ m_y).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.errors import prior
from axiscal.machine.axis import Axis
from axiscal.machine.entry import ErrorEntry, Kind, PlaneEntry
from axiscal.numerics import Array
from axiscal_core.eigen import settled
from axiscal_core.errors import ASIDE, CELLS
from axiscal_core.splines import Spline, distances, matern_by_length

_CUT = 1e-4
"""Share of the variance that the products left out may hold together."""
_SHORTER = 0.5
"""Of the stated lengths: readings may teach shorter ones, and the products that these need are kept as well."""
_NOUGHT = 1e-12
"""Eigenvalues of this share are the rounding of zero."""


class Side(NamedTuple):
    """One axis of a plane: its spline and the basis F (n, r) = U √λ of centred control values; values : λ (r,)."""

    spline: Spline
    basis: Array
    values: Array

    def rows(self, positions: Array, derivative: int = 0) -> Array:
        """Return F_kᵀ m_k at positions, (m, r)."""
        return self.spline.rows(positions, derivative) @ self.basis

    def cells(self, positions: Array) -> NDArray[np.int64]:
        """Return the number of the cell at each position (m,)."""
        knots = self.spline.knots
        share = (positions - knots[0] + ASIDE) / (knots[-1] - knots[0])
        cells: NDArray[np.int64] = np.clip(np.floor(share * self.cell_count), 0, self.cell_count - 1).astype(np.int64)
        return cells

    @property
    def cell_count(self) -> int:
        """Number of cells along the axis."""
        return CELLS * (len(self.spline.knots) - 1)

    def whitened(self, correlation: Array) -> Array:
        """Return the covariance of z with A = F z where A has the centred covariance P R P, (r, r)."""
        inverse = self.basis / self.values
        return inverse.T @ correlation @ inverse


@dataclass(frozen=True, eq=False, slots=True)
class PlaneError:
    """One error of two axes together.

    axes : of its sides, in the order of the name; axis : the later one in the chain, whose frame it moves
    component : 0-2 displacement along x y z, 3-5 rotation about x y z; pairs : (c, 2) which of both bases each
    unknown multiplies; covariance : (c, c) of the unknowns; columns : where they stand in A
    rest : standard deviation of what the products do not follow, m or rad, shared by readings in one cell of the plane
    """

    name: str
    entry: PlaneEntry
    axes: tuple[int, int]
    component: int
    sides: tuple[Side, Side]
    pairs: NDArray[np.intp]
    covariance: Array
    rest: float
    columns: slice

    @property
    def axis(self) -> int:
        """The later axis of the chain."""
        return max(self.axes)

    @property
    def kind(self) -> Kind:
        """It moves its frame as the error motion of one axis does."""
        return "motion"

    @property
    def angular(self) -> bool:
        """Whether the error is a rotation."""
        return self.component >= 3

    @property
    def cell_count(self) -> int:
        """Number of cells of the plane."""
        first, second = self.sides
        return first.cell_count * second.cell_count

    def coordinates(self, poses: Array) -> Array:
        """Return the positions of both axes at poses (m, q): (m, 2)."""
        return poses[:, list(self.axes)]

    def rows(self, coordinates: Array) -> Array:
        """Return (F_xᵀ m_x) ⊗ (F_yᵀ m_y), as far as it is kept, at positions of both axes (m, 2): (m, c)."""
        return self._product(*(side.rows(at) for side, at in zip(self.sides, coordinates.T, strict=True)))

    def slopes(self, coordinates: Array, axis: int) -> Array:
        """Return the derivative of the rows along one of the axes, per m or rad, (m, c)."""
        each = zip(self.sides, self.axes, coordinates.T, strict=True)
        return self._product(*(side.rows(at, derivative=int(own == axis)) for side, own, at in each))

    def _product(self, first: Array, second: Array) -> Array:
        return first[:, self.pairs[:, 0]] * second[:, self.pairs[:, 1]]

    def cells(self, coordinates: Array) -> NDArray[np.int64]:
        """Return the number of the cell of the plane at positions of both axes (m, 2)."""
        first, second = (side.cells(at) for side, at in zip(self.sides, coordinates.T, strict=True))
        return first * self.sides[1].cell_count + second

    def knots_along(self, axis: int) -> list[Array]:
        """Return its knots along an axis; none along one that it does not depend on."""
        return [side.spline.knots for side, own in zip(self.sides, self.axes, strict=True) if own == axis]

    def edges(self, cell: int, axis: int) -> list[Array]:
        """Return the ends of a cell along an axis; none along one that it does not depend on."""
        found, numbers = [], divmod(cell, self.sides[1].cell_count)
        for side, own, number in zip(self.sides, self.axes, numbers, strict=True):
            if own == axis:
                knots = side.spline.knots
                ends = np.ptp(knots) / side.cell_count * np.array([number, number + 1])
                found.append(knots[0] + ends - ASIDE)
        return found

    def plane_gram(self) -> Array:
        """Return the integral of rows rowsᵀ over the plane in closed form, G_x ⊗ G_y: (c, c)."""
        first, second = (side.basis.T @ side.spline.gram() @ side.basis for side in self.sides)
        return chosen(first, self.pairs[:, 0]) * chosen(second, self.pairs[:, 1])

    def taken_from(self, other: PlaneError) -> Array:
        """Return the map (c, d) from another model's unknowns of the same error, read at the knots of this one."""
        pairs = zip(self.sides, other.sides, strict=True)
        first, second = ((a.basis / a.values).T @ b.rows(a.spline.control_positions) for a, b in pairs)
        (one, two), (from_one, from_two) = self.pairs.T, other.pairs.T
        return first[np.ix_(one, from_one)] * second[np.ix_(two, from_two)]

    def loosened(self, rest: float) -> Array:
        """Return the variances (c,) that a rest which was not followed gives the unknowns, at most those beforehand."""
        first, second = self.sides
        scale = first.values[self.pairs[:, 0]] * second.values[self.pairs[:, 1]]
        return np.minimum(rest**2 / scale, np.diagonal(self.covariance))

    def prior(self, std: float, stretch: tuple[float, float], by: int | None = None) -> Array:
        """Return the covariance of the unknowns with another std, and other lengths by a factor each, (c, c).

        by : along which axis it is the derivative by the logarithm of that factor; None for none
        """
        parts = []
        for number, (side, entry, factor) in enumerate(zip(self.sides, self.entry.sides, stretch, strict=True)):
            found = (_by_length if number == by else _correlation)(side, entry, factor)
            parts.append(chosen(side.whitened(found), self.pairs[:, number]))
        return std**2 * parts[0] * parts[1]


def plane_error(entry: PlaneEntry, axes: tuple[Axis, Axis], indices: tuple[int, int], start: int) -> PlaneError:
    """Return the error of an entry, its unknowns from column `start` on."""
    first, second = (_side(side, axis) for side, axis in zip(entry.sides, axes, strict=True))
    pairs = kept(_shares(first, entry.sides[0]), _shares(second, entry.sides[1]), _CUT)
    pairs = pairs if entry.std else pairs[:0]
    bare = PlaneError(
        entry.name, entry, indices, entry.component, (first, second), pairs, np.eye(len(pairs)),
        entry.first_rest,
        slice(start, start + len(pairs)),
    )  # fmt: skip
    rest = float(np.hypot(entry.first_rest, entry.std * np.sqrt(_lost(bare))))
    return replace(bare, covariance=bare.prior(entry.std, entry.stretch), rest=rest)


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


def chosen(matrix: Array, index: NDArray[np.intp]) -> Array:
    """Return the rows and columns of a matrix with these indices."""
    return matrix[np.ix_(index, index)]


def _side(entry: ErrorEntry, axis: Axis) -> Side:
    spline = prior.basis(entry, axis)
    values, vectors = np.linalg.eigh(centred(prior.covariance(entry, spline)))
    large = values > _NOUGHT * values[-1]
    values, vectors = values[large][::-1], vectors[:, large][:, ::-1]
    return Side(spline, settled(values, vectors) * np.sqrt(values), values)


def _correlation(side: Side, entry: ErrorEntry, stretch: float) -> Array:
    """Return P R P at the stated length times a factor."""
    length = None if entry.length is None else entry.length * stretch
    return centred(prior.covariance(replace(entry, length=length), side.spline))


def _by_length(side: Side, entry: ErrorEntry, stretch: float) -> Array:
    """Return the derivative of P R P by the logarithm of the length."""
    apart = distances(side.spline)
    if entry.length is None:
        return np.zeros_like(apart)
    return centred(matern_by_length(apart / (entry.length * stretch), entry.smoothness))


def _shares(side: Side, entry: ErrorEntry) -> Array:
    """Return the variance of each eigenvector where the length is shorter than stated, (r,)."""
    vectors = side.basis / np.sqrt(side.values)
    shares: Array = np.einsum("nr,nm,mr->r", vectors, _correlation(side, entry, _SHORTER), vectors)
    return shares


def _lost(plane: PlaneError) -> float:
    """Return the mean variance, per std², that the products left out have at the knots."""
    if not len(plane.pairs):
        return 0.0
    whole, held = 1.0, np.ones(len(plane.pairs))
    each = zip(plane.sides, plane.entry.sides, plane.entry.stretch, plane.pairs.T, strict=True)
    for side, entry, stretch, index in each:
        correlation = _correlation(side, entry, stretch)
        whole *= float(np.trace(correlation)) / len(correlation)
        vectors = (side.basis / np.sqrt(side.values))[:, index]
        held *= np.einsum("nc,nm,mc->c", vectors, correlation, vectors) / len(correlation)
    return max(whole - float(held.sum()), 0.0)
