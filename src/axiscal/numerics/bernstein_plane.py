"""The largest ratio N/D over a plane, enclosed by branch and bound: N and D polynomials of both coordinates in between.

On a rectangle a polynomial lies between its smallest and its largest Bernstein coefficient (Garloff 1986), and at the
corners it is its coefficient there. With b the best ratio known, a box on which no coefficient of N − b (1 + τ) D is
above zero holds nothing better; the others are quartered (de Casteljau) until none is left.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array
from axiscal.numerics.bernstein import bernstein
from axiscal.numerics.chebyshev import nodes

PlaneForms = Callable[[Array], tuple[Array, Array]]
"""Places (m, 2) -> N and D there, each (m,), D above zero."""

_TAU = 1e-6
"""By so much more than the best that is known nothing is."""
_BATCH = 4096
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


class _Patches(NamedTuple):
    """Rectangles.  low, high : (b, 2); above, below : Bernstein coefficients of N and D, (b, n, m)."""

    low: Array
    high: Array
    above: Array
    below: Array

    def chosen(self, which: NDArray[np.intp] | NDArray[np.bool_]) -> _Patches:
        """Return some of them."""
        return _Patches(*(part[which] for part in self))


@dataclass(eq=False, slots=True)
class _PlaneSearch:
    """best, place : the best ratio so far and where; upper : what boxes that were given up may hold."""

    best: float
    place: Array
    upper: float = 0.0
    looked: int = 0

    def look(self, patches: _Patches) -> _Patches:
        """Return the quarters of those that may hold more, after a look at their corners."""
        self.looked += len(patches.low)
        self._corners(patches)
        rise = patches.above - self.best * (1 + _TAU) * patches.below
        left = patches.chosen(rise.reshape(len(rise), -1).max(axis=1) > 0)
        return _quartered(left)

    def _corners(self, patches: _Patches) -> None:
        ratios = patches.above[:, :: patches.above.shape[1] - 1, :: patches.above.shape[2] - 1]
        ratios = ratios / patches.below[:, :: patches.below.shape[1] - 1, :: patches.below.shape[2] - 1]
        box, x, y = np.unravel_index(int(ratios.argmax()), ratios.shape)
        if ratios[box, x, y] > self.best:
            self.best = float(ratios[box, x, y])
            self.place = np.where([x == 1, y == 1], patches.high[box], patches.low[box])

    def give_up(self, patches: _Patches) -> None:
        """Count what boxes may hold: their largest N over their smallest D, where that is known to be above zero."""
        above, below = patches.above.max(axis=(1, 2)), patches.below.min(axis=(1, 2))
        ratios = np.where(below > 0, above / np.where(below > 0, below, 1.0), np.inf)
        self.upper = max(self.upper, float(ratios.max(initial=0.0)))


def largest_ratio(
    forms: PlaneForms, breaks: tuple[Array, Array], degree: tuple[int, int], known: float = 0.0, boxes: int = _BOXES
) -> Enclosure:
    """Enclose the largest ratio over a rectangle.

    breaks : along both coordinates, ends included, increasing; between them N and D are polynomials of this degree
    known : a ratio that is reached somewhere; nothing that is no better than it, by τ, is followed
    boxes : how many to look at; what is then still open counts with a bound of its own
    """
    patches = _patches(forms, breaks, degree)
    search = _PlaneSearch(known, np.array([breaks[0][0], breaks[1][0]]))
    waiting = _batches(patches)
    while waiting:
        if search.looked > boxes:
            for each in waiting:
                search.give_up(each)
            break
        waiting += _batches(search.look(waiting.pop()))
    return Enclosure(search.best, max(search.best * (1 + _TAU), search.upper), search.place, search.looked)


def _batches(patches: _Patches) -> list[_Patches]:
    """Return the rectangles a few at a time."""
    cuts = range(0, len(patches.low), _BATCH)
    return [_Patches(*(part[start : start + _BATCH] for part in patches)) for start in cuts]


def misfit(forms: PlaneForms, breaks: tuple[Array, Array], degree: tuple[int, int]) -> float:
    """Return by which share of the largest D and N polynomials of this degree miss them a quarter into rectangles."""
    patches = _patches(forms, breaks, degree)
    some = patches.chosen(np.unique(np.linspace(0, len(patches.low) - 1, _LOOKS).astype(np.intp)))
    quarter = _split(_split(_split(_split(some, 0)[0], 0)[0], 1)[0], 1)[0]
    true = forms(quarter.high)
    pairs = zip((quarter.above[:, -1, -1], quarter.below[:, -1, -1]), true, strict=True)
    return max(float(np.max(np.abs(found - value)) / np.max(np.abs(value))) for found, value in pairs)


def _patches(forms: PlaneForms, breaks: tuple[Array, Array], degree: tuple[int, int]) -> _Patches:
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
    return _Patches(lows, highs, above, below)


def _quartered(patches: _Patches) -> _Patches:
    """Return the four quarters of every rectangle."""
    return _joined([quarter for half in _split(patches, 0) for quarter in _split(half, 1)])


def _joined(parts: list[_Patches]) -> _Patches:
    return _Patches(*(np.concatenate(each) for each in zip(*parts, strict=True)))


def _split(patches: _Patches, axis: int) -> tuple[_Patches, _Patches]:
    """Return both halves along an axis (de Casteljau)."""
    middle = (patches.low[:, axis] + patches.high[:, axis]) / 2
    low, high = patches.low.copy(), patches.high.copy()
    low[:, axis], high[:, axis] = middle, middle
    left, right = zip(*(_casteljau(part, axis + 1) for part in (patches.above, patches.below)), strict=True)
    return _Patches(patches.low, high, *left), _Patches(low, patches.high, *right)


def _casteljau(coefficients: Array, axis: int) -> tuple[Array, Array]:
    """Return the coefficients of both halves along an axis of (b, n, m)."""
    rest = np.moveaxis(coefficients, axis, 0)
    first, last = [rest[0]], [rest[-1]]
    while len(rest) > 1:
        rest = (rest[1:] + rest[:-1]) / 2
        first.append(rest[0])
        last.append(rest[-1])
    return np.moveaxis(np.array(first), 0, axis), np.moveaxis(np.array(last[::-1]), 0, axis)
