"""A scale made of pieces: levels that step at joints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from axiscal_core.refusals import Array
from axiscal_core.splines import Integrated


@dataclass(frozen=True, slots=True, eq=False)
class Segments(Integrated):
    """Levels between joints, with a straight way of some width from one to the next: a scale made of pieces.

    Straight between breaks, with rows that sum to one: all that is exact for a spline is exact for them.

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
