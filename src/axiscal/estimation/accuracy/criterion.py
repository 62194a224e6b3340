"""What a reading is to make small: J = tr(W C) = tr(V C Vᵀ), by a root V of its Gram matrix, W = VᵀV."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.errors.model import ErrorModel
from axiscal.errors.plane import PlaneError
from axiscal.numerics import Array

_ROUNDING = 1e-15
"""An eigenvalue of this share is rounding of the largest, in float64."""


@dataclass(frozen=True, eq=False, slots=True)
class Root:
    """V of a criterion J = tr(V C Vᵀ).  matrix : (r, n), over the leading n unknowns"""

    matrix: Array

    @classmethod
    def of_gram(cls, gram: Array) -> Root:
        """Return V (r, n) with W = VᵀV, for W of any rank r.  gram : W (n, n), symmetric"""
        values, vectors = np.linalg.eigh(gram)
        kept = values > _ROUNDING * values[-1]
        return cls((vectors[:, kept] * np.sqrt(values[kept])).T)

    @property
    def unknowns(self) -> int:
        """How many unknowns count, n."""
        return int(self.matrix.shape[1])

    def times(self, factor: Array) -> Array:
        """Return V F.  factor : F (m, k) or a vector (m,), over all unknowns, m at least n"""
        return self.matrix @ factor[: self.unknowns]

    def criterion(self, factor: Array) -> float:
        """Return J of C = F Fᵀ.  factor : F (m, k) or a vector (m,), m at least n"""
        return float(np.sum(self.times(factor) ** 2))

    @property
    def weights(self) -> Array:
        """W = VᵀV, (n, n)."""
        return self.matrix.T @ self.matrix


def joint_root(model: ErrorModel) -> Root:
    """Return V of the paper's criterion: one Gram matrix per spline (B&H eq. 24-26; several joints B&H eq. 34-36).

    A rotation counts as the displacement it makes at the machine's own reach, half the diagonal of its linear travels.
    """
    gram = np.zeros((model.size, model.size))
    travels = [axis.length for axis in model.machine.axes if not axis.rotary]
    reach = float(np.linalg.norm(travels)) / 2 if travels else 1.0
    for term in model.terms:
        scale = reach if term.angular else 1.0
        own = term.plane_gram() if isinstance(term, PlaneError) else term.basis.gram()
        gram[term.columns, term.columns] = scale**2 * own
    return Root.of_gram(gram)
