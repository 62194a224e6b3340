"""What a little more of each small motion does to the tool of a machine as it is: levers at the actual frames.

T = … M_k E_k … with E_k = Trans(δ) Rot(ε) on the tool side and its inverse on the workpiece side. A little more of ε
turns by J(ε) dε before Rot(ε), about where the frame then is. J is the left Jacobian of the rotation group (Barfoot
2017, eq. 7.77). At the nominal machine these are the levers of `frames`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from axiscal.machine.description import Machine
from axiscal.machine.kinematics import SmallMotions, from_frame, to_frame, tool_point
from axiscal.numerics import Array, rigid


class MotionEffects(NamedTuple):
    """Derivatives of the TCP, and of the tool's turn, by x, y, z (last index) of each small motion, workpiece frame.

    displacement, rotation, tilt : (q, m, 3, 3) m/m or m/rad; turn : (q, m, 3, 3) rad/rad, of the rotation alone
    """

    displacement: Array
    rotation: Array
    tilt: Array
    turn: Array


class _Joint(NamedTuple):
    """Of one axis: how displacements act, how rotations turn (both (m, 3, 3)) and about where, and what a tilt does."""

    displaced: Array
    turned: Array
    about: Array
    tilted: Array


def motion_effects(machine: Machine, poses: Array, small: SmallMotions) -> MotionEffects:
    """Return the derivatives at poses (m, q) of a machine with small motions."""
    motion, joints = rigid.identity(len(poses)), list[_Joint]()
    for k, (axis, coordinate) in enumerate(zip(machine.axes, poses.T, strict=True)):
        tilt, turn = rigid.rotation(small.tilt[k]), rigid.rotation(small.rotation[k])
        motion = to_frame(axis, motion, coordinate, tilt)
        base = motion
        if axis.workpiece_side:
            back = np.swapaxes(turn, 1, 2)
            motion = motion.then(back).moved(-small.displacement[k])
            displaced, turned = -base.rotation @ back, -base.rotation @ rigid.left_jacobian(-small.rotation[k])
            about = base.translation
        else:
            motion = motion.moved(small.displacement[k])
            displaced, turned = base.rotation, base.rotation @ rigid.left_jacobian(small.rotation[k])
            about = motion.translation
            motion = motion.then(turn)
        tilted = np.zeros_like(turned)
        if not axis.rotary:
            carrier = motion.rotation if axis.workpiece_side else base.rotation
            straight = np.einsum("mij,mj->mi", tilt, np.outer(coordinate, axis.direction))
            tilted = carrier @ _crossed(rigid.left_jacobian(small.tilt[k]), straight)
        joints.append(_Joint(displaced, turned, about, tilted))
        motion = from_frame(axis, motion, coordinate, tilt)
    motion = motion.moved(tool_point(machine))
    rotation = np.stack([_crossed(each.turned, motion.translation - each.about) for each in joints])
    displacement, turn, tilt = (np.stack(parts) for parts in zip(*[(j[0], j[1], j[3]) for j in joints], strict=True))
    return MotionEffects(displacement, rotation, tilt, turn)


def _crossed(turns: Array, arm: Array) -> Array:
    """Return the columns of (m, 3, 3) each crossed with (m, 3)."""
    crossed: Array = np.swapaxes(rigid.cross(np.swapaxes(turns, 1, 2), arm[:, None, :]), 1, 2)
    return crossed
