"""The largest squared length of a sum of polynomial curves, one per axis, enclosed by branch and bound.

|f + Σ_k c_k(t_k)|² is sought over all t. On an interval a curve lies in the hull of its Bernstein control points,
and a squared length is convex: over a box of intervals it is at most what the sums of control points reach. Whole
ranges of intervals are dropped first where the sum of the largest scalar products of each pair of axes is small enough;
boxes that may still hold more are halved (de Casteljau) until the gap is closed.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from math import comb
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array

_BATCH = 2048
"""Boxes looked at at once: of memory, not of the result."""
_ROUNDING = 1e-11
"""Rounding of a sum of squares, with room: added to the bound."""
_EACH = 8
"""Boxes of each batch whose corners are looked at; more places are found, the bound is the same."""
_PLACES = 40
"""Best places that are kept as candidates; the bound is the same."""


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

    fixed : (w,); boxes : how many to look at; what is then still open counts with its upper bound
    """
    search = _BoxSearch(fixed, curves, level, gap)
    open_ones = _Ranges(fixed, curves).worth_a_look(search, boxes)
    while open_ones and search.looked < boxes:
        search.look(open_ones)
    left = max((float(each.upper[0]) for each in open_ones), default=0.0)
    return Steepest(search.best, max(search.closed, left, search.best) * (1 + _ROUNDING), search.places)


class _Boxes(NamedTuple):
    """Boxes that may hold more.  upper : (b,) what each is known not to exceed; pieces : one curve of b per axis."""

    upper: Array
    pieces: list[BezierCurve]

    def chosen(self, which: NDArray[np.intp] | NDArray[np.bool_]) -> _Boxes:
        """Return some of the boxes."""
        return _Boxes(self.upper[which], [BezierCurve(*(part[which] for part in piece)) for piece in self.pieces])

    def batches(self) -> list[_Boxes]:
        """Return the boxes a few at a time, beginning with those that may hold most."""
        order = np.argsort(-self.upper, kind="stable")
        return [self.chosen(order[start : start + _BATCH]) for start in range(0, len(order), _BATCH)]


class _BoxSearch:
    """What is found so far.  closed : the largest upper bound of what has been set aside."""

    def __init__(self, fixed: Array, curves: list[BezierCurve], level: float, gap: float) -> None:
        self.fixed, self.level, self.gap = fixed, level, gap
        self.best, self.closed, self.looked = 0.0, 0.0, 0
        self._found: list[tuple[float, Array]] = []

    @property
    def places(self) -> Array:
        """The best places of all looks, best first."""
        best = sorted(self._found, key=lambda one: -one[0])[:_PLACES]
        return np.array([place for _, place in best])

    def worthwhile(self, upper: Array) -> NDArray[np.bool_]:
        """Return which boxes may hold more than is known, and remember the others."""
        worth: NDArray[np.bool_] = upper > max(self.best, self.level) * (1 + self.gap)
        self.closed = max(self.closed, float(upper[~worth].max(initial=0.0)))
        return worth

    def look(self, open_ones: list[_Boxes]) -> None:
        """Look at the boxes that may hold most, and put the halves of those that still may hold more back."""
        last = open_ones.pop(max(range(len(open_ones)), key=lambda i: float(open_ones[i].upper[0])))
        self.looked += len(last.upper)
        upper, corners = _lengths(self.fixed, last.pieces)
        for box in np.argsort(-corners.max(axis=1), kind="stable")[:_EACH]:
            corner = int(corners[box].argmax())
            self._found.append((float(corners[box, corner]), _place(last.pieces, int(box), corner)))
        self.best = max(self.best, float(corners.max()))
        worth = self.worthwhile(upper)
        if worth.any():
            open_ones += _halved(_Boxes(upper, last.pieces).chosen(worth)).batches()


@dataclass(frozen=True, eq=False)
class _Tree:
    """Ranges of pieces of one curve, each cut in two down to single pieces.

    children : (n, 2), -1 where a range is one piece; members : (n, points) of the control points; piece : (n,)
    """

    children: NDArray[np.intp]
    members: NDArray[np.bool_]
    piece: NDArray[np.intp]

    @classmethod
    def over(cls, pieces: int, points: int) -> _Tree:
        ranges, children = [(0, pieces)], []
        for start, stop in ranges:  # grows while it is gone through
            middle = (start + stop) // 2
            children.append((len(ranges), len(ranges) + 1) if stop - start > 1 else (-1, -1))
            ranges += [(start, middle), (middle, stop)] if stop - start > 1 else []
        of = np.repeat(np.arange(pieces), points)
        members = np.array([(start <= of) & (of < stop) for start, stop in ranges])
        return cls(np.array(children), members, np.array([start for start, _ in ranges]))


