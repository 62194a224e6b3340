"""The way of a set-up that moves one axis: out along it and back again, so that a drift does not look like a curve.

Read once along, a zero that moves steadily by 10 µm is a slope of 10 µm, and nothing contradicts it. Read out and back,
it is the difference of the two ways (ISO 230-2 reads so, too). Where the side counts, one side is read on the way out
and the other on the way back: neither way then turns round before a place.
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


def out_and_back(machine: Machine, setup: Setup, places: Places, counted: Array, here: Array | None) -> Places:
    """Return the readings of such a set-up in the order of the shorter of both ways round, the rising one if equal.

    counted : (m, q) approaches, 0 where any side will do; here : (q,) where the machine stands if it is mounted
    """
    at, sides = places.poses[:, setup.moves[0]], counted[:, setup.moves[0]]
    along = np.argsort(at, kind="stable")
    rises = _rises(setup, along, sides)
    out, back = along[rises[along]], along[~rises[along]][::-1]
    ways = [np.concatenate(way) for way in ((out, back), (back, out))]
    first, second = (_seconds(machine, setup, places.within(way), counted[way], here) for way in ways)
    return places.within(ways[int(second < first - _LONGER)])


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
