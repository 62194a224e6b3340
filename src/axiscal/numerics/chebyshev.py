"""The place of the largest ratio of two polynomials, by Chebyshev series and colleague matrices.

B&H eq. 27 picks the next measurement among the interval ends and the real roots of a polynomial. Here the polynomial is
never written in powers: numerator and denominator are Chebyshev series on every interval. The roots of N'D - ND' are
eigenvalues of its colleague matrix. All intervals are one batched eigenvalue problem.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray

from axiscal.exceptions import ShapeError
from axiscal.numerics import Array
from axiscal.numerics.ties import TIE

_EPS = float(np.finfo(np.float64).eps)
_TOLD = 8 * _EPS
"""A coefficient below this share of the largest value is rounding; roots are made exact afterwards."""


@cache
def nodes(count: int) -> Array:
    """Return the `count` Chebyshev nodes of the first kind on (-1, 1), increasing; the ends are not among them."""
    return _fixed(np.sin(np.pi * (2 * np.arange(count) + 1 - count) / (2 * count)))


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


def coefficients(values: Array) -> Array:
    """Return the Chebyshev coefficients (..., n) of the polynomial with these values (..., n) at `nodes(n)`."""
    return values @ _analysis(values.shape[-1])


def resampled(values: Array, count: int) -> Array:
    """Return the values (..., count) at `nodes(count)` of the polynomial with values (..., n) at `nodes(n)`."""
    return values @ _resampling(values.shape[-1], count)


def roots(coefficients: Array) -> NDArray[np.complex128]:
    """Return the roots (b, n - 1) of each series (b, n), as the eigenvalues of its colleague matrix.

    A leading coefficient below rounding is lifted to rounding size instead of being cut off, so the batch keeps one
    size. The roots within reach move by rounding, and surplus roots appear far outside [-1, 1]. A series that is zero
    throughout has no roots to speak of: those of T_{n-1} are returned.
    raises ShapeError : not finite
    """
    if not np.isfinite(coefficients).all():
        raise ShapeError("a Chebyshev series with a coefficient that is not finite has no roots")
    degree = coefficients.shape[-1] - 1
    if degree < 1:
        return np.zeros((len(coefficients), 0), dtype=np.complex128)
    found = np.linalg.eigvals(_colleague(coefficients, degree))
    return found.astype(np.complex128, copy=False)


def maximise_ratio(numerator: Array, denominator: Array) -> tuple[Array, Array]:
    """Return where on [-1, 1], ends included, each ratio N/D is largest, and how large: (b,), (b,) (B&H eq. 27).

    numerator : (b, p + 1), values at `nodes(p + 1)` of polynomials of degree p
    denominator : (b, q + 1), likewise; positive on [-1, 1], and not resolved below rounding of its largest value
    raises ShapeError : not finite, or a denominator that is not positive
    """
    check_forms(numerator, denominator)
    scale_n, scale_d = _largest(numerator), _largest(denominator)
    n, d = coefficients(numerator / scale_n), coefficients(denominator / scale_d)
    position, value = _polished(n, d, _best(n, d, _candidates(_shortened(n), _shortened(d))))
    return position, value * (scale_n / scale_d)[:, 0]


def check_forms(numerator: Array, denominator: Array) -> None:
    """Raise ShapeError unless all values are finite and the denominator is positive."""
    if not (np.isfinite(numerator).all() and np.isfinite(denominator).all()):
        raise ShapeError("a ratio with values that are not finite has no largest value")
    if not (denominator > 0).all():
        raise ShapeError("the denominator of a ratio must be positive")


def _largest(values: Array) -> Array:
    """Return the largest magnitude in each row, 1 where a row is zero: (b, 1)."""
    largest = np.abs(values).max(axis=1, keepdims=True)
    return np.where(largest > 0, largest, 1.0)


def _shortened(series: Array) -> Array:
    """Return the series (b, n) without the last terms that are rounding in all of them: roots cost its third power."""
    told = np.flatnonzero(np.any(np.abs(series) > _TOLD, axis=0))
    return series[:, : max(2, int(told.max(initial=0)) + 1)]


def _candidates(n: Array, d: Array) -> Array:
    """Return the ends and the real parts of all roots of N'D - ND', clipped to [-1, 1]: (b, k).

    Real parts of complex roots do no harm as candidates, and a double root that rounding has split is not lost.
    """
    p, q = n.shape[1] - 1, d.shape[1] - 1
    degree = p + q - (2 if p == q else 1)
    if degree < 1:
        return np.tile([-1.0, 1.0], (len(n), 1))
    slope = _stationary(n, d, degree + 1)
    inside = np.clip(roots(coefficients(slope / _largest(slope))).real, -1.0, 1.0)
    return np.concatenate([np.full((len(n), 1), -1.0), np.full((len(n), 1), 1.0), inside], axis=1)


def _stationary(n: Array, d: Array, count: int) -> Array:
    """Return N'D - ND' at `nodes(count)`: (b, count). For equal degrees its leading term cancels."""
    at_n, at_d = _synthesis(n.shape[1], count), _synthesis(d.shape[1], count)
    slope_n, slope_d = _slope_synthesis(n.shape[1], count), _slope_synthesis(d.shape[1], count)
    return (n @ slope_n) * (d @ at_d) - (n @ at_n) * (d @ slope_d)


def _at(x: Array, size: int) -> Array:
    """Return the Chebyshev polynomials T_0 … T_{size-1} at x (b, k): (b, size, k)."""
    return np.cos(np.arange(size)[:, None] * np.arccos(x)[:, None, :])


def _best(n: Array, d: Array, x: Array) -> Array:
    """Return the position in each row of x (b, k) where N/D is largest, the lowest of several: (b,)."""
    shapes = _at(x, max(n.shape[1], d.shape[1]))
    ratio = _quotient(_sum(n, shapes), _sum(d, shapes))
    best = ratio.max(axis=1, keepdims=True)
    found: Array = np.where(ratio >= best - TIE * np.abs(best), x, np.inf).min(axis=1)
    return found


def _polished(n: Array, d: Array, x: Array) -> tuple[Array, Array]:
    """Return positions and ratios after two Newton steps on N'D - ND', each kept only where the ratio does not fall."""
    series = _with_derivatives(n), _with_derivatives(d)
    above, below = (_jet(s, x) for s in series)
    for _ in range(2):
        slope = above[1] * below[0] - above[0] * below[1]
        bend = above[2] * below[0] - above[0] * below[2]
        step = np.divide(slope, bend, out=np.zeros_like(slope), where=np.abs(bend) > np.abs(slope))
        moved = np.where(np.abs(x) < 1, np.clip(x - step, -1.0, 1.0), x)
        next_above, next_below = (_jet(s, moved) for s in series)
        better = _quotient(next_above[0], next_below[0]) > _quotient(above[0], below[0])
        x = np.where(better, moved, x)
        above, below = np.where(better, next_above, above), np.where(better, next_below, below)
    return x, _quotient(above[0], below[0])


def _quotient(above: Array, below: Array) -> Array:
    """Return N/D; a D below the rounding of its largest value counts as that rounding."""
    return above / np.maximum(below, _EPS)


def _sum(series: Array, shapes: Array) -> Array:
    """Return series (b, n) times shapes (b, >= n, k): (b, k)."""
    return (series[:, None, :] @ shapes[:, : series.shape[1]])[:, 0]


def _with_derivatives(series: Array) -> Array:
    """Return series, first and second derivative, padded to one length: (b, 3, n)."""
    size = series.shape[1]
    padded: Array = np.einsum("bn,nim->bim", series, _jets(size))
    return padded


def _jet(series: Array, x: Array) -> Array:
    """Return value, first and second derivative at x (b,): (3, b)."""
    values: Array = (series @ _at(x[:, None], series.shape[2]))[:, :, 0]
    return values.T


def _colleague(coefficients: Array, degree: int) -> Array:
    """Return the colleague matrices (b, degree, degree), turned so that balancing meets the large entries last."""
    c = coefficients / _largest(coefficients)
    lead = np.where(np.abs(c[:, -1]) < _EPS, np.copysign(_EPS, c[:, -1]), c[:, -1])
    frame, weight = _frame(degree)
    matrix = np.repeat(frame[None], len(c), axis=0)
    matrix[:, :, -1] -= c[:, :-1] / lead[:, None] * weight
    return matrix[:, ::-1, ::-1]


@cache
def _frame(degree: int) -> tuple[Array, Array]:
    """Return the part of the colleague matrix that all series share, and the weights of its last column."""
    if degree == 1:
        return np.zeros((1, 1)), np.ones(1)
    half = np.full(degree - 1, 0.5)
    half[0] = math.sqrt(0.5)
    weight = np.full(degree, 0.5)
    weight[0] = math.sqrt(0.5)
    return np.diag(half, 1) + np.diag(half, -1), weight


@cache
def _angles(count: int) -> Array:
    return np.pi * (2 * np.arange(count)[::-1] + 1) / (2 * count)


@cache
def _analysis(count: int) -> Array:
    """Return the matrix (count, count) from values at the nodes to coefficients (right factor)."""
    matrix = 2 / count * np.cos(np.outer(_angles(count), np.arange(count)))
    matrix[:, 0] /= 2
    return _fixed(matrix)


@cache
def _synthesis(size: int, count: int) -> Array:
    """Return the matrix (size, count) from coefficients to values at `nodes(count)`."""
    return _fixed(np.cos(np.outer(np.arange(size), _angles(count))))


@cache
def _resampling(size: int, count: int) -> Array:
    return _fixed(_analysis(size) @ _synthesis(size, count))


@cache
def _slope(size: int) -> Array:
    """Return the matrix (size, size - 1) from coefficients to those of the derivative."""
    matrix = np.zeros((size, max(size - 1, 1)))
    for k in range(size):
        matrix[k, k - 1 :: -2] = 2 * k if k else 0
    matrix[:, 0] /= 2
    return _fixed(matrix)


@cache
def _jets(size: int) -> Array:
    """Return the maps (size, 3, size) to a series, its first and its second derivative (right factors)."""
    slope = np.zeros((size, size))
    slope[:, : max(size - 1, 1)] = _slope(size)
    return _fixed(np.stack([np.eye(size), slope, slope @ slope], axis=1))


@cache
def _slope_synthesis(size: int, count: int) -> Array:
    return _fixed(_slope(size) @ _synthesis(max(size - 1, 1), count))


def _fixed(matrix: Array) -> Array:
    matrix.setflags(write=False)
    return matrix
