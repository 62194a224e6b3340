"""How far the exact chain can be from its first order, for any machine whose errors are not larger than stated.

As a distance: with Θ = Σ_k (|ε_k| + 2 |tilt_k|), D = Σ_k |δ_k| and L the largest of the |r_k| and of the travels from
zero

    |remainder| ≤ (e^Θ − 1 − Θ) L + (e^Θ − 1) D

since every term of the expansion beyond the first order is a product of at least two of these motions. L comes from
intervals: the tool point seen from each axis, a rotary axis turning as far as it likes.

Along x, y and z: every factor of the chain is a power series in the errors. Replaced by the absolute values of its
entries, with each error at its size, it majorises: term by term no machine has more. What the product of these
majorants has beyond its first order is the bound. It is kept apart from the orders below all the way, so that nothing
cancels.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import Box
from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import tool_point
from axiscal.numerics import Array


def linear_to(model: ErrorModel, sizes: Array, box: Box) -> float:
    """Return the bound on the remainder of a TCP deviation, m.

    sizes : (terms,) m or rad, what no term exceeds; box : bounds per axis, m or rad
    """
    displaced, turned, tilted = motion_sizes(model, sizes)
    theta = float(np.sum(np.linalg.norm(turned, axis=1) + 2 * np.linalg.norm(tilted, axis=1)))
    shifts = float(np.sum(np.linalg.norm(displaced, axis=1)))
    return (math.expm1(theta) - theta) * longest_arm(model.machine, box) + math.expm1(theta) * shifts


def motion_sizes(model: ErrorModel, sizes: Array) -> tuple[Array, Array, Array]:
    """Return what no displacement, rotation and tilt of an axis exceeds, (axes, 3) each.  sizes : as above"""
    count = len(model.machine.axes)
    displaced, turned, tilted = (np.zeros((count, 3)) for _ in range(3))
    for term, size in zip(model.terms, sizes.tolist(), strict=True):
        straight = term.kind == "location" and not model.machine.axes[term.axis].rotary
        part = tilted if straight else turned if term.angular else displaced
        part[term.axis, term.component % 3] += size / 2 if term.kind == "reversal" else size
    return displaced, turned, tilted


def longest_arm(machine: Machine, box: Box) -> float:
    """Return a length that no arm from an axis frame to the TCP, and no travel from zero, exceeds in the box, m."""
    low = high = tool_point(machine)
    longest = 0.0
    for axis, (start, stop) in reversed(list(zip(machine.axes, box, strict=True))):
        if axis.rotary:
            origin = np.array(axis.origin)
            low, high = low - origin, high - origin
            longest = max(longest, _farthest(low, high))
            low, high = _turned(low, high, np.array(axis.direction))
            longest = max(longest, _farthest(low, high))
            low, high = low + origin, high + origin
            continue
        longest = max(longest, _farthest(low, high), abs(start), abs(stop))
        ways = np.outer([start, stop], np.array(axis.direction))
        low, high = low + ways.min(axis=0), high + ways.max(axis=0)
        longest = max(longest, _farthest(low, high))
    return longest


def _farthest(low: Array, high: Array) -> float:
    return float(np.linalg.norm(np.maximum(np.abs(low), np.abs(high))))


def _turned(low: Array, high: Array, direction: Array) -> tuple[Array, Array]:
    """Return a box around a box that turns about a direction through the origin."""
    across = _farthest(low, high)
    if np.max(np.abs(direction)) < 1 - 1e-12:
        return np.full(3, -across), np.full(3, across)
    along = np.abs(direction) > 0.5
    across = _farthest(np.where(along, 0.0, low), np.where(along, 0.0, high))
    return np.where(along, low, -across), np.where(along, high, across)


_TERMS = 24
"""Of the series of the exponential: the last one of an angle of a radian is below 1e-23."""


class _Series(NamedTuple):
    """Order zero, order one and all beyond of a motion's majorant, (4, 4) each, entries not negative."""

    nominal: Array
    first: Array
    beyond: Array

    def then(self, other: _Series) -> _Series:
        """Return the product, this one before the other."""
        return _Series(
            self.nominal @ other.nominal,
            self.nominal @ other.first + self.first @ other.nominal,
            self.nominal @ other.beyond
            + self.first @ (other.first + other.beyond)
            + self.beyond @ (other.nominal + other.first + other.beyond),
        )


def linear_along(model: ErrorModel, sizes: Array, box: Box, counted: tuple[bool, bool, bool]) -> float:
    """Return the bound on the remainder of a TCP deviation along the directions that count, m.

    sizes : (terms,) m or rad, what no term exceeds; box : bounds per axis, m or rad
    """
    whole = linear_to(model, sizes, box)
    return whole if all(counted) else min(whole, float(np.linalg.norm(linear_ways(model, sizes, box)[list(counted)])))


def linear_ways(model: ErrorModel, sizes: Array, box: Box) -> Array:
    """Return the bounds along x, y and z, (3,) m; arguments as for `linear_along`."""
    displaced, turned, tilted = motion_sizes(model, sizes)
    found = _still(np.eye(4))
    for axis, (start, stop), shift, turn, tilt in zip(model.machine.axes, box, displaced, turned, tilted, strict=True):
        travel = _travel(axis, max(abs(start), abs(stop)), tilt)
        before, after = _rotary(axis) if axis.rotary else (travel, _still(np.eye(4)))
        small = _shifted(shift).then(_turned_by(turn))
        if axis.workpiece_side:
            before, after = after, before
            small = _turned_by(turn).then(_shifted(shift))
        if axis.rotary:
            before = _still(_moved(np.abs(np.array(axis.origin)))).then(before)
            after = after.then(_still(_moved(np.abs(np.array(axis.origin)))))
        found = found.then(before).then(small).then(after)
    point = np.append(np.abs(tool_point(model.machine)), 1.0)
    bound: Array = (found.beyond @ point)[:3]
    return bound


def _rotary(axis: Axis) -> tuple[_Series, _Series]:
    """Return nothing, and a turn by any angle."""
    across = np.abs(np.array(axis.direction)) < 0.5
    turn = np.eye(4)
    turn[:3, :3] = np.where(np.outer(across, across), 1.0, np.eye(3))
    return _still(np.eye(4)), _still(turn)


def _travel(axis: Axis, far: float, tilt: Array) -> _Series:
    along = np.append(far * np.abs(np.array(axis.direction)), 0.0)
    parts = [np.eye(4), np.zeros((4, 4)), np.zeros((4, 4))]
    for part, order in zip(parts, _turned_by(tilt), strict=True):
        part[:3, 3] = (order @ along)[:3]
    return _Series(*parts)


def _shifted(shift: Array) -> _Series:
    return _Series(np.eye(4), _moved(shift) - np.eye(4), np.zeros((4, 4)))


def _turned_by(turn: Array) -> _Series:
    """Return the majorant of the exponential of any turn whose components are not larger."""
    a, b, c = turn.tolist()
    first, beyond = np.zeros((4, 4)), np.zeros((4, 4))
    first[:3, :3] = [[0, c, b], [c, 0, a], [b, a, 0]]
    power = first
    for order in range(2, _TERMS):
        power = power @ first / order
        beyond = beyond + power
    return _Series(np.eye(4), first, beyond)


def _moved(way: Array) -> Array:
    motion = np.eye(4)
    motion[:3, 3] = way
    return motion


def _still(motion: Array) -> _Series:
    return _Series(motion, np.zeros((4, 4)), np.zeros((4, 4)))
