"""Functions of scipy that are used here, loaded at the first call: most commands save the half second that this takes.

scipy brings a second BLAS, limited to one thread like that of numpy.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from axiscal_core.refusals import Array
from axiscal_core.threads import hold_loaded_libraries

_COLUMNS = 32  # of a QR at a time; twice or half as many take as long
_EXACT = 1e-12  # changes by less are rounding of a mode


@cache
def _function(module: str, name: str) -> Callable[..., Any]:
    found: Callable[..., Any] = getattr(import_module(module), name)
    hold_loaded_libraries()
    return found


def _later(module: str, name: str, **how: object) -> Callable[..., Any]:
    """Return a function that is loaded at its first call.  how : named arguments of each"""
    return lambda *given: _function(module, name)(*given, **how)


chi_square_tail: Callable[[float, float], float] = _later("scipy.special", "chdtrc")
"""The probability that a chi-square of these degrees of freedom is at least a value."""
chi_square_share: Callable[[Array, Array], Array] = _later("scipy.special", "chdtr")
"""The probability that a chi-square of degrees of freedom, (m,), any above zero, is at most values, (m,)."""
f_quantile: Callable[[float, float, float], float] = _later("scipy.special", "fdtri")
"""What an F of degrees of freedom above and below is at most with a probability."""
normal_share: Callable[[Array], Array] = _later("scipy.special", "ndtr")
"""Φ(x), of the shape of x."""
normal_quantile: Callable[[Array], Array] = _later("scipy.special", "ndtri")
"""x with Φ(x) = a share, of the shape of the share."""
log_normal_share: Callable[[Array], Array] = _later("scipy.special", "log_ndtr")
"""log Φ(x), also far out in the tail, of the shape of x."""
_triangle = "scipy.linalg", "solve_triangular"
solution: Callable[[Array, Array], Array] = _later(*_triangle, lower=True, check_finite=False)
"""L⁻¹ b, (n,) or (n, m), of L (n, n), lower triangular, and b (n,) or (n, m)."""
back_solution: Callable[[Array, Array], Array] = _later(*_triangle, lower=True, trans="T", check_finite=False)
"""L⁻ᵀ b, of the same."""


def chi_square_quantile(degrees: Array, share: float) -> Array:
    """Return what a chi-square is at most with probability `share`, (m,).  degrees : (m,) of freedom"""
    return np.asarray(_function("scipy.special", "chdtri")(degrees, 1 - share))


def binomial_tail(least: int, count: int, share: float) -> float:
    """Return the probability that at least `least` of `count` events happen, each with probability `share`."""
    return float(_function("scipy.special", "bdtrc")(least - 1, count, share))


def triangle_over(own: Array, below: Array) -> Array:
    """Return R, upper triangular, with RᵀR = diag(own)² + belowᵀ below, (n, n), by QR of the one over the other.

    own : (n,); below : (m, n). What is nought over the diagonal is not worked through: 2 m n² operations.
    """
    upper, other = np.asfortranarray(np.diag(own)), np.asfortranarray(below)
    if not below.size:
        return upper
    found = _function("scipy.linalg.lapack", "dtpqrt")(0, min(_COLUMNS, len(own)), upper, other, overwrite_a=1)
    return np.asarray(found[0])


def solution_of_product(lower: Array, right: Array) -> Array:
    """Return (L Lᵀ)⁻¹ b, (n,) or (n, m).  lower : (n, n), lower triangular; right : (n,) or (n, m)"""
    return np.asarray(_function("scipy.linalg", "cho_solve")((lower, True), right, check_finite=False))


def take_off(table: Array, left: Array, right: Array) -> None:
    """Subtract a product of low rank from a table in place, row by row in memory: 2 m k j operations, 16 m k bytes.

    table : (m, k); left : (m, j); right : (j, k)
    """
    _function("scipy.linalg.blas", "dgemm")(-1.0, right.T, left.T, beta=1.0, c=table.T, overwrite_c=1)


def least_squares(
    left: Callable[[Array], Array], slopes: Callable[[Array], Array], start: Array
) -> tuple[Array, float]:
    """Return where a start leads that makes the sum of squares small, (k,), and half that sum, by trust regions.

    left : (k,) → (m,); slopes : its derivatives (m, k); start : (k,)
    """
    solve = _function("scipy.optimize", "least_squares")
    found = solve(left, start, slopes, ftol=_EXACT, xtol=_EXACT, gtol=_EXACT)
    return np.asarray(found.x, dtype=float), float(found.cost)


def sparse_product(
    values: Array, rows: NDArray[np.intp], columns: NDArray[np.intp], shape: tuple[int, int]
) -> Callable[[Array], Array]:
    """Return what makes S B, (m,) or (m, k), of B (n,) or (n, k) with a matrix S (m, n) of few entries.

    values, rows, columns : (entries,) and where each stands
    """
    stored = _function("scipy.sparse", "csc_array")((values, (rows, columns)), shape=shape)
    stored.eliminate_zeros()
    product: Callable[[Array], Array] = stored.dot
    return product


def sparse_solution(values: Array, rows: NDArray[np.intp], columns: NDArray[np.intp], right: Array) -> Array:
    """Return S⁻¹ b, (n,) or (n, k), of a matrix S (n, n) of few entries; those of one place add up.

    values, rows, columns : (entries,) and where each stands; right : (n,) or (n, k)
    """
    stored = _function("scipy.sparse", "csc_array")((values, (rows, columns)), shape=(len(right), len(right)))
    return np.asarray(_function("scipy.sparse.linalg", "splu")(stored).solve(right))


def root_in_place(matrix: Array) -> Array | None:
    """Return F with F Fᵀ the symmetric matrix that has this lower triangle, (n, n); None where it has none.

    matrix : (n, n), in rows; its memory becomes that of F
    """
    if not matrix.size:
        return matrix
    upper, fault = _function("scipy.linalg.lapack", "dpotrf")(matrix.T, lower=0, overwrite_a=1)
    return None if fault else upper.T


def inverse_of_product(lower: Array) -> Array:
    """Return (L Lᵀ)⁻¹, (n, n).  lower : (n, n), lower triangular"""
    if not lower.size:
        return lower.copy()  # which LAPACK refuses
    # what stands in rows is the transpose of what LAPACK reads in columns: without a copy its upper triangle
    half = np.triu(_function("scipy.linalg.lapack", "dpotri")(lower.T, lower=0)[0])
    return np.asarray(half + np.triu(half, 1).T)


def lowest(
    objective: Callable[[Array], tuple[float, Array]], start: Array, low: float, high: float, steps: int
) -> Array:
    """Return where L-BFGS-B finds the least value in the box from `low` to `high` in every coordinate, (n,).

    objective : gives value and gradient, (n,); start : (n,); steps : iterations at most
    """
    bounds, options = [(low, high)] * len(start), {"maxiter": steps}
    minimize = _function("scipy.optimize", "minimize")
    return np.asarray(minimize(objective, start, jac=True, method="L-BFGS-B", bounds=bounds, options=options).x)
