"""What is believed of an error before the first reading: its knots, and a covariance of the control values.

Functions that step at joints are straight between breaks, and their rows sum to one. So all that is exact for a spline
is exact for them: integrals over quadrature of the breaks, lines of a gain.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from axiscal.machine.entry import JOINT, KNOTS_PER_WAVE, ErrorEntry
from axiscal.numerics import Array
from axiscal_core.axes import Axis
from axiscal_core.splines import (
    Constant,
    CyclicSpline,
    Integrated,
    NaturalSpline,
    Repeated,
    Spline,
    distances,
    matern,
    ramp,
)


@dataclass(frozen=True, slots=True, eq=False)
class Segments(Integrated):
    """Levels between joints, with a straight way of some width from one to the next: a scale made of pieces.

    start, stop : the stretch; joints : increasing, within it; width : of each way; all m or rad
    """

    start: float
    stop: float
    joints: tuple[float, ...]
    width: float

    @property
    def size(self) -> int:
        """Number of levels."""
        return len(self.joints) + 1

    @property
    def knots(self) -> Array:
        """Both ends and where each way begins and ends, (2 + 2 joints,)."""
        ways = np.array(self.joints)[:, None] + self.width * np.array([-0.5, 0.5])
        return np.concatenate([[self.start], ways.ravel(), [self.stop]])

    @property
    def control_positions(self) -> Array:
        """The middle of each level, (size,)."""
        knots = self.knots
        return (knots[::2] + knots[1::2]) / 2

    def rows(self, t: ArrayLike, derivative: int = 0) -> Array:
        """Return the share of each level at positions, or its derivative: (m, size)."""
        at = np.atleast_1d(np.asarray(t, dtype=float))
        along = (at[:, None] - np.array(self.joints)) / self.width + 0.5
        if derivative == 0:
            passed = np.clip(along, 0.0, 1.0)
        elif derivative == 1:
            passed = np.where((along >= 0) & (along < 1), 1.0 / self.width, 0.0)
        else:
            passed = np.zeros_like(along)
        ends = np.full((len(at), 1), 1.0 if derivative == 0 else 0.0), np.zeros((len(at), 1))
        padded = np.hstack([ends[0], passed, ends[1]])
        rows: Array = padded[:, :-1] - padded[:, 1:]
        return rows


def basis(entry: ErrorEntry, axis: Axis) -> Spline:
    """Return the spline of an error over the travel of its axis: a constant, cyclic for a full turn, else natural.

    A wave has a cyclic one over each period; steps have levels between their joints.
    """
    if entry.constant:
        return Constant(*axis.travel)
    if entry.harmonics and entry.period is not None:
        return Repeated(*axis.travel, entry.period, KNOTS_PER_WAVE * entry.harmonics)
    if entry.joints:
        return Segments(*axis.travel, entry.joints, JOINT)
    knots = np.array(entry.knot_positions(axis))
    return CyclicSpline(knots) if axis.cyclic else NaturalSpline(knots)


def covariance(entry: ErrorEntry, spline: Spline) -> Array:
    """Return the prior covariance of the control values, (size, size).

    Independent control points (B&H eq. 16) without a correlation length, else Matérn-5/2 or -3/2 at the knots. On a
    cyclic spline the distance is the chord of the circle, which keeps the kernel positive definite. In a wave, cosine
    and sine of k turns a period have s²/k², k = 1…K. Each step has s², the mean level of steps none. A scale adds the
    coordinate times one unknown.
    """
    if entry.harmonics:
        turns = 2 * np.pi * np.arange(spline.size) / spline.size
        each = [np.cos(k * (turns[:, None] - turns)) / k**2 for k in range(1, entry.harmonics + 1)]
        waves: Array = entry.std**2 * np.sum(each, axis=0)
        return waves
    if entry.joints:
        level = np.tri(spline.size, spline.size, -1)[:, :-1]
        centred = level - level.mean(axis=0)
        steps: Array = entry.std**2 * centred @ centred.T
        return steps
    if entry.length is None or spline.size == 1:
        curve = np.eye(spline.size)
    else:
        curve = matern(distances(spline) / entry.length, entry.smoothness)
    along = (entry.scale or 0.0) * ramp(spline)
    return entry.std**2 * curve + np.outer(along, along)
