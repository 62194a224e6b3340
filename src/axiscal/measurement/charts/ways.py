"""Ways through a chart: straight in u, or one coordinate after the other, or round, where all of it can be taken."""

from __future__ import annotations

from itertools import permutations

import numpy as np

from axiscal.measurement.charts.clear import clear
from axiscal.measurement.charts.room import Room
from axiscal.measurement.charts.roundabout import way_round
from axiscal.measurement.charts.swing import Swinging
from axiscal.numerics import Array

_MOST_LEGS = 3
"""Coordinates up to which all orders of going one after the other are tried."""


def way(chart: Swinging, room: Room, start: Array, stop: Array) -> Array | None:
    """Return a way from place to place of a chart, (k, size), its ends included; None where there is none of these."""
    straight = np.stack([start, stop])
    if clear(chart, room, straight):
        return straight
    turning = np.flatnonzero(start != stop)
    if not 1 < len(turning) <= _MOST_LEGS:
        return None
    for order in permutations(turning.tolist()):
        legs = [start]
        for number in order:
            legs.append(np.where(np.arange(len(start)) == number, stop, legs[-1]))
        if clear(chart, room, np.array(legs)):
            return np.array(legs)
    return way_round(chart, room, start, stop) if chart.feasible(chart.poses(straight)).all() else None
