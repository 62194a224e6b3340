"""A virtual machine behind a control: it is commanded to one place and sent to another."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from axiscal.compensation.effect import Control
from axiscal.machine.kinematics import frames
from axiscal.numerics import Array
from axiscal.simulation import VirtualMachine

Sent = Callable[[Array, Array], Array]
"""(commands (m, q), approaches (m, q)) -> where the axes are sent, (m, q), m or rad."""


@dataclass(frozen=True, eq=False, slots=True)
class CommandedMachine(VirtualMachine):
    """The machine as an instrument sees it that knows the commands only.  sent : what its control makes of them."""

    sent: Sent = field(kw_only=True)

    @classmethod
    def behind(cls, truth: VirtualMachine, sent: Sent) -> CommandedMachine:
        """Return the machine of a truth behind a control."""
        return cls(truth.model, truth.curves, truth.offsets, truth.drifts, sent=sent)

    @classmethod
    def corrected(cls, truth: VirtualMachine, control: Control) -> CommandedMachine:
        """Return the machine behind a control that adds to commands."""
        return cls.behind(truth, lambda poses, approaches: poses + control(poses, approaches))

    def deviation(self, poses: Array, approaches: Array) -> Array:
        """Return the TCP deviation from the command, workpiece frame, (m, 3), m.  poses : commands (m, q)."""
        sent, machine = self.sent(poses, approaches), self.model.machine
        shift: Array = frames(machine, sent).tcp - frames(machine, poses).tcp
        return shift + VirtualMachine.deviation(self, sent, approaches)

    def rotation(self, poses: Array, approaches: Array) -> Array:
        """Return the orientation deviation from the command, (m, 3), rad, to first order in what the control adds."""
        sent, nominal = self.sent(poses, approaches), frames(self.model.machine, poses).rotations
        turned = VirtualMachine.rotation(self, sent, approaches)
        for k, axis in enumerate(self.model.machine.axes):
            if axis.rotary:
                turned = turned + (sent[:, k] - poses[:, k])[:, None] * (nominal[k] @ np.array(axis.direction))
        return turned
