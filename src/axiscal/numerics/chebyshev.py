"""The exact step: where a ratio of two functions is largest, by Chebyshev interpolation and colleague matrices.

B&H eq. 27 picks the next measurement among the interval ends and the real roots of a polynomial. Here the polynomial
is never written in powers: numerator and denominator are held as Chebyshev series on every interval, the roots of
N'D - ND' are eigenvalues of its colleague matrix, and all intervals are one batched eigenvalue problem.
`maximise_along` wraps that in what keeps rounding errors negligible: intervals over which the denominator spans
decades, or that the series does not follow, are halved; intervals that provably hold no better value are left out;
and every value returned has been evaluated afresh at its position.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from axiscal.exceptions import ShapeError
from axiscal.numerics import Array

Forms = Callable[[Array, NDArray[np.intp]], tuple[Array, Array]]
"""(positions (b, k), interval (b,)) -> numerator and denominator there, each (b, k); denominator positive."""

_EPS = float(np.finfo(np.float64).eps)
_SPAN = 1e4
"""Largest ratio of the denominator within one interval before it is halved: keeps ten digits in N'D - ND'."""
_MISFIT = 1e-10
"""Largest relative difference of series and fresh value before an interval is halved."""
_HALVINGS = 60


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


def evaluate(coefficients: Array, x: Array) -> Array:
    """Return each series (b, n) at its own positions (b, k) by Clenshaw's rule: (b, k)."""
    first = np.zeros_like(x)
    second = np.zeros_like(x)
    for c in coefficients.T[:0:-1, :, None]:
        first, second = c + 2 * x * first - second, first
    result: Array = coefficients[:, :1] + x * first - second
    return result


def derivative(coefficients: Array) -> Array:
    """Return the series (..., n - 1) of the derivative of each series (..., n); of a constant, zero (..., 1)."""
    return coefficients @ _slope(coefficients.shape[-1])


def roots(coefficients: Array) -> NDArray[np.complex128]:
    """Return the roots (b, n - 1) of each series (b, n), as the eigenvalues of its colleague matrix.

    A leading coefficient below rounding is lifted to rounding size instead of being cut off: the batch keeps one size,
    the roots within reach move by rounding, and the roots that are not there appear far outside [-1, 1].
    A series that is zero throughout has no roots to speak of: those of T_{n-1} are returned.
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
    denominator : (b, q + 1), likewise; positive on [-1, 1]
    raises ShapeError : not finite, or a denominator that is not positive
    """
    _check_forms(numerator, denominator)
    scale_n, scale_d = _largest(numerator), _largest(denominator)
    n, d = coefficients(numerator / scale_n), coefficients(denominator / scale_d)
    position = _best(n, d, _candidates(n, d))
    position = _polished(n, d, position)
    value = _ratio(n, d, position[:, None])[:, 0]
    return position, value * (scale_n / scale_d)[:, 0]


def maximise_along(
    forms: Forms, left: Array, right: Array, count: int, group: NDArray[np.intp] | None = None
) -> tuple[Array, Array]:
    """Return the best position and value of N/D found in each interval: (b,), (b,) (B&H eq. 27).

    forms : evaluates N and D afresh; smooth inside each interval
    left, right : (b,) ends of the intervals, in the unit of position
    count : nodes per interval: degree + 1 for polynomials, `node_count` with sines
    group : (b,) which search an interval belongs to (default: all one). In each group the best interval is exact;
        in an interval that cannot hold the best of its group the best node is returned.
    raises ShapeError : a value that is not finite, or a denominator that is not positive
    """
    owner = np.arange(len(left))
    search = _Search.begin(forms, left, np.zeros_like(owner) if group is None else group)
    for halvings in range(_HALVINGS):
        work = search.sample(left, right, owner, count)
        left, right, owner = search.solve(work, last=halvings == _HALVINGS - 1)
        if len(owner) == 0:
            break
    return search.position, search.value


