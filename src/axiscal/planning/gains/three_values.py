"""The gain of a reading of several numbers: ΔJ = tr(M⁻¹ N), M = R + G C Gᵀ, N = G C W C Gᵀ.

The numbers share information. As a ratio of two smooth functions of the place the gain is tr(adj(M) N) / det(M). Both
are divided by the same power of the noise, to stay within the range of numbers.
"""

from __future__ import annotations

import numpy as np

from axiscal.numerics import Array

_LOST = 1e-13
"""Share of the largest variance below which rounding may be a thousandth of what is divided by it, or more."""


def joint_forms(above: Array, below: Array, noise: float) -> tuple[Array, Array]:
    """Return numerator and denominator of gains.  above : N (..., k, k); below : M (..., k, k); noise : σ², m²."""
    if above.shape[-1] == 1:
        return above[..., 0, 0], below[..., 0, 0]
    determinant = noise * np.linalg.det(below / noise)
    return determinant * joint_gains(above, below), determinant


def joint_gains(above: Array, below: Array) -> Array:
    """Return tr(M⁻¹ N), (...), number by number: with M = L D Lᵀ it is tr(D⁻¹ L⁻¹ N L⁻ᵀ).

    above : N (..., k, k); below : M (..., k, k), both symmetric.
    Where unknowns are open by metres M spans more than a double holds: what rounding may have left of its smallest
    pivots counts as large enough that rounding decides nothing.
    """
    size = above.shape[-1]
    if size == 1:
        ratio: Array = above[..., 0, 0] / below[..., 0, 0]
        return ratio
    above, below = above.copy(order="K"), below.copy(order="K")
    least, gains = _LOST * np.diagonal(below, axis1=-2, axis2=-1).max(axis=-1), np.zeros(above.shape[:-2])
    for i in range(size):
        pivot = np.maximum(below[..., i, i], least)
        gains += above[..., i, i] / pivot
        for j in range(i + 1, size):
            share = below[..., j, i] / pivot
            below[..., j:, j] -= share[..., None] * below[..., j:, i]
            above[..., j, i:] -= share[..., None] * above[..., i, i:]
            above[..., i:, j] -= share[..., None] * above[..., i:, i]
    return gains
