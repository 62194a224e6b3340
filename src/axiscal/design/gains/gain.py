"""Gains of single readings under one belief: ΔJ = gᵀCWCg / (σ² + gᵀCg), from one product with [F, C Vᵀ]."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.accuracy.criterion import Root, need_root
from axiscal.belief import Belief
from axiscal.design.gains.three_values import joint_forms, joint_gains
from axiscal.measurement.observation import JointRows, Observation
from axiscal.measurement.place import Places
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

    @classmethod
    def of(cls, observation: Observation, belief: Belief, root: Root) -> Scorer:
        """Return the scorer of a belief; raises ShapeError where another thing than a root is given."""
        factor = belief.factor
        weighted = need_root(root).of(factor)
        return cls(observation, factor, weighted, np.hstack([factor, factor @ weighted.T]))

    def widened(self, columns: Array, reach: Array) -> Scorer:
        """Return the gains where the covariance is larger by D Dᵀ.  columns : D (n, k); reach : V D (w, k)"""
        factor, weighted = np.hstack([self.factor, columns]), np.hstack([self.weighted, reach])
        target = self.both[:, self.rank :] + columns @ reach.T
        return Scorer(self.observation, factor, weighted, np.hstack([factor, target]))

    @property
    def rank(self) -> int:
        """Number of columns of F: the rest of `both` belongs to the numerator."""
        return int(self.factor.shape[1])

    def split(self, seen: Array, variances: Array) -> tuple[Array, Array]:
        """Return numerator and denominator from rows times `both`.  seen : (..., r + w); variances : (...)."""
        above, below = seen[..., self.rank :], seen[..., : self.rank]
        return np.einsum("...x,...x->...", above, above), variances + np.einsum("...x,...x->...", below, below)

    def split_all(self, seen: JointRows) -> tuple[Array, Array]:
        """Return N = G C W C Gᵀ and M = R + G C Gᵀ of readings with all their numbers, each (m, k, k)."""
        count, values, size = seen.rows.shape
        products = (seen.rows.reshape(-1, size) @ self.both).reshape(count, values, -1)
        if values == 1:
            above, below = self.split(products[:, 0], seen.covariances[:, 0, 0])
            return above[:, None, None], below[:, None, None]
        return self.products(products, seen.covariances)

    def products(self, seen: Array, covariances: Array) -> tuple[Array, Array]:
        """Return N and M from rows times `both`.  seen : (..., k, r + w); covariances : (..., k, k)."""
        far, near = seen[..., self.rank :], seen[..., : self.rank]
        return far @ far.swapaxes(-1, -2), covariances + near @ near.swapaxes(-1, -2)

    def forms(self, setup: int, poses: Array, approaches: Array) -> tuple[Array, Array]:
        """Return numerator and denominator of the gain at poses, each (m,).  poses, approaches : (m, q)."""
        seen = self.observation.numbers(setup, poses, approaches)
        return joint_forms(*self.split_all(seen), self.observation.setups[setup].noise ** 2)

    def at(self, setup: int, poses: Array, approaches: Array) -> Array:
        """Return the gain at poses, (m,).  poses, approaches : (m, q)."""
        above, below = self.split_all(self.observation.numbers(setup, poses, approaches))
        gains: Array = above[:, 0, 0] / below[:, 0, 0] if above.shape[1] == 1 else joint_gains(above, below)
        return gains

    def gains(self, lattice: Places) -> Array:
        """Return the gain of every candidate, (m,), block by block."""
        result = np.empty(len(lattice))
        for setup in np.unique(lattice.setups):
            mine = np.flatnonzero(lattice.setups == setup)
            for start in range(0, len(mine), _BLOCK):
                block = mine[start : start + _BLOCK]
                result[block] = self.at(int(setup), lattice.poses[block], lattice.approaches[block])
        return result
