"""Arrays in, arrays out; nothing here knows of machines.

Few points that stand for many.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from axiscal_core.refusals import Array as Array


def even_subset(points: Array, count: int) -> NDArray[np.intp]:
    """Return the indices of so many points that stand for all, (count,): the same points in whatever order all come.

    Halving at the median across the widest side, again and again, puts all in a row (Bentley 1975). Every (m/count)th
    of it is taken.  points : (m, d), m at most `count` are taken all; sides count as shares of the whole
    """
    sides = np.ptp(points, axis=0)
    shares = points / np.where(sides > 0, sides, 1.0)
    row = _in_a_row(shares, np.lexsort(shares.T[::-1]))
    taken = min(count, len(points))
    return row[(len(row) * (2 * np.arange(taken) + 1)) // (2 * taken)]


def _in_a_row(points: Array, row: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the indices of points so that neighbours stand near each other.  row : sorted by the coordinates"""
    ends = np.array([0, len(row)])
    while np.diff(ends).max() > 1:
        own, parts = points[row], np.repeat(np.arange(len(ends) - 1), np.diff(ends))
        sides = np.maximum.reduceat(own, ends[:-1]) - np.minimum.reduceat(own, ends[:-1])
        along = own[np.arange(len(row)), sides.argmax(axis=1)[parts]]
        row = row[np.lexsort((along, parts))]  # all parts at once: some dozen steps in place of one for each point
        ends = np.union1d(ends, (ends[:-1] + ends[1:]) // 2)
    return row
