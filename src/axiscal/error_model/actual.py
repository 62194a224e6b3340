"""The machine as it is and not to first order: deviations by the exact chain, and levers at the actual frames."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from axiscal.error_model.model import ErrorModel
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import Deviation, actual_deviation, tool_motion
from axiscal.machine.motion_effects import motion_effects
from axiscal.numerics import Array
from axiscal.numerics.rigid import Motion


class ActualLevers(NamedTuple):
    """Derivatives by the value of each term at a machine with errors.

    straight : (terms, m, 3) of the TCP, m or m/rad; angular : (terms, m, 3) of the tool's turn
    """

    straight: Array
    angular: Array


def deviation_of(model: ErrorModel, coefficients: Array, poses: Array, approaches: Array) -> Deviation:
    """Return how the tool deviates by the exact chain.  coefficients : (size,); poses, approaches : (m, q)."""
    return actual_deviation(model.machine, poses, model.small_motions(coefficients, poses, approaches))


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

    def angular_levers(self, poses: Array) -> Array:
        """Return the rotation of the tool relative to the workpiece per unit of each term, (terms, m, 3)."""
        return levers_at(self, self.point, poses).angular

    def motion(self, poses: Array) -> Motion:
        """Return orientation and TCP of the tool.  poses : (m, q)"""
        return tool_motion(self.machine, poses, self.small_motions(self.point, poses, np.zeros_like(poses)))
