"""What a control with tables does to the TCP over the volume: the deviation that is known before and after.

A control is a function from commands to how far beyond them it sends each axis. Whatever its tables look like, that
is all they can do.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from axiscal.accuracy.alignment import Alignment
from axiscal.compensation.table import CompensationTable
from axiscal.error_model.volume import EVERY_WAY, Box, Counted
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import frames
from axiscal.numerics import Array

Deviation = Callable[[Array, Array], Array]
"""(poses (m, q), approaches (m, q)) -> TCP deviation (m, 3), m."""

Control = Callable[[Array, Array], Array]
"""(commands (m, q), approaches (m, q)) -> what is added to the command of each axis, (m, q), m or rad."""


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
