"""Points spread evenly in a cube of any dimension, the same ones every time.

>>> even_points(2, 1).ravel()
array([0.25, 0.75])
"""

from __future__ import annotations

import numpy as np

from axiscal_core.refusals import Array


def even_points(count: int, dimensions: int) -> Array:
    """Return points spread evenly in the unit cube, (count, dimensions): multiples of the roots of x^{d+1} = x + 1.

    The additive recurrence whose discrepancy stays low at every length (Roberts 2018); one dimension gives midpoints.
    """
    if dimensions <= 1:
        return ((np.arange(count) + 0.5) / max(count, 1))[:, None][:, :dimensions]
    ratio = 2.0
    for _ in range(64):
        ratio = (1.0 + ratio) ** (1.0 / (dimensions + 1))
    steps = ratio ** -np.arange(1.0, dimensions + 1)
    return (0.5 + np.outer(np.arange(1, count + 1), steps)) % 1.0


def distinct_between(values: Array, low: float, high: float) -> Array:
    """Return values from low to high, ascending, those that differ by rounding once."""
    every = np.unique(values)
    inside = every[(every >= low) & (every <= high)]
    return np.asarray(inside[np.append(True, np.diff(inside) > 1e-9 * (high - low))])
