"""From where a sphere is touched: along the tool, at its pole, and from two sides across it."""

from __future__ import annotations

import numpy as np

from axiscal.machine.description import Machine
from axiscal.machine.inverse import linear_axes
from axiscal.machine.kinematics import frames
from axiscal.numerics import Array

_KINDRED = 1e-6
"""Sines nearer than this are alike: the first one is taken."""
_RESERVE = 0.5
"""A coordinate of the workpiece is taken for an axis only where that has a sine less by so much: it is 0.8 at least."""


def touch_frames(machine: Machine, poses: Array) -> Array:
    """Return where a sphere is met, (m, 3, 3): unit vectors of its first side, its second side and its pole.

    poses : (m, q).  The pole is towards the spindle, the first side where the linear axis goes that is most across it;
    where none goes across it, the coordinate of the workpiece that does.
    """
    at, every = frames(machine, poses), np.arange(len(poses))
    axes = [at.rotations[k] @ np.array(machine.axes[k].direction) for k in linear_axes(machine)]
    ways = np.stack([*axes, *np.broadcast_to(np.eye(3)[:, None], (3, len(poses), 3))], axis=1)
    level = ways - np.sum(ways * at.stem[:, None], axis=2)[:, :, None] * at.stem[:, None]
    across = np.linalg.norm(level, axis=2)
    preferred = across - np.where(np.arange(ways.shape[1]) < len(axes), 0.0, _RESERVE)
    chosen = np.argmax(preferred > preferred.max(axis=1)[:, None] - _KINDRED, axis=1)
    first = level[every, chosen] / across[every, chosen][:, None]
    return np.stack([first, np.cross(at.stem, first), at.stem], axis=1) + 0.0


def touching_sides(machine: Machine, poses: Array) -> Array:
    """Return from where the linear axes come as they touch first side, second side and pole, (m, linear) +1, -1.

    An axis comes as it goes in the touch that moves it most: J t = -n, n where the sphere is met.
    """
    known = np.nan_to_num(poses)
    at, axes = frames(machine, known), linear_axes(machine)
    ways = np.stack([at.rotations[k] @ np.array(machine.axes[k].direction) for k in axes], axis=2)
    into = -np.swapaxes(touch_frames(machine, known), 1, 2)
    moved = np.linalg.pinv(ways) @ into
    most = np.abs(moved).argmax(axis=2)
    sides: Array = np.sign(np.take_along_axis(moved, most[:, :, None], axis=2)[:, :, 0])
    return sides
