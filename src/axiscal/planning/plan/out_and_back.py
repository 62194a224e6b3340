"""The way of a set-up that moves one axis: out along it and back again, twice, so that no drift looks like a curve.

Read once along, a zero that moves steadily by 10 µm is a slope of 10 µm, and nothing contradicts it. Read out and back,
it is the difference of the two ways (ISO 230-2 reads so, too). If the side counts, the way out reads one side and the
way back the other: neither then turns round before a place.

A drift that comes and goes is the same on both ways, and looks like an error of the curve. So a second round reads
every other place of a side. The common part of both rounds may be the curve, and the difference cannot.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.description import Machine
from axiscal.measurement.place import Places
from axiscal.measurement.setup import Setup
from axiscal.measurement.travel import way_seconds
from axiscal.numerics import Array

_LONGER = 1e-9
"""s; rounding of a time."""
_FEWEST = 8
"""Of fewer readings there is no second round: each of four ways has two."""


def returns(setup: Setup) -> bool:
    """Whether a set-up is read out and back: where one axis moves."""
    return setup.chart is None and len(setup.moves) == 1


def out_and_back(
    machine: Machine, setup: Setup, places: Places, counted: Array, here: Array | None, before: Array
) -> Places:
    """Return the readings of such a set-up out and back, in two rounds.

    counted : (m, q) approaches, 0 where any side will do; here : (q,) where the machine stands if it is mounted
    before : (t, 2 q) poses and approaches, as counted, of its readings that are taken already
    """
    (k,) = setup.moves
    side, told = places.poses.shape[1] + k, _told(setup, counted[:, k]) is not None
    before = before[before[:, side] != 0] if told else before
    rows = np.concatenate([before, np.column_stack([places.poses, counted])])
    rises, second = (each[len(before) :] for each in _ways(rows[:, k], rows[:, side] if told else None))
    along, order = np.argsort(places.poses[:, k], kind="stable"), np.zeros(0, dtype=np.intp)
    for part in (~second, second):
        out, back = along[(part & rises)[along]], along[(part & ~rises)[along]][::-1]
        stands = places.poses[order[-1]] if len(order) else here
        order = np.concatenate([order, _shorter(machine, setup, places, counted, out, back, stands)])
    return places.within(order)


def beside(setup: Setup, counted: Array, places: Places, counted_before: Array, before: Places) -> Places:
    """Return readings in the order of an earlier way, those that are not on it beside the nearest ones of their side.

    counted : (m, q) approaches, 0 where any side will do; counted_before : (t, q) those of the earlier way
    Readings of a side that is not on it leave all as they come.
    """
    (k,) = setup.moves
    told, at = _told(setup, counted[:, k]), places.poses[:, k]
    sides = np.zeros(len(places)) if told is None else told
    rows = np.column_stack([places.poses, counted]).tolist()
    way = list[int]()
    for row in np.column_stack([before.poses, counted_before]).tolist():
        way += [index for index, each in enumerate(rows) if each == row and index not in way][:1]
    for index in np.setdiff1d(np.arange(len(places)), way).tolist():
        alike = [place for place, other in enumerate(way) if sides[other] == sides[index]]
        if not alike:
            return places
        near = min(alike, key=lambda place: (abs(at[way[place]] - at[index]), place))
        beyond = bool(at[index] >= at[way[near]])
        way.insert(near + (_rises_at(at[way], sides[way], near) == beyond), index)
    return places.within(np.array(way, dtype=np.intp))


def _rises_at(at: Array, sides: Array, index: int) -> bool:
    """Whether a way rises where it comes to a reading: from below it does, and where no side says as it goes on."""
    if sides[index] != 0:
        return bool(sides[index] > 0)
    start, stop = (index, index + 1) if index + 1 < len(at) else (max(index - 1, 0), index)
    return bool(at[stop] >= at[start])


def _told(setup: Setup, sides: Array) -> Array | None:
    """Return from which side places are come to, (m,); None where that does not say on which way."""
    return sides if len(setup.sides) > 1 and np.all(sides != 0) else None


def _ways(at: Array, sides: Array | None) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which readings are taken on a way that rises, and which in the second round, (m,) each.

    at : (m,) m or rad along the axis; sides : (m,) from where it comes; None where the way is free
    """
    rank = np.empty(len(at), dtype=np.intp)
    rank[np.lexsort([at] if sides is None else [at, sides])] = np.arange(len(at))
    if sides is None:
        few = len(at) < _FEWEST
        return (rank // (1 if few else 2)) % 2 == 0, (rank % 2 == 1) & (not few)
    from_above = int(np.sum(sides < 0))
    rank -= np.where(sides > 0, from_above, 0)
    few = min(from_above, len(at) - from_above) < _FEWEST // 2
    return sides > 0, (rank % 2 == 1) & (not few)


def _shorter(
    machine: Machine,
    setup: Setup,
    places: Places,
    counted: Array,
    out: NDArray[np.intp],
    back: NDArray[np.intp],
    here: Array | None,
) -> NDArray[np.intp]:
    """Return the shorter of both ways round, the rising one if equal, (m,); out, back : readings in either order."""
    ways = [np.concatenate(way) for way in ((out, back), (back, out))]
    if not len(ways[0]):
        return ways[0]
    first, second = (_seconds(machine, setup, places.within(way), counted[way], here) for way in ways)
    return ways[int(second < first - _LONGER)]


def _seconds(machine: Machine, setup: Setup, places: Places, counted: Array, here: Array | None) -> float:
    start = np.concatenate([places.poses[:1] if here is None else here[None], places.poses])[:-1]
    return float(way_seconds(machine, setup, start, places.poses, counted).sum())
