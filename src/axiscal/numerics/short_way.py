"""The order of the readings in one set-up: a short way through all of them, from wherever the machine stands.

Nearest neighbour from several places, then 2-opt and Or-opt until neither helps. With an approach that counts, a move
that would arrive from the wrong side goes past its target and comes back.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array

_STARTS = 4
"""Ways that are tried; the best is taken, within 3 % of the shortest (tests/numerics/test_short_way.py)."""
_KICKS = 12
"""How often parts of a way are exchanged at random, a change that 2-opt and Or-opt cannot make in one step."""
_ROUNDS = 400
"""Kicks, within the work that is allowed; the best way is kept."""
_WORK = 20_000_000
"""Steps of arithmetic: tenths of a second, the same way on every computer."""
_MANY = 160
"""Ways through more places than this are improved only by reversing parts of them."""
_GAIN = 1e-3
"""s; no shorter way is worth less, and rounding is finer: of ways that are equal so far the first is taken."""
_LONGEST_SEGMENT = 3
"""Places that Or-opt moves at once, as usual (Or 1976)."""

Order = NDArray[np.intp]


def route(seconds: Array, first: Array | None = None) -> Order:
    """Return an order (m,) of all places with a short total time; the way is open at its end.

    seconds : (m, m) from row to column, not necessarily symmetric
    first : (m,) seconds to each place from where the machine stands; None: it may begin anywhere
    """
    count = len(seconds)
    begin = np.zeros(count) if first is None else first
    table = np.zeros((count + 1, count + 1))
    table[:count, :count] = seconds
    table[count, :count] = begin
    starts = np.argsort(np.round(begin / _GAIN), kind="stable")[:_STARTS]
    if first is None:
        starts = np.unique(np.linspace(0, count - 1, min(_STARTS, count)).astype(np.intp))
    starts = starts[: max(1, _MANY // count)]
    orders = [_improved(_nearest(table, int(start)), table) for start in starts]
    best = _kicked(orders[_least(np.array([route_seconds(order, table) for order in orders]))], table)
    return np.array(best[1:], dtype=np.intp)


def shortened(seconds: Array, first: Array | None = None) -> Order:
    """Return a shorter order (m,) than the one that places are in, by 2-opt and Or-opt.  Arguments as of `route`"""
    count = len(seconds)
    table = np.zeros((count + 1, count + 1))
    table[:count, :count] = seconds
    table[count, :count] = 0.0 if first is None else first
    return np.array(_improved([count, *range(count)], table)[1:], dtype=np.intp)


def _kicked(order: list[int], table: Array) -> list[int]:
    """Return the way, or a shorter one found by exchanging two neighbouring parts at random and improving that."""
    rng, shortest = np.random.default_rng(0), route_seconds(order, table)
    for _ in range(min(_KICKS, _MANY // len(order) * 2) if len(order) > 4 else 0):
        a, b, c = np.sort(rng.choice(np.arange(1, len(order) + 1), 3, replace=False)).tolist()
        tried = _improved([*order[:a], *order[b:c], *order[a:b], *order[c:]], table)
        if (seconds := route_seconds(tried, table)) < shortest - _GAIN:
            order, shortest = tried, seconds
    return order


def route_seconds(order: list[int], table: Array) -> float:
    """Return the time of a way through all places of a table."""
    return float(sum(table[a, b] for a, b in pairwise(order)))


def _nearest(table: Array, start: int) -> list[int]:
    """Return the way that begins outside, goes to `start` and always to the nearest place left."""
    count = len(table) - 1
    order, left = [count, start], np.ones(count, dtype=bool)
    left[start] = False
    while left.any():
        nearest = _least(np.where(left, table[order[-1], :count], np.inf))
        order.append(nearest)
        left[nearest] = False
    return order


def _improved(order: list[int], table: Array) -> list[int]:
    for _ in range(min(_ROUNDS, _WORK // len(order) ** 2)):
        better = _reversed_part(order, table)
        if better is None and len(order) <= _MANY:
            better = _moved_segment(order, table)
        if better is None:
            return order
        order = better
    return order


def _reversed_part(order: list[int], table: Array) -> list[int] | None:
    """Return the way with its best part reversed (2-opt, minding that times may be one-way); None if none helps."""
    way = np.array(order)
    inner = table[way[:-1], way[1:]], table[way[1:], way[:-1]]
    ahead, back = (np.concatenate([[0.0], np.cumsum(times)]) for times in inner)
    i, k = np.triu_indices(len(way) - 1, 1)
    i, k = i + 1, k + 1
    before, first, last = way[i - 1], way[i], way[k]
    after = np.append(way, way[0])[k + 1]
    open_end = k + 1 == len(way)
    old = table[before, first] + ahead[k] - ahead[i] + np.where(open_end, 0.0, table[last, after])
    new = table[before, last] + back[k] - back[i] + np.where(open_end, 0.0, table[first, after])
    if not len(i) or (old - new).max() <= _GAIN:
        return None
    pick = _least(new - old)
    a, b = int(i[pick]), int(k[pick]) + 1
    return [*order[:a], *order[a:b][::-1], *order[b:]]


def _moved_segment(order: list[int], table: Array) -> list[int] | None:
    """Return the way with up to three places in a row put elsewhere (Or-opt), turned if that is better."""
    best: tuple[float, list[int]] | None = None
    for length in range(1, min(_LONGEST_SEGMENT, len(order) - 2) + 1):
        shorter, gaps = _gains_of_segments(np.array(order), length, table)
        for a, turned in np.argwhere(shorter > _GAIN).tolist():
            gain, at = float(shorter[a, turned]), int(gaps[a, turned])
            if best is None or gain > best[0] + _GAIN:
                segment, rest = order[a + 1 : a + 1 + length], order[: a + 1] + order[a + 1 + length :]
                best = gain, [*rest[: at + 1], *(segment[::-1] if turned else segment), *rest[at + 1 :]]
    return None if best is None else best[1]


def _gains_of_segments(way: Order, length: int, table: Array) -> tuple[Array, Order]:
    """Return by how much a way is shorter with each of its segments in its best gap, and the place before that gap.

    way : (n,); both (n − length, 1 or 2): of the segments from the second place on, as they are and turned
    """
    begins, count = np.arange(1, len(way) - length + 1), len(way) - length
    first, last, before = way[begins], way[begins + length - 1], way[begins - 1]
    saved, inner = table[before, first].copy(), begins[:-1]  # the last segment has nothing behind it
    saved[:-1] += table[last[:-1], way[inner + length]] - table[before[:-1], way[inner + length]]
    places = np.arange(count)
    rest = way[places + length * (places >= begins[:, None])]
    between = table[rest[:, :-1], rest[:, 1:]]
    steps = [(way[begins + i], way[begins + i + 1]) for i in range(length - 1)]
    back = sum((table[y, x] for x, y in reversed(steps)), np.zeros(count))
    back -= sum((table[x, y] for x, y in steps), np.zeros(count))
    shorter, gaps = [], []
    for head, tail, inside in [(first, last, np.zeros(count)), (last, first, back)][: min(length, 2)]:
        added = table[rest, head[:, None]]
        added[:, :-1] += table[tail[:, None], rest[:, 1:]] - between
        at = (added <= added.min(axis=1, keepdims=True) + _GAIN).argmax(axis=1)
        shorter.append(saved - inside - added[places, at])
        gaps.append(at)
    return np.array(shorter).T, np.array(gaps).T


def _least(seconds: Array) -> int:
    """Return the index of the first of the shortest times.  seconds : (n,)"""
    return int((seconds <= seconds.min() + _GAIN).argmax())
