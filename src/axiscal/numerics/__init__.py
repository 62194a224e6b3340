"""Arrays in, arrays out; nothing here knows of machines.

Few points that stand for many.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


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


def _in_a_row(points: Array, some: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the indices of some points so that neighbours stand near each other.  some : sorted by the coordinates"""
    own = points[some]
    sides = np.ptp(own, axis=0) if len(some) > 1 else np.zeros(1)
    if not sides.any():
        return some
    along = some[np.argsort(own[:, sides.argmax()], kind="stable")]
    halves = np.split(along, [len(along) // 2])
    return np.concatenate([_in_a_row(points, half) for half in halves])
