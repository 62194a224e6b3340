"""The positions of the linear axes that bring the tool point to a place of the workpiece, for any rotary angles.

With the rotary axes at ρ the tool point is p(q) = p₀(ρ) + J(ρ) t, affine in the linear axes t.
So t = J(ρ)⁻¹ (p* − p₀(ρ)): one small system per pose, exact to rounding.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from axiscal.machine.axis import LINEAR_LETTERS, letter_direction
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import frames
from axiscal.numerics import Array

_FLAT = 1e-6
"""Volume of three unit directions: less lie in a plane, as far as a machine is built."""
_REACHED = 1e-9
"""A place that stays further off than this, m, is out of reach of the machine's linear axes."""


def linear_axes(machine: Machine) -> tuple[int, ...]:
    """Return the indices of the axes that carry the tool point to a place: X, Y, Z as far as they are there.

    Axes of a second set U, V, W move only if they are needed as well; the others stay where they are.
    """
    return _carrying("".join(axis.letter for axis in machine.axes))


@cache
def _carrying(letters: str) -> tuple[int, ...]:
    chosen: list[int] = []
    ways: set[int] = set()
    for letter in LINEAR_LETTERS:
        way = letter_direction(letter)
        if letter in letters and way not in ways:
            chosen.append(letters.index(letter))
            ways.add(way)
    return tuple(sorted(chosen))


def tip_at(machine: Machine, poses: Array, points: Array) -> Array:
    """Return the poses with the linear axes moved so that the tool point is at places of the workpiece frame.

    poses : (m, q) m or rad; points : (m, 3) m; returns (m, q), NaN where the linear axes do not reach a place
    """
    axes, result = list(linear_axes(machine)), poses.copy()
    result[:, axes] = 0.0
    at = frames(machine, result)
    ways = np.stack([at.rotations[k] @ np.array(machine.axes[k].direction) for k in axes], axis=2)
    away = points - at.tcp
    result[:, axes] = _solved(ways, away)
    off = np.linalg.norm(np.einsum("mij,mj->mi", ways, result[:, axes]) - away, axis=1)
    result[off > _REACHED] = np.nan
    return result


def drawn_back(machine: Machine, poses: Array, far: float) -> Array:
    """Return poses (m, q) with the linear axes moved so that the tool is drawn back along itself.  far : m"""
    at = frames(machine, poses)
    return tip_at(machine, poses, at.tcp + far * at.stem)


def _solved(ways: Array, away: Array) -> Array:
    """Return the travels that add up to the ways, or come nearest, (m, k).  ways : (m, 3, k); away : (m, 3)."""
    if ways.shape[2] == 3 and np.all(np.abs(np.linalg.det(ways)) > _FLAT):
        return np.asarray(np.linalg.solve(ways, away[:, :, None])[:, :, 0], dtype=np.float64)
    return np.asarray((np.linalg.pinv(ways) @ away[:, :, None])[:, :, 0], dtype=np.float64)
