"""The largest value of a function over many boxes, enclosed by branch and bound, the boxes that may hold most first.

Each box has an upper bound on its values, and some of its values are known. The search sets a box aside if its bound is
at most a little above the best known value. It splits the others until none is left.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array

Boxes = tuple[Array, ...]
"""What is known of many boxes: arrays (b, ...), of which each has one row."""


class Search(Protocol):
    """A function over boxes, and what has been seen of it."""

    @property
    def known(self) -> float:
        """What is not above this is not followed: the largest value seen, or asked for, and a little."""

    def look(self, boxes: Boxes) -> tuple[Boxes, Array]:
        """Return the boxes that hold places at all, and what each may hold at most, (b,), after a look at values."""

    def split(self, boxes: Boxes) -> list[Boxes]:
        """Return the parts of boxes: the first part of each, the second of each, and so on."""


class Enclosed(NamedTuple):
    """Nothing that was set aside, or is still open, is above upper.  looked : at so many boxes"""

    upper: float
    looked: int


def largest(search: Search, boxes: Boxes, upper: Array, most: int, batch: int) -> Enclosed:
    """Enclose the largest value over boxes.

    upper : (b,) what each may hold at most, ∞ where that is not known; batch : how many to look at at once
    most : how many to look at; those that are then still open count with their bounds
    """
    waiting, looked, closed = _batches((upper, *boxes), batch), 0, 0.0
    while waiting:
        waiting.sort(key=lambda each: float(each[0][0]))
        if looked >= most:
            return Enclosed(max(closed, float(waiting[-1][0][0])), looked)
        chosen = [waiting.pop()]
        while waiting and sum(len(each[0]) for each in [*chosen, waiting[-1]]) <= batch:
            chosen.append(waiting.pop())
        closed, (_, *worth) = _worth(search, joined(chosen), closed)
        looked += len(worth[0])
        if not len(worth[0]):
            continue
        fresh, bounds = search.look(tuple(worth))
        closed, (bounds, *worth) = _worth(search, (bounds, *fresh), closed)
        if len(bounds):
            waiting += _batches(joined([(bounds, *part) for part in search.split(tuple(worth))]), batch)
    return Enclosed(closed, looked)


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


def _worth(search: Search, bounded: Boxes, closed: float) -> tuple[float, Boxes]:
    """Return the largest bound that was set aside, and the boxes that may hold more than is known, bounds first."""
    worth = bounded[0] > search.known
    return max(closed, float(bounded[0][~worth].max(initial=0.0))), some(bounded, worth)


def _batches(bounded: Boxes, batch: int) -> list[Boxes]:
    """Return boxes a few at a time, those that may hold most first.  bounded : bounds, then boxes"""
    order = np.argsort(-bounded[0], kind="stable")
    return [some(bounded, order[start : start + batch]) for start in range(0, len(order), batch)]
