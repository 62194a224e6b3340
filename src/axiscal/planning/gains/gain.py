"""Gains of single readings under one belief: ΔJ = gᵀCWCg / (σ² + gᵀCg), from one product with [F, C Vᵀ].

That of a reading of several numbers is ΔJ = tr(M⁻¹ N), M = R + G C Gᵀ, N = G C W C Gᵀ. The numbers share information.
As a ratio of two smooth functions of the place the gain is tr(adj(M) N) / det(M). Both are divided by the same power of
the noise, to stay within the range of numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.measurement.observation import JointRows, Observation
from axiscal.numerics import Array
from axiscal_core.state import joint_gains


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

    def gains_at(self, setup: int, poses: Array, approaches: Array) -> Array:
        """Return the gain at poses, (m,).  poses, approaches : (m, q)."""
        return joint_gains(*self.split_all(self.observation.numbers(setup, poses, approaches)))