class _Ranges:
    """Upper bounds for whole ranges of pieces: |f + Σ c_k|² ≤ |f|² + Σ max(|c_k|² + 2fᵀc_k) + 2 Σ max c_kᵀc_l."""

    def __init__(self, fixed: Array, curves: list[BezierCurve]) -> None:
        self.curves = curves
        points = [c.control.reshape(-1, len(fixed)) for c in curves]
        middles = [p.mean(axis=0) for p in points]
        base, points = fixed + sum(middles), [p - m for p, m in zip(points, middles, strict=True)]
        self.trees = [_Tree.over(len(c.left), c.control.shape[1]) for c in curves]
        self.fixed = float(base @ base)
        self.own = [
            _largest(t.members, np.sum(p**2, axis=1) + 2 * p @ base) for t, p in zip(self.trees, points, strict=True)
        ]
        self.pairs = {
            (k, m): _largest_of_pairs(self.trees[k].members, self.trees[m].members, 2 * points[k] @ points[m].T)
            for k, m in itertools.combinations(range(len(curves)), 2)
        }

    def worth_a_look(self, search: _BoxSearch, boxes: int) -> list[_Boxes]:
        """Return the boxes of single pieces that may hold more than is known."""
        front, found = np.zeros((1, len(self.curves)), dtype=np.intp), list[_Boxes]()
        while len(front):
            upper = self._bounds(front)
            worth = search.worthwhile(upper)
            front, upper = front[worth], upper[worth]
            search.looked += len(front)
            if search.looked > boxes:
                search.closed = max(search.closed, float(upper.max()))
                return found
            single = np.all([t.children[f, 0] < 0 for t, f in zip(self.trees, front.T, strict=True)], axis=0)
            if single.any():
                found += self._boxes(front[single], upper[single]).batches()
            front = self._cut(front[~single])
        return found

    def _bounds(self, front: NDArray[np.intp]) -> Array:
        upper = np.full(len(front), self.fixed)
        for own, at in zip(self.own, front.T, strict=True):
            upper += own[at]
        for (k, m), table in self.pairs.items():
            upper += table[front[:, k], front[:, m]]
        return upper

    def _cut(self, front: NDArray[np.intp]) -> NDArray[np.intp]:
        """Cut each combination of ranges along the axis where its range has most pieces."""
        sizes = np.array([t.members[f].sum(axis=1) for t, f in zip(self.trees, front.T, strict=True)])
        longest = sizes.argmax(axis=0) if len(front) else np.zeros(0, dtype=np.intp)
        halves = []
        for half in (0, 1):
            part = front.copy()
            for k, tree in enumerate(self.trees):
                mine = longest == k
                part[mine, k] = tree.children[front[mine, k], half]
            halves.append(part)
        return np.concatenate(halves)

    def _boxes(self, front: NDArray[np.intp], upper: Array) -> _Boxes:
        pieces = []
        for curve, tree, at in zip(self.curves, self.trees, front.T, strict=True):
            pieces.append(BezierCurve(*(part[tree.piece[at]] for part in curve)))
        return _Boxes(upper, pieces)


def _largest(members: NDArray[np.bool_], values: Array) -> Array:
    """Return the largest value of each range.  members : (n, p); values : (p, ...)."""
    return np.array([values[mine].max(axis=0) for mine in members])


def _largest_of_pairs(one: NDArray[np.bool_], other: NDArray[np.bool_], table: Array) -> Array:
    return _largest(other, _largest(one, table).T).T


def _lengths(fixed: Array, pieces: list[BezierCurve]) -> tuple[Array, Array]:
    """Return for each box an upper bound of the squared length (b,), and that at its corners (b, 2^q)."""
    count = len(pieces[0].left)
    shape, ends = [count], [slice(None)]
    total = np.full(count, float(fixed @ fixed)).reshape(-1, *[1] * len(pieces))
    for k, piece in enumerate(pieces):
        own = np.sum(piece.control**2, axis=2) + 2 * piece.control @ fixed
        total = total + own.reshape(count, *[1] * k, -1, *[1] * (len(pieces) - k - 1))
        shape, ends = [*shape, own.shape[1]], [*ends, slice(None, None, own.shape[1] - 1)]
    for k, m in itertools.combinations(range(len(pieces)), 2):
        products = 2 * pieces[k].control @ pieces[m].control.transpose(0, 2, 1)
        sizes = [shape[i + 1] if i in (k, m) else 1 for i in range(len(pieces))]
        total = total + products.reshape(count, *sizes)
    return total.reshape(count, -1).max(axis=1), total[tuple(ends)].reshape(count, -1)


def _place(pieces: list[BezierCurve], box: int, corner: int) -> Array:
    """Return the coordinates (q,) of a corner of a box."""
    ends = list(itertools.product((0, 1), repeat=len(pieces)))[corner]
    return np.array([piece.right[box] if end else piece.left[box] for piece, end in zip(pieces, ends, strict=True)])


def _halved(boxes: _Boxes) -> _Boxes:
    """Return both halves of every box, cut where its control points spread most (de Casteljau)."""
    spread = np.array([np.linalg.norm(np.diff(p.control, axis=1), axis=2).sum(axis=1) for p in boxes.pieces])
    cut, pieces = spread.argmax(axis=0), []
    for axis, piece in enumerate(boxes.pieces):
        halves = [BezierCurve(*(np.where(_like(cut == axis, h), h, p) for h, p in zip(half, piece, strict=True)))
                  for half in _split(piece)]  # fmt: skip
        pieces.append(BezierCurve(*(np.concatenate(both) for both in zip(*halves, strict=True))))
    return _Boxes(np.concatenate([boxes.upper] * 2), pieces)


def _like(mask: NDArray[np.bool_], values: Array) -> NDArray[np.bool_]:
    return mask.reshape(-1, *[1] * (values.ndim - 1))


def _split(piece: BezierCurve) -> tuple[BezierCurve, BezierCurve]:
    middle, rest = (piece.left + piece.right) / 2, piece.control
    first, second = [rest[:, 0]], [rest[:, -1]]
    while rest.shape[1] > 1:
        rest = (rest[:, 1:] + rest[:, :-1]) / 2
        first.append(rest[:, 0])
        second.append(rest[:, -1])
    lower = BezierCurve(piece.left, middle, np.stack(first, axis=1))
    return lower, BezierCurve(middle, piece.right, np.stack(second[::-1], axis=1))
