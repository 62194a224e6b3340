"""How a machine goes from place to place while measuring: what moves together, from which side, for how long.

Axes of one family go together along a straight line from rest to rest: X Y Z first, then U V W, P Q R, and A B C. So a
feed means the same on every control, and rotary axes turn while the slides stand. A long turn is made in parts, since a
control may take the short way round where an axis has no end. An axis that would not come to its place over at least
its overrun from the side that counts first goes past it. `Driving` says what goes clear before others move. Plans,
records and programs all go by these rules.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.numerics import Array
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine

FAMILIES = ("XYZ", "UVW", "PQR", "ABC")
"""Letters that one feed counts for; LinuxCNC takes a feed for XYZ alone when U moves too."""


@dataclass(frozen=True, slots=True)
class Driving:
    """The content of `[programs]` in a campaign; left out, nothing goes clear.

    clearance : name of the axis that goes clear before others move, with its coordinate, m or rad
    dwell : at a reading the program waits the reading time, instead of stopping until somebody presses start
    """

    clearance: tuple[str, float] | None = None
    dwell: bool = False


USUAL = Driving()


def move_groups(machine: Machine) -> tuple[tuple[int, ...], ...]:
    """Return the axes that move together, by index, group after group."""
    groups = [tuple(k for k, axis in enumerate(machine.axes) if axis.letter in family) for family in FAMILIES]
    return tuple(group for group in groups if group)


LARGEST_TURN = math.radians(120.0)
_SLACK = 1e-9
"""Rounding of a position, m or rad."""


def turn_parts(largest: Array) -> Array:
    """Return in how many parts moves are made.  largest : rad, the largest turn in each of them"""
    return np.maximum(np.ceil(largest / LARGEST_TURN - _SLACK), 1.0)


def travel_seconds(machine: Machine, start: Array, stop: Array) -> Array:
    """Return the time of moves, group after group.  start, stop : (..., q) m or rad; returns (...,).

    A straight move whose axes keep their speeds and accelerations takes 1/v + v/a with v = min v_k/d_k and
    a = min a_k/d_k, or 2/√a where it is too short for that speed.  A long turn is made in parts.
    """
    start, stop = np.asarray(start), np.asarray(stop)
    total = np.zeros(np.broadcast_shapes(start.shape, stop.shape)[:-1])
    for group in move_groups(machine):
        axes, of = [machine.axes[k] for k in group], (..., list(group))
        moved = np.abs(stop[of] - start[of])
        parts = turn_parts(moved[..., [axis.rotary for axis in axes]].max(axis=-1, initial=0.0))
        total += parts * straight_seconds(axes, moved / parts[..., None])
    return total


def straight_seconds(axes: Sequence[Axis], moved: Array) -> Array:
    """Return the time of straight moves from rest to rest, (...,) s.  moved : (..., axes) m or rad"""
    slowness = (moved / np.array([axis.speed for axis in axes])).max(axis=-1)
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
        first = travel_seconds(machine, start, past)
    else:
        past, first = _over(machine, start, stop, approach, driving)
    return first + travel_seconds(machine, past, stop)


def _over(machine: Machine, start: Array, stop: Array, approach: Array, driving: Driving) -> tuple[Array, Array]:
    """Return where moves turn, and the time until there with the axis of the clearance clear while others move."""
    clear = _cleared(machine, start, driving)
    direct = turning(machine, start, stop, approach)
    apart = _others_move(machine, start, direct, driving)
    past = np.where(apart[..., None], turning(machine, clear, stop, approach), direct)
    above = _cleared(machine, past, driving)
    ways = (start, clear), (clear, above), (above, past)
    over = sum(travel_seconds(machine, begin, end) for begin, end in ways)
    return past, np.where(apart, over, travel_seconds(machine, start, past))


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
