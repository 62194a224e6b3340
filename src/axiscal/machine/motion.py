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
from dataclasses import dataclass

import numpy as np

from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import said
from axiscal.numerics import Array
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine

FAMILIES = ("XYZ", "UVW", "PQR", "ABC")
"""Letters that one feed counts for; LinuxCNC takes a feed for XYZ alone when U moves too."""
_NEAR = {False: 2e-3, True: math.radians(2.0)}
"""The last millimetres: 2 mm, or 2 deg, are slow where a feed near the place is asked for."""


@dataclass(frozen=True, slots=True)
class Driving:
    """The content of `[programs]` in a campaign; left out, everything is quick and nothing goes clear.

    clearance : name of the axis that goes clear before others move, with its coordinate, m or rad
    order : names of axes that move together, group after group; None: linear axes first, then rotary ones
    feed : m/s, for the last millimetres to a place; a group of rotary axes takes its number of mm/min as deg/min
    dwell : at a reading the program waits the reading time, instead of stopping until somebody presses start
    """

    clearance: tuple[str, float] | None = None
    order: tuple[tuple[str, ...], ...] | None = None
    feed: float | None = None
    dwell: bool = False

    def feed_of(self, rotary: bool) -> float:
        """Return the feed near a place, m/s or rad/s; infinite where none is stated."""
        if self.feed is None:
            return math.inf
        return math.radians(self.feed * 1000) if rotary else self.feed


USUAL = Driving()


def near(axis: Axis) -> float:
    """Return how near to a place an axis goes slow, m or rad: all of its overrun, at least."""
    return max(_NEAR[axis.rotary], axis.overrun)


def move_groups(machine: Machine, driving: Driving = USUAL) -> tuple[tuple[int, ...], ...]:
    """Return the axes that move together, by index, group after group; raises DescriptionError for what cannot be."""
    if driving.order is not None:
        _check(driving.order, machine)
        return tuple(tuple(machine.index(name) for name in group) for group in driving.order)
    groups = [tuple(k for k, axis in enumerate(machine.axes) if axis.letter in family) for family in FAMILIES]
    return tuple(group for group in groups if group)


def _check(order: Sequence[Sequence[str]], machine: Machine) -> None:
    named = [name for group in order for name in group]
    if sorted(named) != sorted(axis.name for axis in machine.axes):
        known = " ".join(axis.name for axis in machine.axes)
        axes, remedy = " ".join(named) or said("no axis"), "Name each of {known} once"
        raise DescriptionError("the order of moves names {axes}", remedy, axes=axes, known=known)
    for group in order:
        if len({family for name in group for family in FAMILIES if machine.axis(name).letter in family}) > 1:
            what = "{axes} are to move together"
            raise DescriptionError(what, "Let X Y Z, U V W and A B C move in groups of their own", axes=" ".join(group))


LARGEST_TURN = math.radians(120.0)
_SLACK = 1e-9
"""Rounding of a position, m or rad."""


def turn_parts(largest: Array) -> Array:
    """Return in how many parts moves are made.  largest : rad, the largest turn in each of them"""
    return np.maximum(np.ceil(largest / LARGEST_TURN - _SLACK), 1.0)


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
    return np.where(there, np.clip(entered, 0.0, 1.0).max(axis=-1, initial=0.0), 1.0)


def _parted_seconds(axes: Sequence[Axis], moved: Array, feed: float = math.inf) -> Array:
    """Return the time of straight moves, long turns in parts.  feed : m/s or rad/s along the way, at the most"""
    turns = moved[..., [axis.rotary for axis in axes]].max(axis=-1, initial=0.0)
    parts = turn_parts(turns)
    return parts * _straight_seconds(axes, moved / parts[..., None], feed)


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
    return np.where(wrong, stop - approach * overrun, stop)


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
