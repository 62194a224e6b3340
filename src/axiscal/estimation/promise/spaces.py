"""The likelihood of sizes and its exact gradient, in two rooms with one interface.

`Unknowns` works with Q = 1 + D Lᵀ (Σ_g A_g/σ_g²) L D, A_g = Z_gᵀ Z_g, whatever the number of readings. `Numbers` works
with K = Σ_f s_f² B_f + σ² of the numbers, whatever the number of unknowns. With Q = F Fᵀ, v = F⁻¹b, u = F⁻ᵀv, W = 1 −
Q⁻¹

    log L = −½(Σ y_gᵀy_g/σ_g² − vᵀv) − Σ log F_ii − Σ n_g log σ_g
    ∂/∂log s_f = |u_f|² − tr W_ff,                    I(f, g) = 2 |W_fg|²
    ∂/∂log l   = ½(uᵀM u − tr M W_bb),                I(l, f) = Σ (M W)∘W over b × f,  I(l, l') = ½ tr(M W M' W')
    ∂/∂log σ_g = |e_g|²/σ_g² − n_g + tr(Q⁻¹ B_g),     I(σ_g, σ_g) ≈ 2 (n_g − tr(Q⁻¹ B_g))

With K = F Fᵀ, a = K⁻¹y and P_f = K⁻¹ ∂K_f the gradient is g = ½(aᵀ∂K_f a − tr P_f). The Fisher information I = ½ Σ P_f
∘ P_gᵀ is that of Gaussian regression (Rasmussen and Williams 2006, eq. 5.9).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.promise.problem import Problem, by_blocks
from axiscal.numerics import Array


class Slope(NamedTuple):
    """log L of θ, its gradient (k,) and the Fisher information (k, k)."""

    value: float
    gradient: Array
    information: Array


class Answered(NamedTuple):
    """Mean (answered,) and covariance (answered, answered) of the answered unknowns, m and rad."""

    mean: Array
    covariance: Array


class Caused(NamedTuple):
    """What causes of type B do at one set of sizes, with B (m, c) of one standard deviation each.

    gains : G B (answered, c) m and rad; fisher : N = BᵀK⁻¹B (c, c); pulled : BᵀK⁻¹y (c,)
    """

    gains: Array
    fisher: Array
    pulled: Array


class Sources(NamedTuple):
    """Mean squares of figures F that the prior of each column leaves, (p,), and the noise of each number, (m,)."""

    columns: Array
    numbers: Array


def parts_of(reading: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """Return the numbers of the readings that have as many of them, (r, k) each.  reading : (m,) ascending"""
    _, first, counts = np.unique(reading, return_index=True, return_counts=True)
    return [first[counts == k][:, None] + np.arange(k) for k in np.unique(counts)]


def variances_of(problem: Problem, theta: Array) -> Array:
    """Return the variances of the numbers, times their own, (m,)."""
    result: Array = np.exp(2 * np.append(theta, 0.0))[problem.groups]
    return result


def factors_of(problem: Problem, theta: Array) -> Array:
    """Return the size of each column, (p,)."""
    result: Array = np.exp(np.append(theta, 0.0))[problem.size_at]
    return result


def times_roots(rows: Array, columns: NDArray[np.intp], lower: Array) -> None:
    """Multiply columns (f, k) of rows (m, p) by the root of each curve (f, k, k), in place."""
    rows[:, columns] = (rows[:, columns].transpose(1, 0, 2) @ lower).transpose(1, 0, 2)


def turned(problem: Problem, rows: Array, theta: Array, roots: Sequence[Array], start: int = 0) -> Array:
    """Return columns from `start` on with their priors applied, (m, p − start): of unknowns of variance one."""
    result = rows[:, start:].copy()
    for curves, lower in zip(problem.curves, roots, strict=True):
        times_roots(result, curves.columns - start, lower)
    result *= factors_of(problem, theta)[start:]
    return result


def raw_cells(problem: Problem, whitened: Array) -> Array:
    """Return rests of cells, (c,) m or rad, from unknowns whose prior is that of one rest over its size."""
    rests: Array = by_blocks(whitened[None], [root.T for root in problem.cell_roots])[0]
    return rests
