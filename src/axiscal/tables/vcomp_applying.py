"""What a control makes of a file: errors, chain and joints once more, over many poses at a time.

It shares no line with the writer and no kinematics with the machine's model: a sign that is wrong on one side shows.

What a control does that knows the chain and every error: rotary axes turn their own error back, linear ones the tip.

    Δ_k = -s_k ε_kk of a rotary axis;  [u_x u_y u_z] Δ = -δp without these for the linear axes

and the same once more at the positions to which the axes are sent.

A file holds a machine as the control knows it, in the units of its configuration.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.exceptions import TableError
from axiscal.numerics import Array
from axiscal.tables.conditional import taken_by_rotor
from axiscal.tables.surface import Control, by_linear_axes
from axiscal.units import from_unit, to_unit
from axiscal_core.machine import Machine
from axiscal_core.rigid import about

KNOTS, MOTIONS = 96, 6
"""By the component's source: knots of an axis, error motions of an axis."""
LEAST_DETERMINANT = 0.2
"""By the component's source: of the directions of the linear axes; less is a fault."""
FADE_MM, FADE_DEG = 5.0, 5.0
"""By the component's source: over so much beyond the last knot a curve's slope fades to nothing."""


@dataclass(frozen=True, eq=False, slots=True)
class VcompAxis:
    """One axis; positions are those by ISO 841, `sense` times what its joints count.

    along : 0, 1, 2 for x, y, z; side : 1 tool, -1 workpiece; joints : its numbers, two of a gantry
    origin : (3,) of a rotary axis; place : (6,) location errors; tilt : (3,) rad, of the travel of a linear axis
    knots : (n,); motions : (n - 1, 6, 4), a b c d of x y z and about x y z from each knot on
    reversals : (n - 1, r, 4), r 6 or, where there are none, 0; seconds : that a reversal takes
    """

    name: str
    along: int
    rotary: bool
    side: int
    sense: int
    joints: tuple[int, ...]
    origin: Array
    place: Array
    tilt: Array
    cyclic: bool
    seconds: float
    knots: Array
    motions: Array
    reversals: Array


@dataclass(frozen=True, eq=False, slots=True)
class VcompFile:
    """A whole file.

    campaign : the beginning of its record's hash; unit : mm or inch
    limit, limit_deg : the largest correction of a linear and of a rotary joint; tool : (3,) from the spindle nose
    axes : in chain order, from the workpiece to the tool
    """

    campaign: str
    unit: str
    limit: float
    limit_deg: float
    tool: Array
    axes: tuple[VcompAxis, ...]


CORE = "axiscal_vcomp_core.h"
"""The same in C, beside this file: what LinuxCNC's component and grblHAL's plugin include."""


def fnv1a(data: bytes) -> int:
    """Return the 32-bit FNV-1a hash of bytes (Fowler, Noll, Vo): any single changed byte changes it."""
    found = 2166136261
    for byte in data:
        found = (found ^ byte) * 16777619 & 0xFFFFFFFF
    return found


_INCH = 25.4
"""By definition: mm of an inch."""


def component_control(file: VcompFile, machine: Machine) -> Control:
    """Return what the component adds to the joints; raises TableError when its axes are not those of the machine."""
    names = [axis.name for axis in machine.axes]
    if [axis.name for axis in file.axes] != names:
        what, remedy = "the file has axes {found}", "{names} are expected"
        raise TableError(what, remedy, found=" ".join(a.name for a in file.axes), names=" ".join(names))
    units = ["deg" if axis.rotary else {"mm": "mm", "inch": "in"}[file.unit] for axis in file.axes]

    def added(poses: Array, approaches: Array) -> Array:
        joints = np.stack([to_unit(column, u) for column, u in zip(poses.T, units, strict=True)], axis=1)
        further = correction(file, joints, approaches)
        return np.stack([from_unit(column, u) for column, u in zip(further.T, units, strict=True)], axis=1)

    return added


def correction(file: VcompFile, joints: Array, ways: Array) -> Array:
    """Return what is added to the joints of each axis, (m, q), units of the file.

    joints : (m, q) in chain order; ways : (m, q) from -1 to 1
    Raises TableError where the linear axes do not span space.
    """
    sense = np.array([axis.sense for axis in file.axes])
    first = _once(file, sense * joints, sense * ways)
    return sense * _once(file, sense * joints + first, sense * ways)


def joint_errors(axis: VcompAxis, at: Array, ways: Array, unit: str) -> Array:
    """Return the errors of an axis (m, 6) at positions by ISO 841 (m,): motion + way reversal / 2 + location."""
    low, high = axis.knots[[0, -1]]
    fade = FADE_DEG if axis.rotary else FADE_MM if unit == "mm" else FADE_MM / _INCH
    inside = low + np.mod(at - low, high - low) if axis.cyclic else np.clip(at, low, high)
    beyond = np.zeros_like(at) if axis.cyclic else at - inside
    faded = _faded(beyond, fade)
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


