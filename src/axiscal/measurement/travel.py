"""How long the ways between readings take: from place to place, or off a ball and back to it.

The way that an axis runs on, as a level sees it whose feet stand on it: the slope (w(t+L/2) − w(t−L/2))/L.

w is how the TCP would be displaced by the straightness and the squareness of this axis alone. A level that does not
ride on the carriage cannot see its rotations, its reversal, or any other axis.
"""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.kinematics import drawn_back
from axiscal.machine.motion import approach_seconds, straight_seconds
from axiscal.measurement.charts.room import Chart
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.numerics.short_way import route
from axiscal_core.machine import Machine
from axiscal_core.terms import Term

SHORTEST = 1e-4
"""Stands for a base without length, m: the slope of so short a chord is that of the curve."""


class Foot(NamedTuple):
    """One of the places of which readings show a sum: poses (m, q), and its weight, 1/m under a level."""

    poses: Array
    weight: float


def feet_of(setup: Setup, poses: Array) -> tuple[Foot, ...]:
    """Return of which places readings show a sum: of two feet, of both ends of a length, or of their own.

    poses : (m, q)
    """
    if setup.start is not None:
        return Foot(poses, 1.0), Foot(np.tile(setup.start, (len(poses), 1)), -1.0)
    if setup.base is None:
        return (Foot(poses, 1.0),)
    base, (axis,) = max(setup.base, SHORTEST), setup.moves
    ends = ((poses + sign * base / 2 * (np.arange(poses.shape[1]) == axis), sign / base) for sign in (1.0, -1.0))
    return tuple(Foot(*end) for end in ends)


def belongs(function: Term, axis: int) -> bool:
    """Return whether an error is one of the way's shape: straightness, alone or with another axis, or squareness."""
    return axis in function.axes and (
        function.kind == "location" or (function.kind == "motion" and not function.angular)
    )


_ASIDE = 1e-9
"""m or rad: rounding of an axis that does not move."""


def way_seconds(machine: Machine, setup: Setup, start: Array, stop: Array, approach: Array) -> Array:
    """Return the time of ways in one set-up.

    start, stop : (..., q) m or rad; approach : (..., q) from where each axis comes, +1, −1, 0 for any side
    """
    if setup.contact != "retracted":
        return approach_seconds(machine, start, stop, approach, setup.driving)
    away = np.any(np.asarray(start) != np.asarray(stop), axis=-1)
    off, above = (_drawn_back(machine, np.asarray(each), setup.retract) for each in (start, stop))
    there = approach_seconds(machine, off, above, approach, setup.driving)
    # off a ball and back all linear axes may have to go, and the slowest one says how long
    linear = [axis for axis in machine.axes if not axis.rotary]
    return there + np.where(away, 2 * straight_seconds(linear, np.full(len(linear), setup.retract)), 0.0)


def _drawn_back(machine: Machine, poses: Array, far: float) -> Array:
    """Return poses (..., q) drawn back along the tool, between which a program goes; themselves where none is."""
    flat = poses.reshape(-1, poses.shape[-1])
    drawn = drawn_back(machine, flat, far)
    return np.where(np.isfinite(drawn), drawn, flat).reshape(poses.shape)


def sides_of(chart: Chart, there: Array, approach: Array) -> Array:
    """Return from which side each coordinate is come to, (m, size): what brings most axes from where they come.

    there : (m, size) u; approach : (m, q) +1, −1, 0 of the axes
    """
    away = np.array([each.overrun for each in chart.coordinates])
    choices = np.array(list(product((1.0, -1.0), repeat=len(away))))
    here = np.nan_to_num(chart.poses(there))
    ways = [here - np.nan_to_num(chart.poses(there - choice * away)) for choice in choices]
    agreed = np.stack([np.sum(np.where(np.abs(way) > _ASIDE, np.sign(way), 0.0) * approach, axis=1) for way in ways])
    sides = np.where(away > 0, choices[agreed.argmax(axis=0)], 0.0)
    return np.where(np.any(approach != 0, axis=1)[:, None], sides, 0.0)


def reading_seconds(setup: Setup) -> float:
    """Return what one reading takes beside the way to it."""
    return setup.settle + setup.reading_time


def short_way(
    machine: Machine, setup: Setup, poses: Array, approaches: Array, first: Array | None = None
) -> tuple[NDArray[np.intp], Array]:
    """Return an order of poses of a set-up, (m,), and the seconds from each to the next, overrun included, (m - 1,).

    approaches : (m, q), 0 where any side will do; first : (m,) seconds to each from where the machine stands
    """
    table = way_seconds(machine, setup, poses[:, None], poses[None], approaches[None])
    order = route(table, first)
    return order, table[order[:-1], order[1:]]
