"""Gains of single readings under one belief: ΔJ = gᵀCWCg / (σ² + gᵀCg), from one product with [F, C Vᵀ]."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.belief import Belief
from axiscal.design.lattice import Lattice
from axiscal.measurement.observation import Observation
from axiscal.numerics import Array
from axiscal.numerics.exact_step import gain_forms

_BLOCK = 4096


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
    def of(cls, observation: Observation, belief: Belief, weight: Array) -> Scorer:
        """Return the scorer of a belief.  weight : V (w, n) over the leading n unknowns."""
        factor = belief.factor
        weighted = weight @ factor[: weight.shape[1]]
        return cls(observation, factor, weighted, np.hstack([factor, factor @ weighted.T]))

    @property
    def rank(self) -> int:
        """Number of columns of F: the rest of `both` belongs to the numerator."""
        return int(self.factor.shape[1])

    def split(self, seen: Array, variances: Array) -> tuple[Array, Array]:
        """Return numerator and denominator from rows times `both`.  seen : (..., r + w); variances : (...)."""
        above, below = seen[..., self.rank :], seen[..., : self.rank]
        return np.einsum("...x,...x->...", above, above), variances + np.einsum("...x,...x->...", below, below)

    def forms(self, setup: int, poses: Array, approaches: Array) -> tuple[Array, Array]:
        """Return numerator and denominator of the gain, to full accuracy.  poses, approaches : (m, q)."""
        seen = self.observation.rows(setup, poses, approaches)
        return gain_forms(seen.rows, self.factor, self.weighted, seen.variances)

    def at(self, setup: int, poses: Array, approaches: Array) -> Array:
        """Return the gain at poses, (m,).  poses, approaches : (m, q)."""
        seen = self.observation.rows(setup, poses, approaches)
        above, below = self.split(seen.rows @ self.both, seen.variances)
        gains: Array = above / below
        return gains

    def gains(self, lattice: Lattice) -> Array:
        """Return the gain of every candidate, (m,), block by block."""
        result = np.empty(len(lattice))
        for setup in np.unique(lattice.setups):
            mine = np.flatnonzero(lattice.setups == setup)
            for start in range(0, len(mine), _BLOCK):
                block = mine[start : start + _BLOCK]
                result[block] = self.at(int(setup), lattice.poses[block], lattice.approaches[block])
        return result