def gain_forms(rows: Array, factor: Array, weighted: Array, variance: float | Array) -> tuple[Array, Array]:
    """Return N = gᵀCWCg and D = σ² + gᵀCg, each (m,), as sums of squares, so that neither loses its small values.

    rows : (m, n), the g; factor : (n, r), F with C = F Fᵀ; weighted : (w, r), W^½ F; variance : σ², scalar or (m,)
    """
    along = rows @ factor
    reach = along @ weighted.T
    return np.einsum("ij,ij->i", reach, reach), variance + np.einsum("ij,ij->i", along, along)


@dataclass(frozen=True, slots=True)
class _Work:
    """Intervals with numerator and denominator at their nodes."""

    left: Array
    right: Array
    owner: NDArray[np.intp]
    numerator: Array
    denominator: Array

    def take(self, keep: NDArray[np.bool_]) -> _Work:
        return _Work(self.left[keep], self.right[keep], self.owner[keep], self.numerator[keep], self.denominator[keep])

    def at(self, x: Array) -> Array:
        """Return the positions of local coordinates x (b, k), exact at the ends."""
        return self.left[:, None] * ((1 - x) / 2) + self.right[:, None] * ((1 + x) / 2)

    def halves(self, cut: NDArray[np.bool_]) -> tuple[Array, Array, NDArray[np.intp]]:
        """Return both halves of the intervals to cut; those too short to be cut are dropped."""
        left, right, owner = self.left[cut], self.right[cut], self.owner[cut]
        middle = left / 2 + right / 2
        wide = (middle > left) & (middle < right)
        left, right, owner, middle = left[wide], right[wide], owner[wide], middle[wide]
        return np.concatenate([left, middle]), np.concatenate([middle, right]), np.concatenate([owner, owner])


@dataclass(slots=True)
class _Search:
    """The best found so far, per interval and per group."""

    forms: Forms
    group: NDArray[np.intp]
    position: Array
    value: Array
    best: Array

    @classmethod
    def begin(cls, forms: Forms, left: Array, group: NDArray[np.intp]) -> _Search:
        groups = int(group.max(initial=-1)) + 1
        return cls(forms, group, left.copy(), np.full(len(left), -np.inf), np.full(groups, -np.inf))

    def offer(self, position: Array, owner: NDArray[np.intp]) -> tuple[Array, Array]:
        """Evaluate afresh at positions (b, k) and keep what is better."""
        numerator, denominator = self.forms(position, owner)
        _check_forms(numerator, denominator)
        ratio = numerator / denominator
        pick = np.arange(len(owner)), ratio.argmax(axis=1)
        value, where = ratio[pick], position[pick]
        order = np.argsort(value, kind="stable")
        better = order[value[order] > self.value[owner[order]]]
        self.position[owner[better]], self.value[owner[better]] = where[better], value[better]
        np.maximum.at(self.best, self.group[owner], value)
        return numerator, denominator

    def sample(self, left: Array, right: Array, owner: NDArray[np.intp], count: int) -> _Work:
        """Evaluate at the ends and the nodes of every interval."""
        empty = np.zeros((len(left), 0))
        points = np.concatenate([[-1.0], nodes(count), [1.0]])
        numerator, denominator = self.offer(_Work(left, right, owner, empty, empty).at(points[None, :]), owner)
        return _Work(left, right, owner, numerator[:, 1:-1], denominator[:, 1:-1])

    def solve(self, work: _Work, last: bool) -> tuple[Array, Array, NDArray[np.intp]]:
        """Solve every interval that is tame, and return the halves of those that are not."""
        work = work.take(self._hopeful(work))
        wild = np.zeros(len(work.owner), dtype=bool) if last else _span(work.denominator) > _SPAN
        tame = work.take(~wild)
        left, right, owner = work.halves(wild)
        if len(tame.owner) == 0:
            return left, right, owner
        again = tame.halves(self._solved(tame) & (not last))
        return np.concatenate([left, again[0]]), np.concatenate([right, again[1]]), np.concatenate([owner, again[2]])

    def _solved(self, work: _Work) -> NDArray[np.bool_]:
        """Offer the stationary points of the intervals; return which of them the series did not follow."""
        x, claimed = maximise_ratio(work.numerator, work.denominator)
        position = work.at(x[:, None])
        inner = np.abs(x) < 1
        numerator, denominator = self.offer(position, work.owner)
        fresh = numerator[:, 0] / denominator[:, 0]
        return inner & (np.abs(fresh - claimed) > _MISFIT * np.maximum(np.abs(fresh), np.abs(claimed)))

    def _hopeful(self, work: _Work) -> NDArray[np.bool_]:
        """Return which intervals may hold more than the best of their group.

        P = N - best·D is negative throughout the others: between 4n Chebyshev nodes a polynomial of degree below n
        rises at most 1/cos(π/8) - 1 of its half range above its largest sample (Ehlich and Zeller 1964).
        """
        best = self.best[self.group[work.owner]][:, None]
        excess = (work.numerator - best * work.denominator) @ _refinement(work.numerator.shape[1])
        high, low = excess.max(axis=1), excess.min(axis=1)
        size = np.maximum(np.abs(work.numerator), np.abs(best) * work.denominator).max(axis=1)
        bound = high + (high - low) / 2 * (1 / math.cos(math.pi / 8) - 1)
        hopeful: NDArray[np.bool_] = bound > -64 * _EPS * size
        return hopeful


