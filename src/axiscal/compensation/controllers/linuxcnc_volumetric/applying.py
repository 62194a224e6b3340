"""What the component makes of a file: errors, chain and joints once more, over many poses at a time.

It shares no line with the writer and no kinematics with the machine's model: a sign that is wrong on one side shows.
"""

from __future__ import annotations

import numpy as np

from axiscal.compensation.controllers.linuxcnc_volumetric.content import (
    FADE_DEG,
    FADE_MM,
    LEAST_DETERMINANT,
    MOTIONS,
    VcompAxis,
    VcompFile,
)
from axiscal.compensation.effect import Control
from axiscal.exceptions import TableError
from axiscal.machine.description import Machine
from axiscal.numerics import Array
from axiscal.units import from_unit, to_unit

_INCH = 25.4
"""By definition: mm of an inch."""


def control(file: VcompFile, machine: Machine) -> Control:
    """Return what the component adds to the joints; raises TableError when its axes are not those of the machine."""
    names = [axis.name for axis in machine.axes]
    if [axis.name for axis in file.axes] != names:
        raise TableError(f"the file has axes {' '.join(a.name for a in file.axes)}", f"{' '.join(names)} are expected")
    units = ["deg" if axis.rotary else {"mm": "mm", "inch": "in"}[file.unit] for axis in file.axes]

    def added(poses: Array, approaches: Array) -> Array:
        joints = np.stack([to_unit(column, u) for column, u in zip(poses.T, units, strict=True)], axis=1)
        further = correction(file, joints, approaches)
        return np.stack([from_unit(column, u) for column, u in zip(further.T, units, strict=True)], axis=1)

    return added


def correction(file: VcompFile, joints: Array, ways: Array, tool: Array | None = None) -> Array:
    """Return what is added to the joints of each axis, (m, q), units of the file.

    joints : (m, q) in chain order; ways : (m, q) from -1 to 1; tool : (3,) where it is not that of the campaign
    Raises TableError where the linear axes do not span space.
    """
    sense = np.array([axis.sense for axis in file.axes])
    tip = file.tool if tool is None else tool
    first = _once(file, sense * joints, sense * ways, tip)
    return sense * _once(file, sense * joints + first, sense * ways, tip)


def errors(axis: VcompAxis, at: Array, ways: Array, unit: str) -> Array:
    """Return the errors of an axis (m, 6) at positions by ISO 841 (m,): motion + way reversal / 2 + location."""
    low, high = axis.knots[[0, -1]]
    fade = FADE_DEG if axis.rotary else FADE_MM if unit == "mm" else FADE_MM / _INCH
    inside = low + np.mod(at - low, high - low) if axis.cyclic else np.clip(at, low, high)
    beyond = np.zeros_like(at) if axis.cyclic else at - inside
    far = np.minimum(np.abs(beyond), fade)
    faded = np.sign(beyond) * (far - far**2 / (2 * fade))
    found = np.clip(np.searchsorted(axis.knots, inside, side="right") - 1, 0, len(axis.knots) - 2)
    x = (inside - axis.knots[found])[:, None]

    def value(curves: Array) -> Array:
        a, b, c, d = np.moveaxis(curves[found], 2, 0)
        straight: Array = a + x * (b + x * (c + x * d)) + faded[:, None] * (b + x * (2 * c + 3 * x * d))
        return straight

    total: Array = value(axis.motions) + axis.place
    if axis.reversals.shape[1] == MOTIONS:
        total = total + 0.5 * ways[:, None] * value(axis.reversals)
    return total


def _once(file: VcompFile, at: Array, ways: Array, tool: Array) -> Array:
    """Return what the axes are to be sent further, (m, q), walking from the tool to the workpiece."""
    count = len(at)
    point, off, out = np.tile(tool, (count, 1)), np.zeros((count, 3)), np.zeros_like(at)
    moves: dict[int, Array] = {}
    for k in reversed(range(len(file.axes))):
        axis = file.axes[k]
        found, e = errors(axis, at[:, k], ways[:, k], file.unit), np.eye(3)[axis.along]
        if axis.rotary:
            angle = np.radians(at[:, k])
            own = found[:, 3 + axis.along].copy()
            out[:, k] = np.degrees(-axis.side * own)
            turn = found[:, 3:] - own[:, None] * e
            point = point - axis.origin
            if axis.side > 0:
                point, off = _about(axis.along, point, angle), _about(axis.along, off, angle)
            off = off + axis.side * (found[:, :3] + np.cross(turn, point))
            if axis.side < 0:
                point, off = _about(axis.along, point, angle), _about(axis.along, off, angle)
            moves = {i: _about(axis.along, u, angle) for i, u in moves.items()}
            point = point + axis.origin
            continue
        way = at[:, k, None] * e
        carried = point if axis.side > 0 else point + way
        off = off + axis.side * (found[:, :3] + np.cross(found[:, 3:], carried)) + np.cross(axis.tilt, way)
        point, moves[k] = point + way, np.tile(e, (count, 1))
    directions = np.stack(list(moves.values()), axis=2)
    if np.any(np.abs(np.linalg.det(directions)) < LEAST_DETERMINANT):
        raise TableError("the linear axes do not span space at some poses", "keep the volume away from there")
    out[:, list(moves)] = -np.linalg.solve(directions, off[:, :, None])[:, :, 0]
    return out


def _about(along: int, vectors: Array, angle: Array) -> Array:
    """Return vectors (m, 3) turned about x, y or z."""
    first, second = (along + 1) % 3, (along + 2) % 3
    turned = vectors.copy()
    turned[:, first] = np.cos(angle) * vectors[:, first] - np.sin(angle) * vectors[:, second]
    turned[:, second] = np.sin(angle) * vectors[:, first] + np.cos(angle) * vectors[:, second]
    return turned
