"""Gains of single readings under one belief: ΔJ = gᵀCWCg / (σ² + gᵀCg), from one product with [F, C Vᵀ].

That of a reading of several numbers is ΔJ = tr(M⁻¹ N), M = R + G C Gᵀ, N = G C W C Gᵀ. The numbers share information.
As a ratio of two smooth functions of the place the gain is tr(adj(M) N) / det(M). Both are divided by the same power of
the noise, to stay within the range of numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.measurement.observation import JointRows, Observation
from axiscal.measurement.reading import Places
from axiscal.numerics import Array

_BLOCK = 4096
"""Rows made at once: of memory, not of the result."""


@dataclass(frozen=True, eq=False, slots=True)
class Scorer:
    """Gains under one belief.

    factor : F (n, r) with C = F Fᵀ; weighted : V F (w, r); both : [F, C Vᵀ], (n, r + w)
    """

    observation: Observation
    factor: Array
    weighted: Array
    both: Array

    def widened(self, columns: Array, reach: Array) -> Scorer:
        """Return the gains where the covariance is larger by D Dᵀ.  columns : D (n, k); reach : V D (w, k)"""
        factor, weighted = np.hstack([self.factor, columns]), np.hstack([self.weighted, reach])
        target = self.both[:, self.rank :] + columns @ reach.T
        return Scorer(self.observation, factor, weighted, np.hstack([factor, target]))

    @property
    def rank(self) -> int:
        """Number of columns of F: the rest of `both` belongs to the numerator."""
        return int(self.factor.shape[1])

    def split_all(self, seen: JointRows) -> tuple[Array, Array]:
        """Return N = G C W C Gᵀ and M = R + G C Gᵀ of readings with all their numbers, each (m, k, k)."""
        (count, values, size), rank = seen.rows.shape, self.rank
        products = (seen.rows.reshape(-1, size) @ self.both).reshape(count, values, -1)
        far, near = products[..., rank:], products[..., :rank]
        if values == 1:  # sums of squares are faster so
            above, below = np.einsum("mkx,mkx->m", far, far), np.einsum("mkx,mkx->m", near, near)
            return above[:, None, None], seen.covariances + below[:, None, None]
        return far @ far.swapaxes(1, 2), seen.covariances + near @ near.swapaxes(1, 2)

    def gain_forms(self, setup: int, poses: Array, approaches: Array) -> tuple[Array, Array]:
        """Return numerator and denominator of the gain at poses, each (m,).  poses, approaches : (m, q)."""
        seen = self.observation.numbers(setup, poses, approaches)
        return joint_forms(*self.split_all(seen), self.observation.setups[setup].noise ** 2)

    def gains_at(self, setup: int, poses: Array, approaches: Array) -> Array:
        """Return the gain at poses, (m,).  poses, approaches : (m, q)."""
        return joint_gains(*self.split_all(self.observation.numbers(setup, poses, approaches)))

    def gains(self, lattice: Places) -> Array:
        """Return the gain of every candidate, (m,), block by block."""
        result = np.empty(len(lattice))
        for setup in np.unique(lattice.setups):
            mine = np.flatnonzero(lattice.setups == setup)
            for start in range(0, len(mine), _BLOCK):
                block = mine[start : start + _BLOCK]
                result[block] = self.gains_at(int(setup), lattice.poses[block], lattice.approaches[block])
        return result


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
        return above[..., 0, 0] / below[..., 0, 0]
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
