"""How long the ways between readings take: with nothing between, in touch, or off a ball and back to it.

In touch all axes go together with the tool point held, u straight from place to place. Axis k goes as t_k(s), s from 0
to 1. All speeds and accelerations keep v = min_k min(V_k/|t_k'|, √(A_k/2|t_k''|)) and a = min_k A_k/2|t_k'|. The way
takes 1/v + v/a, or 2/√a if it is too short for that speed.

The way that an axis runs on, as a level sees it whose feet stand on it: the slope (w(t+L/2) − w(t−L/2))/L.

w is how the TCP would be displaced by the straightness and the squareness of this axis alone. A level that does not
ride on the carriage cannot see its rotations, its reversal, or any other axis.
"""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.errors.model import ErrorModel
from axiscal.errors.term import Term
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import drawn_back, frames
from axiscal.machine.motion import approach_seconds, travel_seconds
from axiscal.measurement.charts.room import Chart
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.numerics.remembered import remembered
from axiscal.numerics.short_way import route

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


def across(machine: Machine, setup: Setup, poses: Array) -> Array:
    """Return d × a, a the way along which the axis goes: the direction whose slope is a turn about d, (m, 3)."""
    (axis,) = setup.moves
    along = frames(machine, poses).rotations[axis] @ np.array(machine.axes[axis].direction)
    return np.cross(np.array(setup.direction), along)


def belongs(function: Term, axis: int) -> bool:
    """Return whether an error is one of the way's shape: straightness, alone or with another axis, or squareness."""
    return axis in function.axes and (
        function.kind == "location" or (function.kind == "motion" and not function.angular)
    )


def heights(errors: ErrorModel, setup: Setup, poses: Array) -> Array:
    """Return what a unit of each error of the way's shape adds to its height across, at poses, (terms, m)."""
    (axis,) = setup.moves
    own = np.array([belongs(term, axis) for term in errors.terms])
    levers = np.einsum("fmc,mc->fm", errors.levers(poses), across(errors.machine, setup, poses))
    return np.asarray(levers * own[:, None], dtype=np.float64)


def slope_rows(errors: ErrorModel, setup: Setup, poses: Array) -> Array:
    """Return the rows of what feet show, the slope of their chord, (m, size)."""
    rows = np.zeros((len(poses), errors.size))
    for at, weight in feet_of(setup, poses):
        rows += weight * errors.along(heights(errors, setup, at), at, np.zeros_like(at))
    return rows


_ROUNDS = 8
"""Orders that are sought, of time; the shortest of them is taken."""
_SAME = 1e-9
"""s; rounding."""

_SAMPLES = 33
"""Places along a way, for how fast an axis may go there: a way over a part of a turn bends little."""
_ASIDE = 1e-9
"""m or rad: rounding of an axis that does not move."""
_STILL = 1e-12
"""Of an axis that does not move along a way; and no division by nought."""


def way_seconds(
    machine: Machine, setup: Setup, start: Array, stop: Array, approach: Array, straight: bool = False
) -> Array:
    """Return the time of ways in one set-up.

    start, stop : (..., q) m or rad; approach : (..., q) from where each axis comes, +1, −1, 0 for any side
    straight : ways in touch are taken as straight, also where they go one coordinate after the other
    """
    if setup.chart is None or setup.contact == "free":
        return approach_seconds(machine, start, stop, approach, setup.driving)
    if setup.contact == "retracted":
        away = np.any(np.asarray(start) != np.asarray(stop), axis=-1)
        off, above = (_drawn_back(machine, np.asarray(each), setup.retract) for each in (start, stop))
        there = approach_seconds(machine, off, above, approach, setup.driving)
        return there + np.where(away, 2 * off_seconds(machine, setup), 0.0)
    start, stop, approach = np.broadcast_arrays(start, stop, approach)
    here, there, come = (np.ascontiguousarray(each.reshape(-1, each.shape[-1])) for each in (start, stop, approach))
    return _in_touch(machine, setup, setup.chart, here, there, come, straight).reshape(start.shape[:-1])


def _drawn_back(machine: Machine, poses: Array, far: float) -> Array:
    """Return poses (..., q) drawn back along the tool, between which a program goes; themselves where none is."""
    flat = poses.reshape(-1, poses.shape[-1])
    drawn = drawn_back(machine, flat, far)
    return np.where(np.isfinite(drawn), drawn, flat).reshape(poses.shape)


def off_seconds(machine: Machine, setup: Setup) -> float:
    """Return the time of the way off a ball, as the slowest linear axis goes it from rest to rest."""
    axes = [axis for axis in machine.axes if not axis.rotary]
    speed, acceleration = min(axis.speed for axis in axes), min(axis.acceleration for axis in axes)
    far = setup.retract
    if far >= speed**2 / acceleration:
        return far / speed + speed / acceleration
    return float(2 * np.sqrt(far / acceleration))


