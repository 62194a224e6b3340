"""The largest value of polynomials, enclosed by branch and bound with their Bernstein coefficients.

`steepest` takes the squared length of a sum of curves, one per axis: |f + Σ_k c_k(t_k)|² is sought over all t. On an
interval a curve lies in the hull of its Bernstein control points, and a squared length is convex: over a box of
intervals it is at most what the sums of control points reach. The search first drops boxes of whole intervals by the
sum of the largest scalar products of each pair of axes. It halves the boxes that may still exceed the best value until
the gap is closed (`largest`).

`largest_ratio` takes the ratio N/D of two polynomials over a plane. On a rectangle a polynomial lies between its
smallest and its largest Bernstein coefficient (Garloff 1986), and at the corners it is its coefficient there. So N/D is
at most the largest ratio of their coefficients. The search quarters boxes that may exceed the best known value until
none is left (`largest`).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from math import comb
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array
from axiscal.numerics.chebyshev import nodes
from axiscal.numerics.largest import Boxes, halves, largest, some

_BATCH = 2048
"""Boxes looked at at once: of memory, not of the result."""
_ROUNDING = 1e-11
"""Rounding of a sum of squares, with room: added to the bound."""
_EACH = 8
"""Boxes of each batch whose corners are looked at; more places are found, the bound is the same."""
_PLACES = 40
"""Best places that are kept as candidates; the bound is the same."""
_MOST = 20_000_000
"""Boxes of whole intervals that are told apart: of memory. Of more, all count with one bound, which proves little."""
_FIRST = 1 / 12
"""Share of the travel of the first step; every sweep halves it."""
_SWEEPS = 10
"""Halvings: to a ten-thousandth of the travel, from where other steps go on."""
_OFFSETS = np.linspace(-1.0, 1.0, 9)
"""Parts of a step that are tried."""


class BezierCurve(NamedTuple):
    """Pieces of a curve along one axis: control points (pieces, degree + 1, w) over [left, right], each (pieces,)."""

    left: Array
    right: Array
    control: Array


class Steepest(NamedTuple):
    """The largest squared length lies between lower, that at the first of some good places (m, q), and upper."""

    lower: float
    upper: float
    places: Array


def bernstein(degree: int, t: Array) -> Array:
    """Return the Bernstein polynomials of a degree at t (m,): (m, degree + 1)."""
    return np.stack([comb(degree, k) * t**k * (1 - t) ** (degree - k) for k in range(degree + 1)], axis=1)


def steepest(fixed: Array, curves: list[BezierCurve], level: float, gap: float, boxes: int) -> Steepest:
    """Enclose the largest |fixed + Σ curves|²; what is not above level · (1 + gap) is not followed further.

    fixed : (w,); curves : of one degree; boxes : how many to look at; what is then still open counts with its bound
    """
    search, upper = _CurveSearch(fixed, level, gap), _of_intervals(fixed, curves)
    if upper.ndim < len(curves):
        return Steepest(0.0, float(upper[0]) * (1 + _ROUNDING), search.places)
    flat = upper.ravel()
    worth = np.flatnonzero(flat > search.known)
    worth = worth[np.argsort(-flat[worth], kind="stable")[:boxes]]
    closed = float(np.delete(flat, worth).max(initial=0.0))
    if len(worth):
        pieces = _of_pieces(curves, np.stack(np.unravel_index(worth, upper.shape), axis=1))
        closed = max(closed, largest(search, pieces, flat[worth], boxes, _BATCH).upper)
    return Steepest(search.best, max(closed, search.best) * (1 + _ROUNDING), search.places)


class _CurveSearch:
    """Boxes : left, right (b, q), control points (b, q, degree + 1, w).  best : the largest squared length seen."""

    def __init__(self, fixed: Array, level: float, gap: float) -> None:
        self._fixed, self._level, self._gap = fixed, level, gap
        self.best = 0.0
        self._found: list[tuple[float, Array]] = []

    @property
    def known(self) -> float:
        """What is not above this is not followed."""
        return max(self.best, self._level) * (1 + self._gap)

    @property
    def places(self) -> Array:
        """The best places of all looks, best first."""
        best = sorted(self._found, key=lambda one: -one[0])[:_PLACES]
        return np.array([place for _, place in best])

    def look(self, boxes: Boxes) -> tuple[Boxes, Array]:
        """Return the boxes and what each may hold, after a look at the corners of some."""
        left, right, control = boxes
        upper, corners = _lengths(self._fixed, control)
        for box in np.argsort(-corners.max(axis=1), kind="stable")[:_EACH]:
            corner = int(corners[box].argmax())
            ends = list(itertools.product((0, 1), repeat=left.shape[1]))[corner]
            self._found.append((float(corners[box, corner]), np.where(ends, right[box], left[box])))
        self.best = max(self.best, float(corners.max()))
        return boxes, upper

    def split(self, boxes: Boxes) -> list[Boxes]:
        """Return both halves of every box, cut where its control points spread most."""
        left, right, control = boxes
        cut = np.linalg.norm(np.diff(control, axis=2), axis=3).sum(axis=2).argmax(axis=1)
        every, middle = np.arange(len(left)), (left + right) / 2
        parts = list[Boxes]()
        for half, (low, high) in zip(halves(control[every, cut], 1), ((left, middle), (middle, right)), strict=True):
            ends, points = (left.copy(), right.copy()), control.copy()
            ends[0][every, cut], ends[1][every, cut] = low[every, cut], high[every, cut]
            points[every, cut] = half
            parts.append((*ends, points))
        return parts


def _of_intervals(fixed: Array, curves: list[BezierCurve]) -> Array:
    """Return what each box of whole intervals may hold, (pieces of each axis); (1,) where these are too many.

    |f + Σ c_k|² ≤ |f|² + Σ max(|c_k|² + 2fᵀc_k) + 2 Σ max c_kᵀc_l, with curves moved to have a mean of nought.
    """
    points = [curve.control.reshape(-1, len(fixed)) for curve in curves]
    middles = [each.mean(axis=0) for each in points]
    base, count = fixed + sum(middles), len(curves)
    moved = [curve.control - middle for curve, middle in zip(curves, middles, strict=True)]
    tables: list[tuple[Array, tuple[int, ...]]] = [
        ((np.sum(each**2, axis=2) + 2 * each @ base).max(axis=1), (k,)) for k, each in enumerate(moved)
    ]
    for k, m in itertools.combinations(range(count), 2):
        products = 2 * np.einsum("iaw,jbw->iajb", moved[k], moved[m], optimize=True)
        tables.append((products.max(axis=(1, 3)), (k, m)))
    if np.prod([float(len(curve.left)) for curve in curves]) > _MOST:
        return np.array([float(base @ base) + sum(float(table.max()) for table, _ in tables)])
    upper = np.full((1,) * count, float(base @ base))
    for table, axes in tables:
        upper = upper + table.reshape([len(curve.left) if k in axes else 1 for k, curve in enumerate(curves)])
    return upper


def _of_pieces(curves: list[BezierCurve], which: NDArray[np.intp]) -> Boxes:
    """Return boxes of whole intervals.  which : (b, q) pieces"""
    left, right, control = (
        np.stack([part[at] for part, at in zip(parts, which.T, strict=True)], axis=1)
        for parts in zip(*curves, strict=True)
    )
    return left, right, control


def _lengths(fixed: Array, control: Array) -> tuple[Array, Array]:
    """Return for each box an upper bound of the squared length (b,), and that at its corners (b, 2^q)."""
    count, axes, points, _ = control.shape
    total = np.full((count, *[1] * axes), float(fixed @ fixed))
    for k in range(axes):
        own = np.sum(control[:, k] ** 2, axis=2) + 2 * control[:, k] @ fixed
        total = total + own.reshape(count, *(points if i == k else 1 for i in range(axes)))
    for k, m in itertools.combinations(range(axes), 2):
        products = 2 * control[:, k] @ control[:, m].transpose(0, 2, 1)
        total = total + products.reshape(count, *(points if i in (k, m) else 1 for i in range(axes)))
    ends = (slice(None), *[slice(None, None, points - 1)] * axes)
    return total.reshape(count, -1).max(axis=1), total[ends].reshape(count, -1)


def along(curve: BezierCurve, positions: Array) -> Array:
    """Return a curve at positions (m,): (m, w)."""
    piece = np.clip(np.searchsorted(curve.right, positions), 0, len(curve.right) - 1)
    share = (positions - curve.left[piece]) / (curve.right[piece] - curve.left[piece])
    values: Array = np.einsum("mk,mkw->mw", bernstein(curve.control.shape[1] - 1, share), curve.control[piece])
    return values


def uphill(fixed: Array, curves: list[BezierCurve], places: Array) -> Array:
    """Return where |fixed + Σ curves|² is largest near each place.  fixed : (w,); places : (m, q)."""
    places = places.copy()
    steps = [_FIRST * (curve.right[-1] - curve.left[0]) for curve in curves]
    for sweep in range(_SWEEPS):
        for k, (curve, step) in enumerate(zip(curves, steps, strict=True)):
            others = [along(c, places[:, m]) for m, c in enumerate(curves) if m != k]
            rest = np.sum([np.tile(fixed, (len(places), 1)), *others], axis=0)
            tried = np.clip(places[:, k, None] + _OFFSETS * step / 2**sweep, curve.left[0], curve.right[-1])
            seen = rest[:, None] + along(curve, tried.ravel()).reshape(*tried.shape, -1)
            best = np.einsum("mtw,mtw->mt", seen, seen).argmax(axis=1)
            places[:, k] = tried[np.arange(len(tried)), best]
    return places


PlaneForms = Callable[[Array], tuple[Array, Array]]
"""Places (m, 2) -> N and D there, each (m,), D above zero."""

_TAU = 1e-6
"""By so much more than the best that is known nothing is."""
_PLANE_BATCH = 4096
"""Boxes looked at at once: of memory, not of the result."""
_LOOKS = 64
"""Rectangles at which polynomials of a degree are compared with the forms; a wrong degree shows in almost all."""
_BOXES = 200_000
"""Boxes after which the search gives up; the bound holds wherever it ends, it is then only larger."""


class Enclosure(NamedTuple):
    """The largest ratio lies between lower, that at the place (2,), and upper.  boxes : so many were looked at"""

    lower: float
    upper: float
    place: Array
    boxes: int


class _PlaneSearch:
    """Boxes : low, high (b, 2), Bernstein coefficients of N and D, (b, n, m) each.

    best, place : the best ratio so far and where
    """

    def __init__(self, best: float, place: Array) -> None:
        self.best, self.place = best, place

    @property
    def known(self) -> float:
        """What is not above this is not followed."""
        return self.best * (1 + _TAU)

    def look(self, boxes: Boxes) -> tuple[Boxes, Array]:
        """Return the boxes and what each may hold, after a look at all corners.

        N/D is at most the largest ratio of their coefficients, where those of D are known to be above zero.
        """
        low, high, above, below = boxes
        ratios = above / np.where(below > 0, below, 1.0)
        corners = ratios[:, :: ratios.shape[1] - 1, :: ratios.shape[2] - 1]
        box, x, y = np.unravel_index(int(corners.argmax()), corners.shape)
        if corners[box, x, y] > self.best:
            self.best = float(corners[box, x, y])
            self.place = np.where([x == 1, y == 1], high[box], low[box])
        positive = np.all(below > 0, axis=(1, 2))
        return boxes, np.where(positive, ratios.max(axis=(1, 2)), np.inf)

    def split(self, boxes: Boxes) -> list[Boxes]:
        """Return the four quarters of every rectangle."""
        return [quarter for half in _split(boxes, 0) for quarter in _split(half, 1)]


def largest_ratio(
    forms: PlaneForms, breaks: tuple[Array, Array], degree: tuple[int, int], known: float = 0.0, boxes: int = _BOXES
) -> Enclosure:
    """Enclose the largest ratio over a rectangle.

    breaks : along both coordinates, ends included, increasing; between them N and D are polynomials of this degree
    known : a ratio that is reached somewhere; nothing that is no better than it, by τ, is followed
    boxes : how many to look at; what is then still open counts with a bound of its own
    """
    search = _PlaneSearch(known, np.array([breaks[0][0], breaks[1][0]]))
    patches, upper = search.look(_patches(forms, breaks, degree))
    found = largest(search, patches, upper, boxes, _PLANE_BATCH)
    return Enclosure(search.best, max(search.known, found.upper), search.place, found.looked)


def misfit(forms: PlaneForms, breaks: tuple[Array, Array], degree: tuple[int, int]) -> float:
    """Return by which share of the largest D and N polynomials of this degree miss them a quarter into rectangles."""
    patches = _patches(forms, breaks, degree)
    quarter = some(patches, np.unique(np.linspace(0, len(patches[0]) - 1, _LOOKS).astype(np.intp)))
    for axis in (0, 0, 1, 1):
        quarter = _split(quarter, axis)[0]
    _, high, above, below = quarter
    pairs = zip((above[:, -1, -1], below[:, -1, -1]), forms(high), strict=True)
    return max(float(np.max(np.abs(found - value)) / np.max(np.abs(value))) for found, value in pairs)


def _patches(forms: PlaneForms, breaks: tuple[Array, Array], degree: tuple[int, int]) -> Boxes:
    """Return every rectangle between breaks with its coefficients, found from as many places as they are."""
    inner = [(1 + nodes(each + 1)) / 2 for each in degree]
    lows = np.stack([g.ravel() for g in np.meshgrid(breaks[0][:-1], breaks[1][:-1], indexing="ij")], axis=1)
    highs = np.stack([g.ravel() for g in np.meshgrid(breaks[0][1:], breaks[1][1:], indexing="ij")], axis=1)
    unit = np.stack([g.ravel() for g in np.meshgrid(*inner, indexing="ij")], axis=1)
    places = lows[:, None] + (highs - lows)[:, None] * unit
    first, second = (np.linalg.inv(bernstein(each, at)) for each, at in zip(degree, inner, strict=True))
    shape = (len(lows), degree[0] + 1, degree[1] + 1)
    above, below = (
        np.einsum("ij,bjk,lk->bil", first, values.reshape(shape), second) for values in forms(places.reshape(-1, 2))
    )
    return lows, highs, above, below


def _split(boxes: Boxes, axis: int) -> tuple[Boxes, Boxes]:
    """Return both halves of rectangles along an axis."""
    low, high, *forms = boxes
    upper, lower = low.copy(), high.copy()
    upper[:, axis] = lower[:, axis] = (low[:, axis] + high[:, axis]) / 2
    first, second = zip(*(halves(form, axis + 1) for form in forms), strict=True)
    return (low, lower, *first), (upper, high, *second)
