"""The machine as it is and not to first order: deviations by the exact chain, and levers at the actual frames."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from axiscal.errors.model import ErrorModel
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import Deviation, actual_deviation, tool_motion
from axiscal.machine.motion_effects import motion_effects
from axiscal.numerics import Array
from axiscal.numerics.rigid import Motion

_POSES = 8000
"""At once: of memory, not of the result."""


class ActualLevers(NamedTuple):
    """Derivatives by the value of each term at a machine with errors.

    straight : (terms, m, 3) of the TCP, m or m/rad; angular : (terms, m, 3) of the tool's turn
    """

    straight: Array
    angular: Array


def deviation_of(model: ErrorModel, coefficients: Array, poses: Array, approaches: Array) -> Deviation:
    """Return how the tool deviates by the exact chain.  coefficients : (size,); poses, approaches : (m, q)."""
    return actual_deviation(model.machine, poses, model.small_motions(coefficients, poses, approaches))


def deviations_of(model: ErrorModel, machines: Array, poses: Array, approaches: Array) -> Iterator[Deviation]:
    """Yield the same of many machines at the same poses.  machines : (n, size) of coefficients; poses : (m, q)"""
    at_once = max(_POSES // max(len(poses), 1), 1)
    rows = [term.rows(term.coordinates(poses)) for term in model.terms]
    for start in range(0, len(machines), at_once):
        some = machines[start : start + at_once]
        values = [own @ some[:, term.columns].T for own, term in zip(rows, model.terms, strict=True)]
        shape = len(model.terms), len(poses), len(some)
        moved = np.array(values).reshape(shape).swapaxes(1, 2).reshape(shape[0], -1)
        small = model.compose(moved, np.tile(approaches, (len(some), 1)))
        done = actual_deviation(model.machine, np.tile(poses, (len(some), 1)), small)
        straight, turned = (part.reshape(len(some), len(poses), 3) for part in done)
        yield from (Deviation(*each) for each in zip(straight, turned, strict=True))


def levers_at(model: ErrorModel, coefficients: Array, poses: Array) -> ActualLevers:
    """Return the levers of each term where the errors have moved the frames to; reversals at their middle.

    coefficients : (size,); poses : (m, q)
    """
    small = model.small_motions(coefficients, poses, np.zeros_like(poses))
    effects = motion_effects(model.machine, poses, small)
    straight, angular = (np.zeros((len(model.terms), len(poses), 3)) for _ in range(2))
    for i, term in enumerate(model.terms):
        at, along = term.axis, term.component % 3
        if term.kind == "location" and not model.machine.axes[at].rotary:
            straight[i] = effects.tilt[at, :, :, along]
        elif term.angular:
            straight[i], angular[i] = effects.rotation[at, :, :, along], effects.turn[at, :, :, along]
        else:
            straight[i] = effects.displacement[at, :, :, along]
    return ActualLevers(straight, angular)


class MovedErrors(ErrorModel):
    """The same errors with levers at the frames of a machine that is as believed, for what is known of it.

    point : (size,) where that is
    """

    def __init__(self, machine: Machine, point: Array) -> None:
        super().__init__(machine)
        self.point = point

    def levers(self, poses: Array) -> Array:
        """Return the TCP deviation per unit of each term, (terms, m, 3), m or m/rad.  poses : (m, q)."""
        return levers_at(self, self.point, poses).straight

    def levers_of(self, terms: Sequence[int], poses: Array) -> Array:
        """Return those of some terms alone, (those, m, 3)."""
        return self.levers(poses)[list(terms)]

    def angular_levers(self, poses: Array) -> Array:
        """Return the rotation of the tool relative to the workpiece per unit of each term, (terms, m, 3)."""
        return levers_at(self, self.point, poses).angular

    def motion(self, poses: Array) -> Motion:
        """Return orientation and TCP of the tool.  poses : (m, q)"""
        return tool_motion(self.machine, poses, self.small_motions(self.point, poses, np.zeros_like(poses)))
