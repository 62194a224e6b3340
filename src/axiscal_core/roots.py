"""The largest ratio N/D along a line, at the ends of its pieces or at a root of N'D − ND' (B&H eq. 27).

>>> largest(lambda t: (t * (1 - t), np.ones_like(t)), np.array([0.0, 1.0]), count=3)
(0.5, 0.25)

The polynomials are never written in powers: numerator and denominator are Chebyshev series on every piece. A piece over
which the denominator spans decades is halved, so that N'D − ND' keeps its digits. Every value that is compared is
evaluated afresh at its place; of equal ones the first counts.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import chebyshev

from axiscal_core.refusals import Array
from axiscal_core.ties import TIE, first_best

Forms = Callable[[Array], tuple[Array, Array]]
"""Places (m,) -> N and D there, (m,) each, D above zero."""

_EPS = float(np.finfo(np.float64).eps)
_SPAN = 1e4  # largest ratio of the denominator within one piece: keeps ten digits in N'D − ND'
_HALVINGS = 60  # a piece that is halved so often is one float64
_PIECES = 10_000  # a zero of D takes two for each halving; where D itself is rounding all would be halved without end
_TOLD = 8 * _EPS  # a coefficient below this share of the largest one is rounding
_FOLLOWED = 1e-9  # of the largest value: a series that is off by more between its nodes is not that of N or D
_BETWEEN = np.array([-0.83, 0.29])  # where that is looked at: at no node of any count
_INSIDE = 1e-9  # of a piece: what N and D are at a break belongs to the piece on one side only


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


def largest(forms: Forms, breaks: Array, count: int, known: float = 0.0) -> tuple[float, float] | None:
    """Return the place along a line where N/D is largest, and how large it is there (B&H eq. 27).

    None where `count` nodes do not follow N and D between breaks.
    breaks : (b,) ascending; known : a ratio that some place has: where none has more, less may be returned
    """
    left, right, above, below = _tame(forms, breaks, count)
    to_series = np.linalg.inv(chebyshev.chebvander(nodes(count), count - 1)).T
    n, d = above[:, :count] @ to_series, below[:, :count] @ to_series
    for mine, true in ((n, above), (d, below)):
        if np.abs(chebyshev.chebval(_BETWEEN, mine.T) - true[:, count:]).max() > _FOLLOWED * np.abs(true).max():
            return None
    ratios = (above / below).max(axis=1)
    best = int(ratios.argmax())
    excess = n - max(ratios[best], known) * d
    # no series is above its first coefficient by more than the sizes of the others: elsewhere is nothing better
    kept = excess[:, 0] + np.abs(excess[:, 1:]).sum(axis=1) > 0
    kept[best] = True
    x = np.stack([_candidates(*each) for each in zip(n[kept], d[kept], strict=True)])
    places = np.clip(_placed(left[kept], right[kept], x), left[kept, None], right[kept, None])
    numerator, denominator = forms(places.ravel())
    ratios = numerator / denominator
    best = first_best(ratios, TIE)
    return float(places.flat[best]), float(ratios[best])


def _tame(forms: Forms, breaks: Array, count: int) -> tuple[Array, Array, Array, Array]:
    """Return ends of pieces in which D spans no decades, (b,), and N and D at nodes and between, (b, count + 2)."""
    x, left, right = np.concatenate([nodes(count), _BETWEEN]), breaks[:-1], breaks[1:]
    for _ in range(_HALVINGS):
        above, below = (each.reshape(-1, len(x)) for each in forms(_placed(left, right, x).ravel()))
        wild = below.max(axis=1) > _SPAN * below.min(axis=1)
        if not wild.any() or len(left) > _PIECES:
            break
        middle = left[wild] / 2 + right[wild] / 2
        left = np.concatenate([left[~wild], left[wild], middle])
        right = np.concatenate([right[~wild], middle, right[wild]])
    return left, right, above, below


def _placed(left: Array, right: Array, x: Array) -> Array:
    """Return places in pieces, (b, n).  left, right : (b,); x : (n,) or (b, n) from −1 to 1"""
    return np.asarray(left[:, None] * ((1 - x) / 2) + right[:, None] * ((1 + x) / 2))


def _candidates(above: Array, below: Array) -> Array:
    """Return both ends of a piece and where N/D may be stationary in it, (2 count + 4 or so,) from −1 to 1."""
    risen = chebyshev.chebmul(chebyshev.chebder(above), below)
    slope = chebyshev.chebsub(risen, chebyshev.chebmul(above, chebyshev.chebder(below)))
    roots = chebyshev.chebroots(chebyshev.chebtrim(slope, _TOLD * np.abs(slope).max()))
    found = np.tile([-1.0, 1.0, _INSIDE - 1.0, 1.0 - _INSIDE], (len(above) + 1) // 2 + 1)
    found[4 : 4 + len(roots)] = np.clip(roots.real, -1.0, 1.0)
    return found
