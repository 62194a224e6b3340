"""The nominal chain and its exact deviation: where each axis frame and the TCP are in the workpiece frame.

Read from the workpiece to the tool the chain is p = M_1(t_1) … M_q(t_q) p_tool, primed or not (docs/conventions.md).
The positions of the linear axes that bring the tool point to a place of the workpiece, for any rotary angles.

With the rotary axes at ρ the tool point is p(q) = p₀(ρ) + J(ρ) t, affine in the linear axes t.
So t = J(ρ)⁻¹ (p* − p₀(ρ)): one small system per pose, exact to rounding.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from axiscal.machine.axis import LINEAR_LETTERS, letter_direction
from axiscal.numerics import Array
from axiscal_core import rigid
from axiscal_core.axes import from_frame, to_frame
from axiscal_core.machine import Machine
from axiscal_core.rigid import SmallMotions
from axiscal_core.terms import Term

_FLAT = 1e-6
"""Volume of three unit directions: less lie in a plane, as far as a machine is built."""
_REACHED = 1e-9
"""A place that stays further off than this, m, is out of reach of the machine's linear axes."""


def linear_axes(machine: Machine) -> tuple[int, ...]:
    """Return the indices of the axes that carry the tool point to a place: X, Y, Z as far as they are there.

    Axes of a second set U, V, W move only if they are needed as well; the others stay where they are.
    """
    letters, chosen = [axis.letter for axis in machine.axes], dict[int, int]()
    for letter in LINEAR_LETTERS:
        if letter in letters:
            chosen.setdefault(letter_direction(letter), letters.index(letter))
    return tuple(sorted(chosen.values()))


def tip_at(machine: Machine, poses: Array, points: Array) -> Array:
    """Return the poses with the linear axes moved so that the tool point is at places of the workpiece frame.

    poses : (m, q) m or rad; points : (m, 3) m; returns (m, q), NaN where the linear axes do not reach a place
    """
    axes, result = list(linear_axes(machine)), poses.copy()
    result[:, axes] = 0.0
    alike = len(result) > 0 and bool(np.all(result == result[0]))
    at = machine.frames(result[:1] if alike else result)
    ways = np.stack([at.rotations[k] @ np.array(machine.axes[k].direction) for k in axes], axis=2)
    ways, away = np.broadcast_to(ways, (len(poses), *ways.shape[1:])), points - at.tcp
    result[:, axes] = solved(ways, away)
    off = np.linalg.norm(np.einsum("mij,mj->mi", ways, result[:, axes]) - away, axis=1)
    result[off > _REACHED] = np.nan
    return result


def drawn_back(machine: Machine, poses: Array, far: float) -> Array:
    """Return poses (m, q) with the linear axes moved so that the tool is drawn back along itself.  far : m"""
    at = machine.frames(poses)
    return tip_at(machine, poses, at.tcp + far * at.stem)


def solved(ways: Array, away: Array) -> Array:
    """Return the travels that add up to the ways, or come nearest, (m, k).  ways : (m, 3, k); away : (m, 3)."""
    if ways.shape[2] == 3 and np.all(np.abs(np.linalg.det(ways)) > _FLAT):
        return np.asarray(np.linalg.solve(ways, away[:, :, None])[:, :, 0], dtype=np.float64)
    return np.asarray((np.linalg.pinv(ways) @ away[:, :, None])[:, :, 0], dtype=np.float64)


def small_motions(machine: Machine, coefficients: Array, poses: Array, approaches: Array) -> SmallMotions:
    """Return what each axis frame does beside its nominal motion.  coefficients : (size,)."""
    values = [term.rows(*term.at(poses)) @ coefficients[term.columns] for term in machine.terms]
    return composed(machine, np.array(values).reshape(len(machine.terms), len(poses)), approaches)


def composed(machine: Machine, values: Array, approaches: Array) -> SmallMotions:
    """Return the small motions of the axis frames from the value of every term.  values : (terms, m)."""
    shape = (len(machine.axes), values.shape[1], 3)
    parts = SmallMotions(np.zeros(shape), np.zeros(shape), np.zeros(shape))
    signed = machine.effects(values, approaches)
    for i, term in enumerate(machine.terms):
        getattr(parts, motion_of(term))[term.axis, :, term.component % 3] += signed[i]
    return parts


def motion_of(term: Term) -> str:
    """Return which of the small motions of its axis a term is."""
    tilts = term.kind == "location" and term.linear
    return "tilt" if tilts else "rotation" if term.angular else "displacement"


def bed_in_workpiece(machine: Machine, poses: Array) -> Array:
    """Return rotations that take directions of the machine's own x, y, z to those of the workpiece, (m, 3, 3)."""
    at = machine.frames(poses)
    first = next((k for k, axis in enumerate(machine.axes) if not axis.workpiece_side), None)
    found: Array = at.tool if first is None else at.rotations[first]
    return found


def in_frame(machine: Machine, axis: int, pose: Array) -> Array:
    """Return the directions x, y, z of an axis frame in the workpiece frame, a row each, (3, 3).

    pose : (q,) m or rad, where the other axes stand; the axis itself stands at zero
    """
    stands = pose.copy()
    stands[axis] = 0.0
    directions: Array = machine.frames(stands[None]).rotations[axis][0].T
    return directions


def tool_motion(machine: Machine, poses: Array, small: SmallMotions) -> rigid.Motion:
    """Return orientation and TCP of the tool in the workpiece frame, exactly, nothing linearised (B&H eq. 1).

    On the tool side an axis frame moves by E; on the workpiece side the workpiece does, so the chain sees E⁻¹.
    """
    motion = rigid.identity(len(poses))
    for k, (axis, coordinate) in enumerate(zip(machine.axes, poses.T, strict=True)):
        tilt = rigid.rotation(small.tilt[k]) if small.tilt[k].any() else None
        turn = rigid.rotation(small.rotation[k])
        motion = to_frame(axis, motion, coordinate, tilt)
        if axis.workpiece_side:
            motion = motion.then(np.swapaxes(turn, 1, 2)).shifted(-small.displacement[k])
        else:
            motion = motion.shifted(small.displacement[k]).then(turn)
        motion = from_frame(axis, motion, coordinate, tilt)
    return motion.shifted(np.array(machine.tool))


class Deviation(NamedTuple):
    """The error motion of the tool, in the workpiece frame.

    displacement : (m, 3) m, of the TCP; rotation : (m, 3) rad, the skew part of the turn: right to second order
    """

    displacement: Array
    rotation: Array


def actual_deviation(machine: Machine, poses: Array, small: SmallMotions) -> Deviation:
    """Return how the tool deviates with small motions, nothing linearised."""
    actual, nominal = tool_motion(machine, poses, small), machine.frames(poses)
    return Deviation(actual.translation - nominal.tcp, turn_between(nominal.tool, actual.rotation))


def turn_between(before: Array, after: Array) -> Array:
    """Return the small turns from orientations to others, (m, 3) rad, right to second order.  both : (m, 3, 3)"""
    turn = after @ np.swapaxes(before, 1, 2)
    skew = (turn - np.swapaxes(turn, 1, 2)) / 2
    return np.stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]], axis=1)
