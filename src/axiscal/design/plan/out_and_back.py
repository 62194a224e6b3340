"""The way of a set-up that moves one axis: out along it and back again, so that a drift does not look like a curve.

Read once along, a zero that moves steadily by 10 µm is a slope of 10 µm, and nothing contradicts it. Read out and back,
it is the difference of the two ways (ISO 230-2 reads so, too). Where the side counts, one side is read on the way out
and the other on the way back: neither way then turns round before a place.

What comes and goes on the way is the same on both ways, and looks like an error of the curve: a place that is read once
more, or was read before this way, comes after it, and shows that.
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


def returns(setup: Setup) -> bool:
    """Whether a set-up is read out and back: where one axis moves."""
    return setup.chart is None and len(setup.moves) == 1


def out_and_back(
    machine: Machine, setup: Setup, places: Places, counted: Array, here: Array | None, before: Array
) -> Places:
    """Return the readings of such a set-up out and back, and then, the same way, those of places once more.

    counted : (m, q) approaches, 0 where any side will do; here : (q,) where the machine stands if it is mounted
    before : (t, 2 q) poses and approaches, as counted, of its readings that are taken already
    """
    order = np.zeros(0, dtype=np.intp)
    for part in repeats(np.column_stack([places.poses, counted]), before):
        stands = places.poses[order[-1]] if len(order) else here
        order = np.concatenate([order, part[_both_ways(machine, setup, places.within(part), counted[part], stands)]])
    return places.within(order)


def repeats(rows: Array, before: Array | None = None) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the first readings of all places, and those of a place once more, which was read before perhaps.

    rows : (m, p) poses and approaches; before : (t, p) of those that are taken already
    """
    seen, first = {tuple(row) for row in ([] if before is None else before.tolist())}, []
    for row in rows.tolist():
        first.append(tuple(row) not in seen)
        seen.add(tuple(row))
    new = np.array(first, dtype=bool)
    return np.flatnonzero(new), np.flatnonzero(~new)


def _both_ways(machine: Machine, setup: Setup, places: Places, counted: Array, here: Array | None) -> NDArray[np.intp]:
    """Return the shorter of both ways round, the rising one if equal, (m,); arguments as of `out_and_back`.

    Of readings of one side the rising way and the falling one: that side may be come from on either.
    """
    at, sides = places.poses[:, setup.moves[0]], counted[:, setup.moves[0]]
    along = np.argsort(at, kind="stable")
    rises = _rises(setup, along, sides)
    out, back = along[rises[along]], along[~rises[along]][::-1]
    ways = (
        [np.concatenate(way) for way in ((out, back), (back, out))] if len(out) and len(back) else [along, along[::-1]]
    )
    if not len(along):
        return along
    first, second = (_seconds(machine, setup, places.within(way), counted[way], here) for way in ways)
    return ways[int(second < first - _LONGER)]


def _rises(setup: Setup, along: NDArray[np.intp], sides: Array) -> NDArray[np.bool_]:
    """Return which readings are taken on the way that rises, (m,): those from below, or every other one."""
    if len(setup.sides) > 1 and np.all(sides != 0):
        rising: NDArray[np.bool_] = sides > 0
        return rising
    rising = np.zeros(len(along), dtype=bool)
    rising[along[::2]] = True
    return rising


def _seconds(machine: Machine, setup: Setup, places: Places, counted: Array, here: Array | None) -> float:
    start = np.concatenate([places.poses[:1] if here is None else here[None], places.poses])[:-1]
    return float(way_seconds(machine, setup, start, places.poses, counted).sum())