def _check_forms(numerator: Array, denominator: Array) -> None:
    if not (np.isfinite(numerator).all() and np.isfinite(denominator).all()):
        raise ShapeError("a ratio with values that are not finite has no largest value")
    if not (denominator > 0).all():
        raise ShapeError("the denominator of a ratio must be positive")


def _largest(values: Array) -> Array:
    """Return the largest magnitude in each row, 1 where a row is zero: (b, 1)."""
    largest = np.abs(values).max(axis=1, keepdims=True)
    return np.where(largest > 0, largest, 1.0)


def _span(denominator: Array) -> Array:
    span: Array = denominator.max(axis=1) / denominator.min(axis=1)
    return span


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


def _ratio(n: Array, d: Array, x: Array) -> Array:
    """Return N/D at x (b, k); nowhere the largest where rounding has made D vanish."""
    below = evaluate(d, x)
    return np.where(below > _EPS, evaluate(n, x) / np.where(below > _EPS, below, 1.0), -np.inf)


def _best(n: Array, d: Array, x: Array) -> Array:
    found: Array = np.take_along_axis(x, _ratio(n, d, x).argmax(axis=1)[:, None], axis=1)[:, 0]
    return found


def _polished(n: Array, d: Array, x: Array) -> Array:
    """Return the positions after two Newton steps on N'D - ND', each kept only where the ratio does not fall."""
    n1, d1 = derivative(n), derivative(d)
    n2, d2 = derivative(n1), derivative(d1)
    for _ in range(2):
        at = x[:, None]
        above, below = evaluate(n, at), evaluate(d, at)
        slope = evaluate(n1, at) * below - above * evaluate(d1, at)
        bend = evaluate(n2, at) * below - above * evaluate(d2, at)
        step = np.divide(slope, bend, out=np.zeros_like(slope), where=np.abs(bend) > np.abs(slope))
        moved = np.where(np.abs(at) < 1, np.clip(at - step, -1.0, 1.0), at)
        x = np.where(_ratio(n, d, moved) > above / np.maximum(below, _EPS), moved, at)[:, 0]
    return x


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
def _slope(size: int) -> Array:
    """Return the matrix (size, size - 1) from coefficients to those of the derivative."""
    matrix = np.zeros((size, max(size - 1, 1)))
    for k in range(size):
        matrix[k, k - 1 :: -2] = 2 * k if k else 0
    matrix[:, 0] /= 2
    return _fixed(matrix)


@cache
def _slope_synthesis(size: int, count: int) -> Array:
    return _fixed(_slope(size) @ _synthesis(max(size - 1, 1), count))


@cache
def _refinement(count: int) -> Array:
    """Return the matrix (count, 4 count) from values at `nodes(count)` to values at `nodes(4 count)`."""
    return _fixed(_analysis(count) @ _synthesis(count, 4 * count))


def _fixed(matrix: Array) -> Array:
    matrix.setflags(write=False)
    return matrix
