"""The multivariate normal in factorised form C = U D Uᵀ: unit upper triangular U, non-negative diagonal D.

Readings update only its factors, never the covariance itself (Bierman 1977, ch. V). So it stays symmetric and positive
semidefinite whatever the order and number of readings, and unobserved directions keep their digits.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.exceptions import CovarianceError
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import transposed_solution, triangle_over

_SYMMETRY = 1e-9
"""Rounding of a correlation that was computed elsewhere; what is no rounding is larger."""
_NEGATIVE = 1e-10
"""Rounding of an eigenvalue, times the size; what is no rounding is larger."""
_EQUAL = 1e-8
"""Eigenvalues that differ by a smaller share are equal: rounding turns their eigenvectors."""
_NEAR = 1e-6
"""Entries of an eigenvector that differ by a smaller share are equally large: rounding decides which is larger."""
_EPS = float(np.finfo(np.float64).eps)


class Factors(NamedTuple):
    """U (n, n) unit upper triangular and d (n,) >= 0 with C = U diag(d) Uᵀ."""

    upper: Array
    diagonal: Array


class Conditioned(NamedTuple):
    """Factors and mean after readings, with the innovation of each at its turn, (m,), and its variance, (m,)."""

    factors: Factors
    mean: Array
    innovation: Array
    variance: Array


def factorise(covariance: Array) -> Factors:
    """Return the UD factors of a positive semidefinite matrix.

    covariance : (n, n), may be singular
    Raises CovarianceError where it is not finite, not symmetric or not positive semidefinite.
    The correlation matrix is factorised, so that variances of any scale keep their digits: by Cholesky from the last
    variable to the first, or by its eigenvectors where it is singular.
    """
    matrix, scale = _checked(covariance)
    try:
        triangle = np.linalg.cholesky(matrix[::-1, ::-1])[::-1, ::-1]
    except np.linalg.LinAlgError:
        return _scaled(_from_root(_singular_root(matrix)), scale)
    pivots = np.diagonal(triangle)
    return _scaled(Factors(triangle / pivots, pivots**2), scale)


def lower_root(covariance: Array) -> Array:
    """Return L (n, n) lower triangular with L Lᵀ the positive definite covariance."""
    root: Array = np.asarray(np.linalg.cholesky(covariance), dtype=float)
    return root


def _scaled(factors: Factors, scale: Array) -> Factors:
    return Factors(factors.upper * scale[:, None] / scale, factors.diagonal * scale**2)


def _singular_root(correlation: Array) -> Array:
    """Return F with F Fᵀ the singular matrix; eigenvalues of rounding size are zero."""
    values, vectors = np.linalg.eigh(correlation)
    if values[0] < -_NEGATIVE * len(values):
        raise CovarianceError(
            f"The covariance is not positive semidefinite: an eigenvalue of its correlation is {values[0]:.3g}."
        )
    values[values < len(values) * _EPS * values[-1]] = 0.0
    root: Array = vectors * np.sqrt(values)
    root[np.diagonal(correlation) == 0] = 0.0
    return root


def _from_root(root: Array) -> Factors:
    """Return the UD factors of F Fᵀ by modified Gram-Schmidt from the last row to the first (Thornton 1976, ch. 4).

    A row that the later ones leave at rounding size adds no variance: its pivot is zero.
    """
    rows, upper, diagonal = root.copy(), np.eye(len(root)), np.zeros(len(root))
    for j in reversed(range(len(root))):
        own = rows[j] @ rows[j]
        if own > (len(root) * _EPS) ** 2:
            upper[:j, j] = rows[:j] @ rows[j] / own
            rows[:j] -= np.outer(upper[:j, j], rows[j])
            diagonal[j] = own
    return Factors(upper, diagonal)


def _checked(covariance: Array) -> tuple[Array, Array]:
    """Return correlation matrix and standard deviations (1 where a variance is zero)."""
    matrix = np.asarray(covariance, dtype=float)
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1]:
        raise CovarianceError(f"A covariance is square; this one has shape {matrix.shape}.")
    if not np.all(np.isfinite(matrix)):
        raise CovarianceError("The covariance holds a value that is not finite.")
    variance = np.diagonal(matrix)
    if np.any(variance < 0):
        raise CovarianceError(
            f"The covariance is not positive semidefinite: variance {int(np.argmin(variance))} is {variance.min():.3g}."
        )
    fixed = variance == 0
    if np.any(matrix[fixed] != 0) or np.any(matrix[:, fixed] != 0):
        raise CovarianceError("The covariance is not positive semidefinite: a variance of zero has covariances.")
    scale = np.where(fixed, 1.0, np.sqrt(variance))
    correlation = matrix / scale[:, None] / scale
    if np.any(np.abs(correlation - correlation.T) > _SYMMETRY):
        raise CovarianceError("The covariance is not symmetric.")
    return (correlation + correlation.T) / 2, scale


def condition(factors: Factors, mean: Array, rows: Array, values: Array, variances: Array) -> Conditioned:
    """Return factors and mean after the readings value_i = row_iᵀ a + v_i, v_i ~ N(0, variance_i), one after another.

    rows : (m, n); values, variances : (m,), variances > 0. O(m n²): the way for a few readings.
    Bierman's scalar update, its column loop written as cumulative sums: with f = Uᵀ row, v = D f and
    α_j = variance + Σ_{k≤j} f_k v_k,   d_j ← d_j α_{j−1}/α_j,   U_j ← U_j − (f_j/α_{j−1}) Σ_{k<j} v_k U_k
    (Bierman 1977, table V.3.1). The same numbers as B&H eq. 21-23 and B&H eq. 31-33, without forming C.
    """
    innovation, expected = np.empty(len(values)), np.empty(len(values))
    for i, (row, variance) in enumerate(zip(rows, variances, strict=True)):
        alpha, sums, changed = _bierman(factors, row, float(variance))
        innovation[i], expected[i] = float(values[i] - row @ mean), float(alpha[-1])
        factors = Factors(changed, factors.diagonal * (alpha[:-1] / alpha[1:]))
        mean = mean + sums[:, -1] * (innovation[i] / alpha[-1])
    return Conditioned(factors, mean, innovation, expected)


def _bierman(factors: Factors, row: Array, variance: float) -> tuple[Array, Array, Array]:
    """Return α (n + 1,), Σ_{k≤j} v_k U_k (n, n) and the new U of one reading."""
    upper, diagonal = factors
    projected = row @ upper
    weighted = diagonal * projected
    alpha = np.empty(len(diagonal) + 1)
    alpha[0] = variance
    np.cumsum(projected * weighted, out=alpha[1:])
    alpha[1:] += variance
    sums = np.cumsum(upper * weighted, axis=1)
    changed = upper.copy()
    changed[:, 1:] -= sums[:, :-1] * (projected[1:] / alpha[1:-1])
    return alpha, sums, changed


def root(factors: Factors) -> Array:
    """Return F (n, n) with C = F Fᵀ."""
    return factors.upper * np.sqrt(factors.diagonal)


def variances(factors: Factors, rows: Array) -> Array:
    """Return rowᵀ C row for each row, never negative (B&H eq. 20).  rows : (m, n)."""
    projected: Array = rows @ root(factors)
    result: Array = np.einsum("ij,ij->i", projected, projected)
    return result


def extend(factors: Factors, extra: Array) -> Factors:
    """Return the factors with independent variables of the given variances appended.  extra : (k,)."""
    size, count = len(factors.diagonal), len(extra)
    upper = np.eye(size + count)
    upper[:size, :size] = factors.upper
    return Factors(upper, np.concatenate([factors.diagonal, extra]))


class AtOnce(NamedTuple):
    """Factors and mean after many readings, and what was known before each of them.

    expected, variance : (m,) of each row's value without its noise, given the readings that count before it
    losses : (m, n), each row d takes d dᵀ off the covariance; zero where a reading does not count
    """

    factors: Factors
    mean: Array
    expected: Array
    variance: Array
    losses: Array


def condition_at_once(
    factors: Factors, mean: Array, rows: Array, values: Array, noise: Array, before: NDArray[np.intp]
) -> AtOnce:
    """Return what `condition` makes of readings one after the other, by matrix products and QR. O(n³ + m n² + m³):
    for hundreds of them the cost of a few, for a few that of hundreds.

    rows : (m, n); values : (m,); noise : (m,) variances, infinite where a reading does not count
    before : (m,) how many of the readings that count come before each
    Let C = S Sᵀ, W = rows S and K = W Wᵀ + N = L Lᵀ over those that count. Row i of X = L⁻¹ W is what reading i takes
    away: C_k = S (1 − Σ_{i≤k} x_i x_iᵀ) Sᵀ, and X Wᵀ is Lᵀ above its diagonal. In the end S R⁻¹ replaces S, with RᵀR =
    1 + Wᵀ N⁻¹ W. Both triangles come from QR of roots, so wide priors keep their digits (Bierman 1977, ch. IV).
    """
    counts, start = np.isfinite(noise), root(factors)
    seen = rows @ start
    own, std, left = seen[counts], np.sqrt(noise[counts]), (values - rows @ mean)[counts]
    upper = triangle_over(std, own.T)
    solved = transposed_solution(upper, np.column_stack([own, left]))
    learnt = np.empty((len(own), len(rows)))
    learnt[:, counts], learnt[:, ~counts] = upper, solved[:, :-1] @ seen[~counts].T
    learnt[np.arange(len(learnt))[:, None] >= before] = 0.0
    variance = np.maximum(np.einsum("ij,ij->i", seen, seen) - np.einsum("ij,ij->j", learnt, learnt), 0.0)
    expected = rows @ mean + solved[:, -1] @ learnt
    after, moved = _after(start, own / std[:, None], left / std)
    losses = np.zeros_like(rows)
    losses[counts] = solved[:, :-1] @ start.T
    return AtOnce(_from_triangle(after, factors), mean + moved, expected, variance, losses)


def _after(start: Array, scaled: Array, left: Array) -> tuple[Array, Array]:
    """Return S R⁻¹ with RᵀR = 1 + scaledᵀ scaled, upper triangular, and the change of the mean."""
    size = start.shape[1]
    triangle = triangle_over(np.append(np.ones(size), 0.0), np.column_stack([scaled, left]))[:size]
    after = transposed_solution(triangle[:, :size], start.T).T
    return after, after @ triangle[:, size]


def _from_triangle(after: Array, before: Factors) -> Factors:
    """Return the UD factors of an upper triangle's product with its transpose; what had no variance gets none."""
    pivots = np.where(before.diagonal > 0, np.diagonal(after), 0.0)
    upper = np.triu(after, 1) / np.where(pivots == 0, 1.0, pivots)
    upper[:, pivots == 0] = 0.0
    np.fill_diagonal(upper, 1.0)
    return Factors(upper, pivots**2)


