"""How far the exact chain can be from its first order along x, y and z, for any machine within stated sizes.

Every factor of the chain is a power series in the errors. Replaced by the absolute values of its entries, with each
error at its size, it majorises: term by term no machine has more. What the product of these majorants has beyond its
first order is the bound. It is kept apart from the orders below all the way, so that nothing cancels.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from axiscal.errors.linear_bound import linear_to, motion_sizes
from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import Box
from axiscal.machine.axis import Axis
from axiscal.machine.kinematics import tool_point
from axiscal.numerics import Array

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
        small = _shifted(shift).then(_turned(turn))
        if axis.workpiece_side:
            before, after = after, before
            small = _turned(turn).then(_shifted(shift))
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
    for part, order in zip(parts, _turned(tilt), strict=True):
        part[:3, 3] = (order @ along)[:3]
    return _Series(*parts)


def _shifted(shift: Array) -> _Series:
    return _Series(np.eye(4), _moved(shift) - np.eye(4), np.zeros((4, 4)))


def _turned(turn: Array) -> _Series:
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
