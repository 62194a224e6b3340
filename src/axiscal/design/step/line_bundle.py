"""Lines through several poses along several axes, cut where they stop being smooth: one search for all of them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from axiscal.design.step.lines import Lines, SampledLines
from axiscal.numerics import Array
from axiscal.numerics.ties import TIE, first_best_each


class LineBundle:
    """The intervals of the lines through several poses along several axes, one after another."""

    def __init__(self, lines: list[Lines | SampledLines], breaks: list[Array], poses: int) -> None:
        self._lines, self._counts, self._poses = lines, [len(b) - 1 for b in breaks], poses
        self._starts = np.cumsum([0, *(poses * c for c in self._counts)])
        self.left = np.concatenate([np.tile(b[:-1], poses) for b in breaks])
        self.right = np.concatenate([np.tile(b[1:], poses) for b in breaks])
        self.pose = np.concatenate([np.repeat(np.arange(poses), c) for c in self._counts])

    def forms(self, positions: Array, interval: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return both forms of the gain, each (b, k), at positions (b, k) in intervals (b,)."""
        above, below = np.empty_like(positions), np.empty_like(positions)
        for lines, start, stop in zip(self._lines, self._starts[:-1], self._starts[1:], strict=True):
            mine = np.flatnonzero((interval >= start) & (interval < stop))
            if len(mine):
                above[mine], below[mine] = lines.forms(positions[mine], self.pose[interval[mine]])
        return above, below

    def best(self, axis: int, position: Array, value: Array) -> tuple[Array, Array]:
        """Return for each pose the best position along an axis, and the gain there."""
        mine = slice(self._starts[axis], self._starts[axis + 1])
        pick = first_best_each(value[mine].reshape(self._poses, -1), TIE)
        index = self._starts[axis] + np.arange(self._poses) * self._counts[axis] + pick
        return position[index], value[index]
