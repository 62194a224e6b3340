"""The way that an axis runs on, as a level sees it whose feet stand on it: the slope (w(t+L/2) − w(t−L/2))/L.

w is how the TCP would be displaced by the straightness and the squareness of this axis alone. A level that does not
ride on the carriage cannot see its rotations, its reversal, or any other axis.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from axiscal.errors.model import ErrorModel, Term
from axiscal.errors.plane import PlaneError
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import frames
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array

_HALF = 0.5
"""Geometry: both feet, half a base away."""


class Foot(NamedTuple):
    """The place of a foot from the middle of the base, m, and the weight of its height, 1/m."""

    shift: float
    weight: float


def feet(base: float) -> tuple[Foot, Foot]:
    """Return the feet of a base.  base : m, above zero"""
    return Foot(base / 2, 1 / base), Foot(-base / 2, -1 / base)


def across(machine: Machine, setup: Setup, poses: Array) -> Array:
    """Return d × a, a the way along which the axis goes: the direction whose slope is a turn about d, (m, 3)."""
    (axis,) = setup.moves
    along = frames(machine, poses).rotations[axis] @ np.array(machine.axes[axis].direction)
    result: Array = np.cross(np.array(setup.direction), along)
    return result


def moved(poses: Array, axis: int, shift: float) -> Array:
    """Return poses (m, q) with one axis further by a shift, m or rad."""
    further = poses.copy()
    further[:, axis] += shift
    return further


def belongs(function: Term, axis: int) -> bool:
    """Return whether an error is one of the way's shape: straightness, alone or with another axis, or squareness."""
    return axis in function.axes and (
        function.kind == "location" or (function.kind == "motion" and not function.angular)
    )


class Way:
    """What the errors do to the slope of one set-up's chord."""

    def __init__(self, errors: ErrorModel, setup: Setup, base: float) -> None:
        self._errors, self._setup, self._base = errors, setup, base
        (self.axis,) = setup.moves
        self.functions = [i for i, f in enumerate(errors.terms) if belongs(f, self.axis)]

    def levers(self, poses: Array) -> Array:
        """Return what a unit of each error does, (terms, m): of a straightness, of one end; of a squareness."""
        result = np.zeros((len(self._errors.terms), len(poses)))
        direction = across(self._errors.machine, self._setup, poses)
        ends = [self._displaced(poses, direction, shift) for shift in (_HALF, -_HALF)]
        for i in self.functions:
            tilt = self._errors.terms[i].kind == "location"
            result[i] = (ends[0][i] - ends[1][i]) if tilt else ends[0][i]
        return result

    def rows(self, poses: Array) -> Array:
        """Return the rows of readings, (m, size): a chord, or the derivative where the base has no length."""
        result, levers = np.zeros((len(poses), self._errors.size)), self.levers(poses)
        for i in self.functions:
            function = self._errors.terms[i]
            tilt = function.kind == "location"
            shape = function.rows(function.coordinates(poses)) if tilt else self._slopes(function, poses)
            result[:, function.columns] = levers[i][:, None] * shape
        return result

    def _slopes(self, function: Term, poses: Array) -> Array:
        if self._base == 0:
            at = function.coordinates(poses)
            if isinstance(function, PlaneError):
                return function.slopes(at, self.axis)
            return function.basis.rows(at, derivative=1)
        ends = (function.coordinates(moved(poses, self.axis, foot.shift)) for foot in feet(self._base))
        front, back = (foot.weight * function.rows(at) for foot, at in zip(feet(self._base), ends, strict=True))
        return front + back

    def _displaced(self, poses: Array, direction: Array, shift: float) -> Array:
        displaced: Array = np.einsum("fmc,mc->fm", self._errors.levers(moved(poses, self.axis, shift)), direction)
        return displaced