def _in_touch(
    machine: Machine, setup: Setup, chart: Chart, start: Array, stop: Array, approach: Array, straight: bool
) -> Array:
    """Return the time of ways with the tool point held, over the places from where the sides are come from.

    Each goes over its legs in touch, or off and back where there are none.
    """
    here, there = chart.places(start), chart.places(stop)
    past = there - sides_of(chart, there, approach) * np.array([end.overrun for end in chart.coordinates])
    if straight:
        return held_seconds(machine, chart, here, past) + held_seconds(machine, chart, past, there)
    ways = zip(map(tuple, here.tolist()), map(tuple, past.tolist()), strict=True)
    legs = {way: found for way, each in enumerate(ways) if (found := _legs(chart, *each)) is not None}
    off = np.array([way not in legs for way in range(len(here))], dtype=bool)
    away = travel_seconds(machine, chart.poses(here[off]), chart.poses(past[off]))
    total = held_seconds(machine, chart, past, there)
    total[off] += away + 2 * off_seconds(machine, setup)
    if legs:
        begin, end = (np.concatenate([each[part] for each in legs.values()]) for part in (slice(-1), slice(1, None)))
        of = np.repeat(list(legs), [len(each) - 1 for each in legs.values()])
        total += np.bincount(of, held_seconds(machine, chart, begin, end), len(total))
    return total


@remembered
def _legs(chart: Chart, here: tuple[float, ...], past: tuple[float, ...]) -> Array | None:
    return chart.between(np.array(here), np.array(past))


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


def held_seconds(machine: Machine, chart: Chart, start: Array, stop: Array) -> Array:
    """Return the time of ways straight in u with all axes together, (m,).  start, stop : (m, size)"""
    share = np.linspace(0.0, 1.0, _SAMPLES)[:, None, None]
    places = start + share * (stop - start)
    poses = chart.poses(places.reshape(-1, len(chart.coordinates)))
    return path_seconds(machine, poses.reshape(_SAMPLES, len(start), len(machine.axes)))


def path_seconds(machine: Machine, path: Array) -> Array:
    """Return the time of ways with all axes together, (m,).  path : (s, m, q) poses at even shares of each way"""
    poses, step = np.nan_to_num(path), 1.0 / (len(path) - 1)
    slopes = np.abs(np.gradient(poses, step, axis=0, edge_order=2)).max(axis=0)
    bends = np.abs(np.diff(poses, 2, axis=0)).max(axis=0) / step**2
    speeds, accelerations = np.array([(axis.speed, axis.acceleration) for axis in machine.axes]).T
    fast = np.minimum(speeds / np.maximum(slopes, _STILL), np.sqrt(accelerations / (2 * np.maximum(bends, _STILL))))
    v, a = fast.min(axis=1), (accelerations / (2 * np.maximum(slopes, _STILL))).min(axis=1)
    seconds = np.where(v**2 <= a, 1 / v + v / a, 2 / np.sqrt(a))
    return np.where(slopes.max(axis=1) > _STILL, seconds, 0.0)


def reading_seconds(setup: Setup) -> float:
    """Return what one reading takes beside the way to it."""
    return setup.settle + setup.reading_time


def short_way(
    machine: Machine, setup: Setup, poses: Array, approaches: Array, first: Array | None = None
) -> tuple[NDArray[np.intp], Array]:
    """Return an order of poses of a set-up, (m,), and the seconds from each to the next, overrun included, (m - 1,).

    approaches : (m, q), 0 where any side will do; first : (m,) seconds to each from where the machine stands
    Ways in touch may lead aside, or off and back: those of an order are looked at, what they take is put in, and an
    order is sought anew until all are known.
    """
    table = way_seconds(machine, setup, poses[:, None], poses[None], approaches[None], straight=True)
    best, least = np.zeros(0, dtype=np.intp), np.inf
    for _ in range(_ROUNDS if setup.contact == "held" else 1):
        order = route(table, first)
        here, there = order[:-1], order[1:]
        thought = table[here, there]
        table[here, there] = way_seconds(machine, setup, poses[here], poses[there], approaches[there])
        seconds = float(table[here, there].sum()) + (0.0 if first is None or not len(order) else float(first[order[0]]))
        if not len(best) or seconds < least:
            best, least = order, seconds
        if np.allclose(table[here, there], thought, rtol=0.0, atol=_SAME):
            break
    return best, table[best[:-1], best[1:]]
