"""The shortest way round: over a lattice of places that can be taken, each to its neighbours (Dijkstra 1959).

Where a straight way leaves the travels, or meets a stem, a way between the same places may lead round it.
"""

from __future__ import annotations

from heapq import heappop, heappush
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.charts.clear import clear
from axiscal.measurement.charts.room import Room
from axiscal.measurement.charts.swing import Swinging
from axiscal.numerics import Array
from axiscal.numerics.remembered import remembered

_PITCH = np.radians(15.0)
"""As coarse as operators type; what a finer lattice would find besides are ways through narrow passes."""
_MOST = 3000
"""Places of a lattice: of memory and time. Three free coordinates have more, and no way round is looked for there."""
_DOORS = 6
"""Places of the lattice, nearest first, that a way tries to enter and leave it by."""


class _Lattice(NamedTuple):
    """places : (n, size) that can be taken; near : of each, the places next to it that a straight way leads to."""

    places: Array
    near: tuple[tuple[int, ...], ...]


def way_round(chart: Swinging, room: Room, start: Array, stop: Array) -> Array | None:
    """Return the shortest way over the lattice, (k, size), its ends included; None where there is none."""
    found = _lattice(chart, room)
    into, out = _doors(found, chart, room, start), _doors(found, chart, room, stop)
    path = _shortest(found, dict(_lengths(found, into, start)), dict(_lengths(found, out, stop)))
    return None if path is None else np.concatenate([start[None], found.places[path], stop[None]])


@remembered
def _lattice(chart: Swinging, room: Room) -> _Lattice:
    values = []
    for number in range(chart.size):
        end = chart.bounds(number)
        count = max(2, round((end.high - end.low) / _PITCH) + 1)
        values.append(np.linspace(end.low, end.high, count))
    shape = tuple(len(each) for each in values)
    if np.prod(shape) > _MOST:
        return _Lattice(np.zeros((0, chart.size)), ())
    grid = np.stack([g.ravel() for g in np.meshgrid(*values, indexing="ij")], axis=1)
    index = np.full(shape, -1)
    taken = np.flatnonzero(chart.feasible(chart.poses(grid)))
    index.ravel()[taken] = np.arange(len(taken))
    near: list[list[int]] = [[] for _ in taken]
    for here, there in _pairs(index):
        if clear(chart, room, grid[taken[[here, there]]]):
            near[here].append(there)
            near[there].append(here)
    return _Lattice(grid[taken], tuple(tuple(each) for each in near))


def _pairs(index: NDArray[np.intp]) -> list[tuple[int, int]]:
    """Return neighbours in a grid of numbers, −1 where there is no place, each pair once."""
    found = []
    for step in product((-1, 0, 1), repeat=index.ndim):
        if step <= (0,) * index.ndim:
            continue
        here = index[tuple(slice(max(0, -s), n - max(0, s)) for s, n in zip(step, index.shape, strict=True))]
        there = index[tuple(slice(max(0, s), n + min(0, s)) for s, n in zip(step, index.shape, strict=True))]
        both = (here >= 0) & (there >= 0)
        found += list(zip(here[both].tolist(), there[both].tolist(), strict=True))
    return found


def _doors(lattice: _Lattice, chart: Swinging, room: Room, place: Array) -> list[int]:
    order = np.argsort(np.linalg.norm(lattice.places - place, axis=1), kind="stable")[:_DOORS]
    return [int(k) for k in order if clear(chart, room, np.stack([place, lattice.places[k]]))]


def _lengths(lattice: _Lattice, doors: list[int], place: Array) -> list[tuple[int, float]]:
    return [(k, float(np.linalg.norm(lattice.places[k] - place))) for k in doors]


def _shortest(lattice: _Lattice, into: dict[int, float], out: dict[int, float]) -> list[int] | None:
    """Return the places of the shortest way from one of the first to one of the last, with what these cost."""
    far, before = dict(into), dict.fromkeys(into, -1)
    queue = [(length, k) for k, length in into.items()]
    queue.sort()
    best, last = np.inf, -1
    while queue and queue[0][0] < best:
        length, here = heappop(queue)
        if length > far[here]:
            continue
        if here in out and length + out[here] < best:
            best, last = length + out[here], here
        for there in lattice.near[here]:
            further = length + float(np.linalg.norm(lattice.places[there] - lattice.places[here]))
            if further < far.get(there, np.inf):
                far[there], before[there] = further, here
                heappush(queue, (further, there))
    if last < 0:
        return None
    path = [last]
    while before[path[-1]] >= 0:
        path.append(before[path[-1]])
    return path[::-1]
