"""The largest squared length of a sum of polynomial curves, one per axis, enclosed by branch and bound.

|f + Σ_k c_k(t_k)|² is sought over all t. On an interval a curve lies in the hull of its Bernstein control points, and a
squared length is convex: over a box of intervals it is at most what the sums of control points reach. The search first
drops boxes of whole intervals by the sum of the largest scalar products of each pair of axes. It halves the boxes that
may still exceed the best value until the gap is closed (`largest`).
"""

from __future__ import annotations

import itertools
from math import comb
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array
from axiscal.numerics.largest import Boxes, halves, largest

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
