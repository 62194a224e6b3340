"""What follows from the rows of a spline: its coefficients on each interval, and how much it bends."""

import numpy as np

from axiscal.numerics import Array
from axiscal_core.splines import Spline, gauss


def power_maps(spline: Spline) -> tuple[Array, Array, Array]:
    """Return M1, M2, M3 with b = M1 a, c = M2 a, d = M3 a on every interval, each (intervals, size)."""
    slope, bend, jerk = (spline.rows(spline.knots[:-1], order) for order in (1, 2, 3))
    return slope, np.asarray(bend / 2), np.asarray(jerk / 6)


def bending(spline: Spline) -> Array:
    """Return K with ∫ S''² dt = aᵀ K a, (size, size)."""
    nodes, weights = (each.ravel() for each in gauss(spline.knots, 5))
    rows = spline.rows(nodes, 2)
    return np.asarray((rows.T * weights) @ rows)
