"""The multivariate normal by a root F of its covariance, C = F Fᵀ.

Readings update only the root, never the covariance itself. So it stays symmetric and positive semidefinite whatever the
order and number of readings, and unobserved directions keep their digits.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.exceptions import CovarianceError
from axiscal.numerics import Array
from axiscal_core.from_scipy import solution, triangle_over

_SYMMETRY = 1e-9
"""Rounding of a correlation that was computed elsewhere; what is no rounding is larger."""
_NEGATIVE = 1e-10
"""Rounding of an eigenvalue, times the size; what is no rounding is larger."""
_EPS = float(np.finfo(np.float64).eps)


def root_of(covariance: Array) -> Array:
    """Return F (n, n) with F Fᵀ the positive semidefinite covariance: upper triangular where it is not singular.

    covariance : (n, n)
    Raises CovarianceError where it is not finite, not symmetric or not positive semidefinite.
    The correlation matrix has the root, so that variances of any scale keep their digits.
    """
    matrix, scale = _checked(covariance)
    try:
        root = np.linalg.cholesky(matrix[::-1, ::-1])[::-1, ::-1]
    except np.linalg.LinAlgError:
        root = _singular_root(matrix)
    return scale[:, None] * root


def lower_root(covariance: Array) -> Array:
    """Return L (n, n) lower triangular with L Lᵀ the positive definite covariance."""
    return np.asarray(np.linalg.cholesky(covariance), dtype=float)


def _singular_root(correlation: Array) -> Array:
    """Return the symmetric root of a singular matrix; eigenvalues of rounding size are zero."""
    values, vectors = np.linalg.eigh(correlation)
    if values[0] < -_NEGATIVE * len(values):
        raise CovarianceError(
            f"The covariance is not positive semidefinite: an eigenvalue of its correlation is {values[0]:.3g}."
        )
    values[values < len(values) * _EPS * values[-1]] = 0.0
    root: Array = (vectors * np.sqrt(values)) @ vectors.T
    root[np.diagonal(correlation) == 0] = 0.0
    return root


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


class Conditioned(NamedTuple):
    """Root and mean after readings, and what was known before each of them.

    expected, variance : (m,) of each row's value without its noise, given the readings that count before it
    losses : (m, n), each row d takes d dᵀ off the covariance; zero where a reading does not count
    """

    root: Array
    mean: Array
    expected: Array
    variance: Array
    losses: Array


def condition(
    root: Array, mean: Array, rows: Array, values: Array, noise: Array, before: NDArray[np.intp]
) -> Conditioned:
    """Return root and mean after the readings value_i = row_iᵀ a + v_i, v_i ~ N(0, noise_i), all at once.

    rows : (m, n); values : (m,); noise : (m,) variances, infinite where a reading does not count
    before : (m,) how many of the readings that count come before each
    With C = F Fᵀ, W = rows F and W Wᵀ + N = L Lᵀ over those that count, row i of X = L⁻¹ W is what reading i takes
    away: C_k = F (1 − Σ_{i≤k} x_i x_iᵀ) Fᵀ, and X Wᵀ is Lᵀ above its diagonal. In the end F R⁻¹ replaces F, with RᵀR =
    1 + Wᵀ N⁻¹ W. Both triangles come from QR of roots, so wide priors keep their digits (Bierman 1977, ch. IV). Of R
    the sharpest readings come first, so that their order does not matter. The same numbers as B&H eq. 21-23 and 31-33.
    """
    counts, seen = np.isfinite(noise), rows @ root
    own, std, left = seen[counts], np.sqrt(noise[counts]), (values - rows @ mean)[counts]
    upper = triangle_over(std, own.T)
    solved = solution(upper.T, np.column_stack([own, left]))
    learnt = np.empty((len(own), len(rows)))
    learnt[:, counts], learnt[:, ~counts] = upper, solved[:, :-1] @ seen[~counts].T
    learnt[np.arange(len(learnt))[:, None] >= before] = 0.0
    variance = np.maximum(np.einsum("ij,ij->i", seen, seen) - np.einsum("ij,ij->j", learnt, learnt), 0.0)
    expected = rows @ mean + solved[:, -1] @ learnt
    losses = np.zeros_like(rows)
    losses[counts] = solved[:, :-1] @ root.T
    size = root.shape[1]
    told = (np.column_stack([own, left]) / std[:, None])[np.argsort(std, kind="stable")]
    triangle = triangle_over(np.append(np.ones(size), 0.0), told)[:size]
    after = solution(triangle[:, :size].T, root.T).T
    return Conditioned(after, mean + after @ triangle[:, size], expected, variance, losses)