def _faded(beyond: Array, fade: float) -> Array:
    """Return how far curves go on straight beyond a travel: ever less, until they stay as they are at `fade`."""
    far = np.minimum(np.abs(beyond), fade)
    return np.sign(beyond) * (far - far**2 / (2 * fade))


def _once(file: VcompFile, at: Array, ways: Array) -> Array:
    """Return what the axes are to be sent further, (m, q), walking from the tool to the workpiece."""
    count = len(at)
    point, off, out = np.tile(file.tool, (count, 1)), np.zeros((count, 3)), np.zeros_like(at)
    moves: dict[int, Array] = {}
    for k in reversed(range(len(file.axes))):
        axis = file.axes[k]
        found, e = joint_errors(axis, at[:, k], ways[:, k], file.unit), np.eye(3)[axis.along]
        if axis.rotary:
            angle = np.radians(at[:, k])
            own = found[:, 3 + axis.along].copy()
            out[:, k] = np.degrees(-axis.side * own)
            turn = found[:, 3:] - own[:, None] * e
            point = point - axis.origin
            if axis.side > 0:
                point, off = about(axis.along, point, angle), about(axis.along, off, angle)
            off = off + axis.side * (found[:, :3] + np.cross(turn, point))
            if axis.side < 0:
                point, off = about(axis.along, point, angle), about(axis.along, off, angle)
            moves = {i: about(axis.along, u, angle) for i, u in moves.items()}
            point = point + axis.origin
            continue
        way = at[:, k, None] * e
        carried = point if axis.side > 0 else point + way
        off = off + axis.side * (found[:, :3] + np.cross(found[:, 3:], carried)) + np.cross(axis.tilt, way)
        point, moves[k] = point + way, np.tile(e, (count, 1))
    along = list(moves.values())
    across = [np.cross(along[0], along[1])] if len(along) == 2 else []
    directions = np.stack([*along, *across], axis=2)
    if np.any(np.abs(np.linalg.det(directions)) < LEAST_DETERMINANT):
        raise TableError("the linear axes do not span space at some poses", "keep the volume away from there")
    out[:, list(moves)] = -np.linalg.solve(directions, off[:, :, None])[:, : len(along), 0]
    return out


def whole_control(model: Machine, mean: Array) -> Control:
    """Return the control that takes the deviation of these errors away.  mean : (size,) control values

    Without rotary axes it adds nothing at machine zero, the mean of both directions: a constant is a matter of the
    workpiece's zero. Errors of two axes together are left, and with two linear axes what leads out of their plane.
    Raises TableError when the machine has not two or three linear axes, each along a direction of its own.
    """
    axes = model.axes
    taken, constant = by_linear_axes(model, fewest=2), at_zero(model, mean)

    def once(poses: Array, approaches: Array) -> Array:
        values = _values(model, mean, poses, approaches)
        levers, turned = model.levers(poses)[: len(model.curves)], np.zeros_like(poses)
        for k in (k for k, axis in enumerate(axes) if axis.rotary):
            own = [i for i, f in enumerate(model.curves) if f.axis == k and taken_by_rotor(model, i)]
            turned[:, k] = -axes[k].sign * np.sum(axes[k].direction) * values[own].sum(axis=0)
            levers[own] = 0.0
        return turned + taken(poses, np.einsum("fmc,fm->mc", levers, values) - constant)

    return lambda poses, approaches: once(poses + once(poses, approaches), approaches)


def at_zero(model: Machine, mean: Array) -> Array:
    """Return the constant deviation that is not corrected, (3,) m: that at machine zero, none where axes turn."""
    if any(axis.rotary for axis in model.axes):
        return np.zeros(3)
    zero = np.array([model.zero])
    values = _values(model, mean, zero, np.zeros_like(zero))
    deviation: Array = np.einsum("fmc,fm->mc", model.levers(zero)[: len(model.curves)], values)[0]
    return deviation


def _values(model: Machine, mean: Array, poses: Array, approaches: Array) -> Array:
    """Return what every error of one axis is at poses, as the component has it, (functions, m); reversals by side."""
    found, reached = [], poses.copy()
    for k, axis in enumerate(model.axes):
        if not axis.cyclic:
            fade = from_unit(FADE_DEG, "deg") if axis.rotary else from_unit(FADE_MM, "mm")
            inside = np.clip(poses[:, k], *axis.travel)
            reached[:, k] = inside + _faded(poses[:, k] - inside, fade)
    for function in model.curves:
        value = function.rows(reached[:, function.axis]) @ mean[function.columns]
        found.append(value * (0.5 * approaches[:, function.axis]) if function.kind == "reversal" else value)
    return np.array(found).reshape(len(model.curves), len(poses))
