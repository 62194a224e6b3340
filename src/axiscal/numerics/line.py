"""The largest ratio N/D along a line, at the ends of its pieces or at a root of N'D − ND' (B&H eq. 27).

The polynomials are never written in powers: numerator and denominator are Chebyshev series on every piece. A piece over
which the denominator spans decades is halved, so that N'D − ND' keeps its digits. Every value that is compared is
evaluated afresh at its place; of equal ones the first counts.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from axiscal.numerics import Array
from axiscal.numerics.ties import TIE, first_best

Forms = Callable[[Array], tuple[Array, Array]]
"""Places (m, 1) -> N and D there, each (m,), D above zero."""

_EPS = float(np.finfo(np.float64).eps)
_SPAN = 1e4
"""Largest ratio of the denominator within one piece: keeps ten digits in N'D − ND'."""
_HALVINGS = 60
"""A piece that is halved so often is one float64."""
_TOLD = 8 * _EPS
"""A coefficient below this share of the largest one is rounding."""


def nodes(count: int) -> Array:
    """Return the `count` Chebyshev nodes of the first kind on (-1, 1), increasing; the ends are not among them."""
    return np.asarray(np.sin(np.pi * (2 * np.arange(count) + 1 - count) / (2 * count)), dtype=np.float64)


def node_count(degree: int, phase: float = 0.0) -> int:
    """Return how many nodes hold a polynomial of `degree` times sin or cos over `phase` rad to rounding.

    phase : the angle that the fastest sine runs through in the interval, rad (0 for a polynomial)
    The series of cos(phase/2 · x) falls as (phase/4)^k / k!, the size of its Bessel coefficients.
    """
    k, term = 0, 1.0
    while term > _EPS / 4 and phase > 0:
        k += 1
        term *= phase / 4 / k
    return degree + 1 + k


def largest_along(forms: Forms, pieces: Array, count: int, known: float = 0.0) -> tuple[float, float]:
    """Return the place along a line where N/D is largest, and how large it is there (B&H eq. 27).

    forms : N and D, which `count` nodes follow on each piece; pieces : (b, 2), at least one
    known : a ratio that some place has: where none has more, less may be returned
    """
    left, right, above, below = _hopeful(_tame(forms, pieces, count), known)
    x = np.stack([_candidates(*each) for each in zip(above, below, strict=True)])
    places = np.clip(left[:, None] * ((1 - x) / 2) + right[:, None] * ((1 + x) / 2), left[:, None], right[:, None])
    numerator, denominator = forms(places.reshape(-1, 1))
    ratios = numerator / denominator
    best = first_best(ratios, TIE)
    return float(places.flat[best]), float(ratios[best])


class _Tame(NamedTuple):
    """Ends of pieces (b,), with series of N and D, (b, count) each, and the largest ratio looked at in each, (b,)."""

    left: Array
    right: Array
    above: Array
    below: Array
    ratios: Array


def _tame(forms: Forms, pieces: Array, count: int) -> _Tame:
    """Return pieces in which the denominator spans no decades."""
    x, (left, right) = np.concatenate([[-1.0], nodes(count), [1.0]]), pieces.T
    series = np.linalg.inv(chebyshev.chebvander(nodes(count), count - 1)).T
    for _ in range(_HALVINGS):
        places = left[:, None] * ((1 - x) / 2) + right[:, None] * ((1 + x) / 2)
        above, below = (each.reshape(places.shape) for each in forms(places.reshape(-1, 1)))
        wild = below.max(axis=1) > _SPAN * below.min(axis=1)
        if not wild.any():
            break
        middle = left[wild] / 2 + right[wild] / 2
        left = np.concatenate([left[~wild], left[wild], middle])
        right = np.concatenate([right[~wild], middle, right[wild]])
    return _Tame(left, right, above[:, 1:-1] @ series, below[:, 1:-1] @ series, (above / below).max(axis=1))


def _hopeful(pieces: _Tame, known: float) -> tuple[Array, ...]:
    """Return the pieces that may hold more than the best that was seen: N − best · D is below zero in all others.

    No series is above its first coefficient by more than the sum of the sizes of the others.
    """
    best = int(pieces.ratios.argmax())
    excess = pieces.above - max(pieces.ratios[best], known) * pieces.below
    kept = excess[:, 0] + np.abs(excess[:, 1:]).sum(axis=1) > 0
    kept[best] = True
    return tuple(part[kept] for part in pieces[:4])


def _candidates(above: Array, below: Array) -> Array:
    """Return both ends of a piece and where N/D may be stationary in it, (2 count,) from −1 to 1."""
    risen = chebyshev.chebmul(chebyshev.chebder(above), below)
    slope = chebyshev.chebsub(risen, chebyshev.chebmul(above, chebyshev.chebder(below)))
    roots = chebyshev.chebroots(chebyshev.chebtrim(slope, _TOLD * np.abs(slope).max()))
    found = np.tile([-1.0, 1.0], len(above))
    found[2 : 2 + len(roots)] = np.clip(roots.real, -1.0, 1.0)
    return found
