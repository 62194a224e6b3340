"""The largest ratio of two polynomials between breaks: at an end or at a root of N'D - ND' (B&H eq. 27).

>>> largest(lambda t: (t * (1 - t), np.ones_like(t)), np.array([0.0, 1.0]), degree=2)
(0.5, 0.25)
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import chebyshev

from axiscal_core.refusals import Array

Forms = Callable[[Array], tuple[Array, Array]]
"""Places (m,) -> N and D there, (m,) each."""
_INSIDE = 1e-9  # of a piece: what N and D are at a break belongs to the piece on one side only
_FOLLOWED = 1e-9  # of the largest value: a series that is off by more is not that of a polynomial


def largest(forms: Forms, breaks: Array, degree: int) -> tuple[float, float] | None:
    """Return the place of the largest N/D and the ratio; None where N or D is no polynomial of `degree`.

    The polynomials are never written in powers: both are Chebyshev series on each piece, which keeps their digits.
    breaks : (b,) between which N and D are polynomials
    """
    nodes = np.concatenate([np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1)), [-0.83, 0.29]])
    to_series = np.linalg.inv(chebyshev.chebvander(nodes[:-2], degree)).T
    left, right = breaks[:-1, None], breaks[1:, None]
    values = [each.reshape(-1, len(nodes)) for each in forms(_placed(left, right, nodes[None]).ravel())]
    series = [each[:, :-2] @ to_series for each in values]
    for found, true in zip(series, values, strict=True):
        off = chebyshev.chebval(nodes[-2:], found.T) - true[:, -2:]
        if np.abs(off).max() > _FOLLOWED * np.abs(true).max():
            return None
    inside = np.zeros((len(left), 2 * degree + 1))
    inside[:, :2] = 1 - _INSIDE, _INSIDE - 1
    for x, above, below in zip(inside, *series, strict=True):
        found = _stationary(above, below)
        x[2 : 2 + len(found)] = found
    places = _placed(left, right, inside).ravel()
    numerator, denominator = forms(places)
    best = int(np.argmax(numerator / denominator))
    near = np.argmin(np.abs(breaks - places[best]))
    at = breaks[near] if abs(breaks[near] - places[best]) < 2 * _INSIDE * np.ptp(breaks) else places[best]
    return float(at), float(numerator[best] / denominator[best])


def _placed(left: Array, right: Array, x: Array) -> Array:
    """Return places in pieces, (b, n).  left, right : (b, 1); x : (..., n) from -1 to 1"""
    result: Array = left * ((1 - x) / 2) + right * ((1 + x) / 2)
    return result


def _stationary(above: Array, below: Array) -> Array:
    """Return where N/D may be stationary between -1 and 1.  above, below : (degree + 1,) series of N and D"""
    rising = chebyshev.chebmul(chebyshev.chebder(above), below)
    slope = chebyshev.chebsub(rising, chebyshev.chebmul(above, chebyshev.chebder(below)))
    # leading coefficients that are rounding would be roots far away, and spoil the near ones
    kept = chebyshev.chebtrim(slope, 1e-15 * np.abs(slope).max())
    roots = chebyshev.chebroots(kept).real
    inside: Array = roots[np.abs(roots) < 1]
    return inside
