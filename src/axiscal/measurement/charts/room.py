"""What may not be: out of travel, against a ball's stem, or in what stands there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.description import Machine
from axiscal.machine.kinematics import frames
from axiscal.numerics import Array

_SLACK = 1e-10
"""Share of a travel by which rounding may leave it."""
_ANGLE = 1e-9
"""rad: rounding of an angle."""


@dataclass(frozen=True, eq=False, slots=True)
class Room:
    """Where the machine may stand.

    keep_out : (n, 3, 2) boxes in the workpiece frame, m, that neither the tool point nor the tool enters
    """

    machine: Machine
    keep_out: Array

    @classmethod
    def empty(cls, machine: Machine) -> Room:
        """Return a room in which nothing stands."""
        return cls.with_boxes(machine, ())

    @classmethod
    def with_boxes(cls, machine: Machine, boxes: Sequence[Sequence[tuple[float, float]]]) -> Room:
        """Return a room in which boxes stand, each (low, high) along x, y, z, m."""
        return cls(machine, np.array(boxes, dtype=np.float64).reshape(-1, 3, 2))

    def in_travel(self, poses: Array) -> NDArray[np.bool_]:
        """Return which poses (m, q) are numbers within the travels."""
        low, high = np.array([axis.travel for axis in self.machine.axes]).T
        slack = _SLACK * (high - low)
        with np.errstate(invalid="ignore"):
            within: NDArray[np.bool_] = np.all((poses >= low - slack) & (poses <= high + slack), axis=1)
        return within

    def holds(self, poses: Array) -> NDArray[np.bool_]:
        """Return at which poses (m, q) nothing is in the way."""
        found = self.in_travel(poses)
        if len(self.keep_out) and found.any():
            at = frames(self.machine, poses[found])
            found[found] = ~self.hit(at.tcp, at.stem)
        return found

    def holds_bar(self, poses: Array, centre: Array, free: Array, cone: float) -> NDArray[np.bool_]:
        """Return at which poses a bar from a centre (3,) is also clear of the tool and of the stem below the centre.

        free : (3,) away from that stem; cone : rad, between tool and bar, and between bar and free side, at most
        """
        found = self.holds(poses)
        if found.any():
            at = frames(self.machine, poses[found])
            bar = at.tcp - centre
            bar /= np.linalg.norm(bar, axis=1)[:, None]
            found[found] = within_cone(at.stem, bar, cone) & within_cone(bar, free, cone)
        return found

    def hit(self, tips: Array, stems: Array, nearer: Array | float = 0.0) -> NDArray[np.bool_]:
        """Return where the tool, from its tip (m, 3) along its stem, is nearer to a box than its radius, (m,).

        nearer : m, or (m,), by how much the boxes grow, where the tool may move by so much
        """
        hit = np.zeros(len(tips), dtype=bool)
        wider = np.broadcast_to(np.asarray(nearer, dtype=np.float64), (len(tips),))[:, None]
        for low, high in np.swapaxes(self.keep_out, 1, 2):
            hit |= np.all((tips >= low - wider) & (tips <= high + wider), axis=1)
            around = wider + self.machine.tool_radius
            hit |= _enters(tips, stems * self.machine.tool, low - around, high + around)
        return hit


def _enters(starts: Array, ways: Array, low: Array, high: Array) -> NDArray[np.bool_]:
    """Return whether straight ways (m, 3) from places (m, 3) enter boxes from low to high (m, 3): by slabs."""
    still = np.abs(ways) < 1e-12
    safe = np.where(still, 1.0, ways)
    into, out = (low - starts) / safe, (high - starts) / safe
    beside = still & ((starts < low) | (starts > high))
    first = np.where(still, 0.0, np.minimum(into, out)).max(axis=1)
    last = np.where(still, 1.0, np.maximum(into, out)).min(axis=1)
    found: NDArray[np.bool_] = ~beside.any(axis=1) & (np.maximum(first, 0.0) < np.minimum(last, 1.0))
    return found


def within_cone(directions: Array, middle: Array, cone: float) -> NDArray[np.bool_]:
    """Return which unit vectors (m, 3) are no further than a cone, rad, from a unit vector (3,) or (m, 3)."""
    cosine = np.sum(directions * middle, axis=1)
    inside: NDArray[np.bool_] = np.arccos(np.clip(cosine, -1.0, 1.0)) <= cone + _ANGLE
    return inside
