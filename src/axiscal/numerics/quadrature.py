"""Gauss-Legendre quadrature, interval by interval."""

from __future__ import annotations

import numpy as np

from axiscal.numerics import Array


def gauss(breaks: Array, count: int) -> tuple[Array, Array]:
    """Return nodes and weights, each (intervals, count), exact for degree 2 count − 1 between any two breaks.

    breaks : (intervals + 1,) ascending
    """
    node, weight = np.polynomial.legendre.leggauss(count)
    half = np.diff(breaks)[:, None] / 2
    return breaks[:-1, None] + half * (1 + node), half * weight
