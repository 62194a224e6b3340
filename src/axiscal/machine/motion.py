"""How a machine goes from place to place while measuring: what moves together, from which side, for how long.

Axes of one family go together along a straight line from rest to rest, X Y Z first, then U V W, P Q R, and A B C: so
a feed means the same on every control, and rotary axes turn while the slides stand. A long turn is made in parts,
since a control may take the short way round where an axis has no end. An axis that would not come to its place over at
least its overrun from the side that counts first goes past it. Plans, records and programs all go by these rules.
"""

from __future__ import annotations

import math

import numpy as np

from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.numerics import Array

FAMILIES = ("XYZ", "UVW", "PQR", "ABC")
"""Letters that one feed counts for; LinuxCNC takes a feed for XYZ alone when U moves too."""
LARGEST_TURN = math.radians(120.0)
_SLACK = 1e-9
"""Rounding of a position, m or rad."""


def family_groups(machine: Machine) -> tuple[tuple[int, ...], ...]:
    """Return the axes that move together, by index, group after group."""
    groups = [tuple(k for k, axis in enumerate(machine.axes) if axis.letter in family) for family in FAMILIES]
    return tuple(group for group in groups if group)


def turn_parts(largest: Array) -> Array:
    """Return in how many parts moves are made.  largest : rad, the largest turn in each of them"""
    parts: Array = np.maximum(np.ceil(largest / LARGEST_TURN - _SLACK), 1.0)
    return parts


def travel_seconds(machine: Machine, start: Array, stop: Array) -> Array:
    """Return the time of moves, group after group.  start, stop : (..., q) m or rad; returns (...,).

    A straight move whose axes keep their speeds and accelerations takes 1/v + v/a with v = min v_k/d_k and
    a = min a_k/d_k, or 2/√a where it is too short for that speed.
    """
    distance = np.abs(np.asarray(stop) - np.asarray(start))
    total = np.zeros(distance.shape[:-1])
    for group in family_groups(machine):
        axes, moved = [machine.axes[k] for k in group], distance[..., list(group)]
        turns = moved[..., [axis.rotary for axis in axes]].max(axis=-1, initial=0.0)
        parts = turn_parts(turns)
        total += parts * _straight_seconds(axes, moved / parts[..., None])
    return total


def _straight_seconds(axes: list[Axis], moved: Array) -> Array:
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
    place: Array = np.where(wrong, stop - approach * overrun, stop)
    return place


def approach_seconds(machine: Machine, start: Array, stop: Array, approach: Array) -> Array:
    """Return the time of moves that arrive from the stated sides.  approach : (..., q) of +1, −1, 0 for any side."""
    past = turning(machine, start, stop, approach)
    return travel_seconds(machine, start, past) + travel_seconds(machine, past, stop)


def inward(axis: Axis, position: float, side: int) -> float:
    """Return the position, or the nearest one that leaves room to come to it from a side over the whole overrun.

    side : +1, −1, or 0 for any.  The travel of a full turn has ends as well: programs stay within it.
    """
    if side == 0:
        return position
    low, high = axis.travel
    nearest = low + axis.overrun if side > 0 else high - axis.overrun
    return position if side * (position - nearest) >= -_SLACK else nearest
