"""The largest ratio N/D over a plane, enclosed by branch and bound: N and D polynomials of both coordinates in between.

On a rectangle a polynomial lies between its smallest and its largest Bernstein coefficient (Garloff 1986), and at the
corners it is its coefficient there. So N/D is at most the largest ratio of their coefficients. The search quarters
boxes that may exceed the best known value until none is left (`largest`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from axiscal.numerics import Array
from axiscal.numerics.bernstein import bernstein
from axiscal.numerics.chebyshev import nodes
from axiscal.numerics.largest import Boxes, halves, largest, some

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
    found = largest(search, patches, upper, boxes, _BATCH)
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
