"""Numerator and denominator of the gain of readings, from their rows."""

from __future__ import annotations

import numpy as np

from axiscal.numerics import Array


def gain_forms(rows: Array, factor: Array, weighted: Array, variance: float | Array) -> tuple[Array, Array]:
    """Return N = gᵀCWCg and D = σ² + gᵀCg, each (m,).

    rows : (m, n), the g; factor : (n, r), F with C = F Fᵀ; weighted : (w, r), W^½ F; variance : σ², scalar or (m,)
    """
    along = rows @ factor
    return np.sum((along @ weighted.T) ** 2, axis=1), variance + np.sum(along**2, axis=1)
