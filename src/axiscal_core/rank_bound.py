"""What no plan of as many readings can beat, wherever they are taken and however little noise they have.

A number takes a covariance of rank one off. So k numbers leave V C Vᵀ = A − B of A = V C₀ Vᵀ, where B has rank k at
most, and no eigenvalue of A − B is below that of A which is k places further down (Weyl 1912):

    tr(V C Vᵀ) ≥ Σ_{i > k} λ_i(A),    λ₁ ≥ λ₂ ≥ …

It is equality where k readings without noise show the k first principal directions of A. The bound knows no noise, no
zero of a set-up and no place. So it is sharp for few, precise readings, and says nothing for many.
"""

from __future__ import annotations

import numpy as np

from axiscal_core.refusals import Array

_WORTH = 0.5
"""Share of a plan's RMS below which a bound tells nobody how good the plan is; any share near would do."""
_ROUNDING = 1e-12
"""Share of tr A that sums of its eigenvalues are not known to, in float64, with room."""


def rank_bound(spread: Array, numbers: int) -> float:
    """Return the least tr(V C Vᵀ) after so many numbers, m².  spread : A (w, w), m², symmetric"""
    values = np.linalg.eigvalsh(spread)[::-1]
    return max(float(np.sum(values[numbers:])) - _ROUNDING * float(np.trace(spread)), 0.0)


def worth_saying(bound: float, rms: float) -> float | None:
    """Return a bound on the RMS that stands beside that of a plan; None where it is below half of it."""
    return bound if bound >= _WORTH * rms else None
