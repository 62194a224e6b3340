"""Readings of trackers that were set down by eye, as they would be if the trackers stood straight.

A tracker shows y = R(p + δ − s) + s + zero − p at a place p from its station s. Its turn R is a datum of a check if it
may hide the tolerance. Turns of 20 mrad are not linear: over a metre the square is 200 um. So R is the turn after which
no turn remains. It is taken back: Rᵀ(y + p − s) − (p − s) = δ + Rᵀ zero.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.machine.description import Machine
from axiscal.machine.kinematics import frames
from axiscal.measurement.instruments.tracker import TURNS
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array, rigid

_ROUNDS = 12
"""Rounds end where the turn stays; this only ends what would go round."""
_STAYS = 1e-10
"""rad; a tenth of a nanometre over a metre."""


def straightened(machine: Machine, setup: Setup, poses: Array, shown: Array, turns: Sequence[str]) -> Array:
    """Return the readings of one tracker without its turn, (m, 3), m.

    poses : (m, q) m or rad; shown : (m, 3) m; turns : the unknown turns that are datums, others are none
    """
    line = frames(machine, poses).tcp - (np.zeros(3) if setup.station is None else np.array(setup.station))
    free = [TURNS.index(name) for name in turns]
    zeros = np.tile(np.eye(3), (len(poses), 1))
    tilted = np.stack([np.cross(np.eye(3)[axis], line).ravel() for axis in free], axis=1)
    inverse, turn = np.linalg.pinv(np.hstack([tilted, zeros])), np.eye(3)
    for _ in range(_ROUNDS):
        step = np.zeros(3)
        step[free] = (inverse @ ((shown + line) @ turn - line).ravel())[: len(free)]
        turn = turn @ rigid.rotation(step[None])[0]
        if np.max(np.abs(step)) < _STAYS:
            break
    straight: Array = (shown + line) @ turn - line
    return straight
