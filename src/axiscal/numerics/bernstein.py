"""The largest value of a polynomial over boxes, enclosed by branch and bound with its Bernstein coefficients.

On a box a polynomial lies between its smallest and its largest Bernstein coefficient (Garloff 1986), and at the corners
it is its coefficient there. The search halves boxes that may exceed the best known value, across the coordinate along
which the coefficients change most, until none is left.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import comb
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array
from axiscal_core.roots import nodes

Boxes = tuple[Array, ...]
"""What is known of many boxes: arrays (b, ...), of which each has one row."""


def some(boxes: Boxes, which: NDArray[np.intp] | NDArray[np.bool_]) -> Boxes:
    """Return some of the boxes."""
    return tuple(part[which] for part in boxes)


def joined(parts: list[Boxes]) -> Boxes:
    """Return several as one."""
    return parts[0] if len(parts) == 1 else tuple(np.concatenate(each) for each in zip(*parts, strict=True))


def halves(coefficients: Array, axis: int) -> tuple[Array, Array]:
    """Return the Bernstein coefficients of both halves along one of their axes (de Casteljau)."""
    rest = np.moveaxis(coefficients, axis, 0)
    first, last = [rest[0]], [rest[-1]]
    while len(rest) > 1:
        rest = (rest[1:] + rest[:-1]) / 2
        first.append(rest[0])
        last.append(rest[-1])
    return np.moveaxis(np.array(first), 0, axis), np.moveaxis(np.array(last[::-1]), 0, axis)


def _worth(bounded: Boxes, least: float, closed: float) -> tuple[float, Boxes]:
    """Return the largest bound that was set aside, and the boxes that may hold more than the least, bounds first."""
    worth = bounded[0] > least
    return max(closed, float(bounded[0][~worth].max(initial=0.0))), some(bounded, worth)


def _batches(bounded: Boxes, batch: int) -> list[Boxes]:
    """Return boxes a few at a time, those that may hold most first.  bounded : bounds, then boxes"""
    order = np.argsort(-bounded[0], kind="stable")
    return [some(bounded, order[start : start + batch]) for start in range(0, len(order), batch)]


Heights = Callable[[Array], Array]
"""Places (m, d) -> values there, (m,)."""

BOXES = 200_000
"""Boxes after which the search gives up; the bound holds wherever it ends, it is then only larger."""
_ROUNDING = 1e-8
"""Rounding of coefficients of degree 18, with room: added to the bound."""
_NUMBERS = 4e7
"""Coefficients of the boxes that are looked at: of memory, as for boxes."""
_NEAR = 400_000
"""Coefficients of boxes that are looked at at once: of memory, not of the result."""
_PLACES = 50_000
"""Places at which values are found at once: of memory, not of the result."""
_LOOKS = 64
"""Boxes at which polynomials of a degree are compared with the values; a wrong degree shows in almost all."""


class Patches(NamedTuple):
    """Polynomials over boxes.

    low, high : (b, d) ends; coefficients : of Bernstein, by box and coordinate
    places : (b, d) the best of those from which they were found; heights : (b,) there
    """

    low: Array
    high: Array
    coefficients: Array
    places: Array
    heights: Array


class Enclosure(NamedTuple):
    """The largest value lies between lower, that at the place (d,), and upper.  boxes : so many were looked at"""

    lower: float
    upper: float
    place: Array
    boxes: int


def bernstein(degree: int, t: Array) -> Array:
    """Return the Bernstein polynomials of a degree at t (m,): (m, degree + 1)."""
    return np.stack([comb(degree, k) * t**k * (1 - t) ** (degree - k) for k in range(degree + 1)], axis=1)


def patches(heights: Heights, low: Array, high: Array, degree: tuple[int, ...]) -> Patches:
    """Return values as polynomials over boxes, found from as many places in each as they have coefficients.

    low, high : (b, d) ends of boxes; degree : along each coordinate, 0 where a box has no width
    """
    unit = np.stack([g.ravel() for g in np.meshgrid(*(_inner(each) for each in degree), indexing="ij")], axis=1)
    places = (low[:, None] + (high - low)[:, None] * unit).reshape(-1, len(degree))
    parts = [heights(places[start : start + _PLACES]) for start in range(0, len(places), _PLACES)]
    values, every = np.concatenate(parts).reshape(len(low), -1), np.arange(len(low))
    best = values.argmax(axis=1)
    at = places.reshape(len(low), -1, len(degree))[every, best]
    shape = (len(low), *(each + 1 for each in degree))
    return Patches(low, high, _coefficients(values.reshape(shape), degree), at, values[every, best])


def misfit(heights: Heights, found: Patches) -> float:
    """Return by which share of the largest value polynomials miss values a quarter into boxes."""
    boxes = some(found[:3], np.unique(np.linspace(0, len(found.low) - 1, _LOOKS).astype(np.intp)))
    for axis in 2 * tuple(range(boxes[0].shape[1])):
        boxes = _halved(boxes, np.full(len(boxes[0]), axis))[0]
    _, high, coefficients = boxes
    value = heights(high)
    return float(np.max(np.abs(coefficients.reshape(len(high), -1)[:, -1] - value)) / np.max(np.abs(value)))


def largest_value(found: Patches, known: float, gap: float) -> Enclosure:
    """Enclose the largest value over boxes; what is still open in the end counts with a bound of its own.

    known : a value that is reached somewhere, or asked for; nothing that is above it by no more than a share of it,
        the gap, is followed
    """
    each, best, place = found.coefficients[0].size, known, found.low[0]
    most, batch = min(BOXES, int(_NUMBERS / each)), max(1, int(_NEAR / each))
    bounds, best, place = _looked(found[:3], best, place)
    waiting, looked, closed = _batches((bounds, *found[:3]), batch), 0, 0.0
    while waiting and looked < most:
        waiting.sort(key=lambda each: float(each[0][0]))
        chosen = [waiting.pop()]
        while waiting and sum(len(each[0]) for each in [*chosen, waiting[-1]]) <= batch:
            chosen.append(waiting.pop())
        closed, (_, *worth) = _worth(joined(chosen), best * (1 + gap), closed)
        looked += len(worth[0])
        if not len(worth[0]):
            continue
        parts = joined(_split(tuple(worth)))
        bounds, best, place = _looked(parts, best, place)
        closed, worthy = _worth((bounds, *parts), best * (1 + gap), closed)
        waiting += _batches(worthy, batch)
    upper = max([best, closed, *(float(each[0][0]) for each in waiting)])
    return Enclosure(best, upper * (1 + _ROUNDING), place, looked)


def _looked(boxes: Boxes, best: float, place: Array) -> tuple[Array, float, Array]:
    """Return what boxes may hold at most, (b,), and the best value with its place, after a look at all corners.

    boxes : low, high (b, d), Bernstein coefficients
    """
    low, high, coefficients = boxes
    corners = coefficients[:, *(slice(None, None, max(size - 1, 1)) for size in coefficients.shape[1:])]
    box, *ends = np.unravel_index(int(corners.argmax()), corners.shape)
    if corners[box, *ends] > best:
        best, place = float(corners[box, *ends]), np.where(np.array(ends) == 1, high[box], low[box])
    return coefficients.max(axis=tuple(range(1, coefficients.ndim))), best, place


def _split(boxes: Boxes) -> list[Boxes]:
    """Return both halves of every box, cut across the coordinate along which the coefficients change most."""
    *_, whole = boxes
    axes = range(1, whole.ndim)
    ways = [np.abs(np.diff(whole, axis=k)).sum(axis=k).reshape(len(whole), -1).max(axis=1) for k in axes]
    return _halved(boxes, np.argmax(ways, axis=0))


def _halved(boxes: Boxes, across: Array) -> list[Boxes]:
    """Return both halves of boxes.  across : (b,) the coordinate that is cut"""
    first, second = ([part.copy() for part in boxes] for _ in range(2))
    for axis in np.unique(across).tolist():
        mine = np.flatnonzero(across == axis)
        middle = (boxes[0][mine, axis] + boxes[1][mine, axis]) / 2
        first[1][mine, axis] = second[0][mine, axis] = middle
        first[2][mine], second[2][mine] = halves(boxes[2][mine], axis + 1)
    return [tuple(first), tuple(second)]


def _inner(degree: int) -> Array:
    """Return as many places between nought and one as a polynomial of a degree has coefficients."""
    return np.asarray((1 + nodes(degree + 1)) / 2, dtype=np.float64)


@cache
def _to_coefficients(degree: int) -> Array:
    """Return the matrix from values at these places to Bernstein coefficients, (degree + 1, degree + 1)."""
    return np.asarray(np.linalg.inv(bernstein(degree, _inner(degree))), dtype=np.float64)


def _coefficients(values: Array, degree: tuple[int, ...]) -> Array:
    """Return Bernstein coefficients from values at the inner places, (b, n₁, …, n_d) each."""
    for axis, each in enumerate(degree, start=1):
        values = np.moveaxis(np.tensordot(_to_coefficients(each), values, (1, axis)), 0, axis)
    return np.ascontiguousarray(values)
