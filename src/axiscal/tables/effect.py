"""What a control with tables does to the TCP over the volume: the deviation that is known before and after.

A control is a function from commands to how far beyond them it sends each axis. Whatever its tables look like, that
is all they can do.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from axiscal.errors.volume import EVERY_WAY, Box, Counted
from axiscal.estimation.accuracy.alignment import Alignment
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import frames
from axiscal.measurement.simulation import VirtualMachine
from axiscal.numerics import Array
from axiscal.tables.table import CompensationTable
from axiscal.units import format_quantity

Sent = Callable[[Array, Array], Array]
"""(commands (m, q), approaches (m, q)) -> where the axes are sent, (m, q), m or rad."""

Deviation = Callable[[Array, Array], Array]
"""(poses (m, q), approaches (m, q)) -> TCP deviation (m, 3), m."""

Control = Callable[[Array, Array], Array]
"""(commands (m, q), approaches (m, q)) -> what is added to the command of each axis, (m, q), m or rad."""

_HELD = 0.9
"""Share from which a plane counts as held: a mesh of straight lines leaves some of a bend."""


def added_by(whole: Control, part: Control) -> Control:
    """Return what a control adds beyond what a part of it does."""

    def control(poses: Array, approaches: Array) -> Array:
        beyond: Array = whole(poses, approaches) - part(poses, approaches)
        return beyond

    return control


class Effect(NamedTuple):
    """RMS of the TCP deviation over the volume, m, before and after the tables, less what no one counts (`rms`)."""

    before: float
    after: float


def effect_of_control(
    machine: Machine,
    deviation: Deviation,
    control: Control,
    poses: Array,
    box: Box,
    alignment: Alignment | None = None,
    counted: Counted = EVERY_WAY,
) -> Effect:
    """Return what a control leaves of a deviation.

    poses : (m, q) spread over the volume; each is approached from alternating directions
    alignment : what probing the part takes off; counted : the directions in which deviations count
    The axes go to where the control sends them, and the machine deviates there.
    """
    inside, approaches = tour(poses, box)
    found, left = deviation(inside, approaches), left_by(machine, deviation, control, inside, approaches)
    if alignment is not None:
        found, left = (alignment.left(inside, each) for each in (found, left))
    return Effect(rms(found, counted), rms(left, counted))


def tour(poses: Array, box: Box) -> tuple[Array, Array]:
    """Return the poses inside the box, and alternating directions from which they are approached."""
    inside = np.clip(poses, *np.array(box).T)
    approaches = np.where(np.arange(len(poses))[:, None] % 2 == 0, 1.0, -1.0) * np.ones_like(poses)
    return inside, approaches


def left_by(machine: Machine, deviation: Deviation, control: Control, poses: Array, approaches: Array) -> Array:
    """Return the TCP deviation (m, 3) that is left when the control sends the axes elsewhere."""
    sent = poses + control(poses, approaches)
    shifted: Array = frames(machine, sent).tcp - frames(machine, poses).tcp
    left: Array = shifted + deviation(sent, approaches)
    return left


def by_linear_axes(machine: Machine) -> Callable[[Array, Array], Array]:
    """Return what takes TCP deviations (m, 3) at poses (m, q) away by the linear axes alone, (m, q), m.

    [u_x u_y u_z] Δ = -δp.  Raises TableError when there are not three linear axes.
    """
    linear = [k for k, axis in enumerate(machine.axes) if not axis.rotary]
    if len(linear) != 3:
        remedy = "volumetric compensation needs three"
        raise TableError("the machine has {count} linear axes", remedy, count=len(linear))

    def added(poses: Array, deviation: Array) -> Array:
        rotations = frames(machine, poses).rotations
        moves = np.stack([rotations[k] @ np.array(machine.axes[k].direction) for k in linear], axis=2)
        found = np.zeros_like(poses)
        found[:, linear] = -np.linalg.solve(moves, deviation[:, :, None])[:, :, 0]
        return found

    return added


def table_control(machine: Machine, tables: Sequence[CompensationTable]) -> Control:
    """Return the control that takes the deviations of tables away exactly as they say."""

    def control(poses: Array, approaches: Array) -> Array:
        added = np.zeros_like(poses)
        for table in tables:
            over = machine.index(table.over)
            forward, reverse = (table.deviation(poses[:, over], side) for side in (1, -1))
            added[:, machine.index(table.axis)] -= np.where(approaches[:, over] > 0, forward, reverse)
        return added

    return control


def rms(deviation: Array, counted: Counted = EVERY_WAY) -> float:
    """Return the RMS of TCP deviations (m, 3), their constant part taken off, m: that is the workpiece's zero.

    counted : the directions in which they count
    """
    centred = (deviation - deviation.mean(axis=0))[:, list(counted)]
    return float(np.sqrt(np.mean(np.sum(centred**2, axis=1))))


def planes_left(estimate: Estimate, control: Control, poses: Array, approaches: Array) -> str:
    """Return in a sentence what files leave of errors of two axes; empty where they hold them, or there are none.

    poses, approaches : (m, q) spread over the volume
    """
    errors = estimate.model
    if not errors.planes:
        return ""
    levers = errors.levers(poses)
    levers[: len(errors.functions)] = 0.0
    own = np.stack([errors.along(levers[:, :, c], poses, approaches) @ estimate.mean for c in range(3)], axis=1)
    shape = own - own.mean(axis=0)
    found = left_by(estimate.machine, estimate.deviation, control, poses, approaches)
    held = 1.0 - float(np.sum(shape * found) / max(np.sum(shape**2), np.finfo(float).tiny))
    if held > _HELD:
        return ""
    names = ", ".join(plane.name for plane in errors.planes)
    size = format_quantity(rms(own), "um", 3)
    most = "" if held < 1 - _HELD else " Part of it is held."
    return f"what two axes do together ({names}: {size} RMS over the volume): no table over one axis holds it.{most}"


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
