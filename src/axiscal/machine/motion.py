"""How a machine goes from place to place while measuring: what moves together, from which side, for how long.

Axes of one family go together along a straight line from rest to rest: X Y Z first, then U V W, P Q R, and A B C. So a
feed means the same on every control, and rotary axes turn while the slides stand. A long turn is made in parts, since a
control may take the short way round where an axis has no end. An axis that would not come to its place over at least
its overrun from the side that counts first goes past it. `Driving` says in which other order, what goes clear before
others move, and how slow the last millimetres are. Plans, records and programs all go by these rules.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.machine.driving import USUAL, Driving, move_groups, near
from axiscal.numerics import Array

LARGEST_TURN = math.radians(120.0)
_SLACK = 1e-9
"""Rounding of a position, m or rad."""


def turn_parts(largest: Array) -> Array:
    """Return in how many parts moves are made.  largest : rad, the largest turn in each of them"""
    parts: Array = np.maximum(np.ceil(largest / LARGEST_TURN - _SLACK), 1.0)
    return parts


def travel_seconds(
    machine: Machine, start: Array, stop: Array, driving: Driving = USUAL, place: Array | None = None
) -> Array:
    """Return the time of moves, group after group.  start, stop, place : (..., q) m or rad; returns (...,).

    place : of the reading that is gone to, near which moves are slow
    A straight move whose axes keep their speeds and accelerations takes 1/v + v/a with v = min v_k/d_k and
    a = min a_k/d_k, or 2/√a where it is too short for that speed.
    """
    start, stop = np.asarray(start), np.asarray(stop)
    total = np.zeros(np.broadcast_shapes(start.shape, stop.shape)[:-1])
    for group in move_groups(machine, driving):
        axes, of = [machine.axes[k] for k in group], (..., list(group))
        way = stop[of] - start[of]
        if place is None or driving.feed is None:
            total += _parted_seconds(axes, np.abs(way))
            continue
        quick = quick_share([near(axis) for axis in axes], start[of], stop[of], np.asarray(place)[of])[..., None]
        slow = driving.feed_of(axes[0].rotary)
        total += _parted_seconds(axes, quick * np.abs(way)) + _parted_seconds(axes, (1 - quick) * np.abs(way), slow)
    return total


def quick_share(nearness: Sequence[float], start: Array, stop: Array, place: Array) -> Array:
    """Return the share of straight ways (..., n) after which all axes are near the place, (...,); 1 if they never are.

    nearness : (n,) how far each axis may be from there.  |start + s·way − place| ≤ nearness is entered at the largest
    s = (place ∓ nearness − start)/way.
    """
    wide, way = np.asarray(nearness), stop - start
    edge = place - np.sign(way) * wide - start
    entered = np.divide(edge, way, out=np.zeros(np.broadcast(edge, way).shape), where=np.abs(way) > 0)
    there = np.all(np.abs(stop - place) <= wide + _SLACK, axis=-1)
    share: Array = np.where(there, np.clip(entered, 0.0, 1.0).max(axis=-1, initial=0.0), 1.0)
    return share


def _parted_seconds(axes: Sequence[Axis], moved: Array, feed: float = math.inf) -> Array:
    """Return the time of straight moves, long turns in parts.  feed : m/s or rad/s along the way, at the most"""
    turns = moved[..., [axis.rotary for axis in axes]].max(axis=-1, initial=0.0)
    parts = turn_parts(turns)
    seconds: Array = parts * _straight_seconds(axes, moved / parts[..., None], feed)
    return seconds


def _straight_seconds(axes: Sequence[Axis], moved: Array, feed: float) -> Array:
    slowness = (moved / np.array([axis.speed for axis in axes])).max(axis=-1)
    slowness = np.maximum(slowness, np.linalg.norm(moved, axis=-1) / feed)
    sluggishness = (moved / np.array([axis.acceleration for axis in axes])).max(axis=-1)
    cruising = slowness + np.divide(sluggishness, slowness, out=np.zeros_like(slowness), where=slowness > 0)
    seconds: Array = np.where(sluggishness <= slowness**2, cruising, 2 * np.sqrt(sluggishness))
    return seconds


def turning(machine: Machine, start: Array, stop: Array, approach: Array) -> Array:
    """Return where moves turn back to come from the right side: their end, if they come from there anyway.

    start, stop : (..., q) m or rad; approach : (..., q) +1, −1, 0 for any side
    """
    overrun = np.array([axis.overrun for axis in machine.axes])
    wrong = (approach != 0) & ((np.asarray(stop) - np.asarray(start)) * approach < overrun - _SLACK)
    place: Array = np.where(wrong, stop - approach * overrun, stop)
    return place


def approach_seconds(machine: Machine, start: Array, stop: Array, approach: Array, driving: Driving = USUAL) -> Array:
    """Return the time of moves that arrive from the stated sides.  approach : (..., q) of +1, −1, 0 for any side."""
    start, stop, approach = np.broadcast_arrays(start, stop, approach)
    if driving.clearance is None:
        past = turning(machine, start, stop, approach)
        first = travel_seconds(machine, start, past, driving, stop)
    else:
        past, first = _over(machine, start, stop, approach, driving)
    return first + travel_seconds(machine, past, stop, driving, stop)


def _over(machine: Machine, start: Array, stop: Array, approach: Array, driving: Driving) -> tuple[Array, Array]:
    """Return where moves turn, and the time until there with the axis of the clearance clear while others move."""
    clear = _cleared(machine, start, driving)
    direct = turning(machine, start, stop, approach)
    apart = _others_move(machine, start, direct, driving)
    past = np.where(apart[..., None], turning(machine, clear, stop, approach), direct)
    above = _cleared(machine, past, driving)
    ways = (start, clear), (clear, above), (above, past)
    over = sum(travel_seconds(machine, begin, end, driving, stop) for begin, end in ways)
    return past, np.where(apart, over, travel_seconds(machine, start, past, driving, stop))


def _cleared(machine: Machine, places: Array, driving: Driving) -> Array:
    """Return places with the axis of the clearance where it is clear."""
    cleared = np.array(places, dtype=float)
    if driving.clearance is not None:
        name, at = driving.clearance
        cleared[..., machine.index(name)] = at
    return cleared


def _others_move(machine: Machine, start: Array, stop: Array, driving: Driving) -> Array:
    """Return whether an axis moves that is not the one of the clearance, (...,)."""
    own = None if driving.clearance is None else driving.clearance[0]
    others = [k for k, axis in enumerate(machine.axes) if axis.name != own]
    moving: Array = np.any(np.abs(stop[..., others] - start[..., others]) > _SLACK, axis=-1)
    return moving


def inward(axis: Axis, position: float, side: int) -> float:
    """Return the position, or the nearest one that leaves room to come to it from a side over the whole overrun.

    side : +1, −1, or 0 for any.  The travel of a full turn has ends as well: programs stay within it.
    """
    if side == 0:
        return position
    low, high = axis.travel
    nearest = low + axis.overrun if side > 0 else high - axis.overrun
    return position if side * (position - nearest) >= -_SLACK else nearest