def unique_root(covariance: Array) -> Array:
    """Return F (..., n, n) with F Fᵀ a covariance of any rank; negative eigenvalues count as zero.

    F is the symmetric root of the correlation matrix times the standard deviations. Eigenvectors alone would leave
    their signs, and turns among equal eigenvalues, to the BLAS at hand: one seed would draw another machine there.
    """
    std = np.sqrt(np.maximum(np.diagonal(covariance, axis1=-2, axis2=-1), 0.0))
    scale = np.where(std > 0, std, 1.0)
    values, vectors = np.linalg.eigh(covariance / scale[..., :, None] / scale[..., None, :])
    half = vectors * np.sqrt(np.maximum(values, 0.0))[..., None, :]
    root: Array = scale[..., :, None] * (half @ np.swapaxes(vectors, -1, -2))
    return root


def settled(values: Array, vectors: Array) -> Array:
    """Return eigenvectors whose signs are settled, and their turn where eigenvalues are equal, (n, k).

    values : (k,), in order; vectors : (n, k), orthonormal
    The first vector of equal ones is the projection of that unit vector which is nearest to all of them, and so on.
    """
    apart = np.abs(np.diff(values)) > _EQUAL * np.abs(values[1:]) + 4 * len(vectors) * _EPS * np.max(np.abs(values))
    found = np.empty_like(vectors)
    for part in np.split(np.arange(len(values)), 1 + np.flatnonzero(apart)):
        left = vectors[:, part]
        for column in part:
            lengths = np.linalg.norm(left, axis=1)
            nearest = np.argmax(lengths > (1 - _NEAR) * lengths.max())  # the first one where several are as near
            found[:, column] = left @ left[nearest] / lengths[nearest]
            left = left - np.outer(found[:, column], found[:, column] @ left)
    return found
