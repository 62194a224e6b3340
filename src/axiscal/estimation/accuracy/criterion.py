"""What a reading is to make small: J = tr(W C), as its Gram matrix W or as a root V of it, W = VᵀV.

The two are separate types: code that needs a root refuses a Gram matrix, and a bare array too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.errors.model import ErrorModel
from axiscal.errors.plane import PlaneError
from axiscal.errors.volume import VolumeMoments
from axiscal.estimation.belief import Belief
from axiscal.exceptions import ShapeError
from axiscal.numerics import Array

_ROUNDING = 1e-15
"""An eigenvalue of this share is rounding of the largest, in float64."""
_SYMMETRIC = 1e-9
"""Rounding of a product VᵀV, with room; what is no Gram matrix is off by more."""


@dataclass(frozen=True, eq=False, slots=True)
class Root:
    """V of a criterion J = tr(V C Vᵀ).  matrix : (r, n), over the leading n unknowns"""

    matrix: Array

    @property
    def size(self) -> int:
        """How many unknowns count, n."""
        return int(self.matrix.shape[1])

    def of(self, factor: Array) -> Array:
        """Return V F.  factor : F (m, k) or a vector (m,), over all unknowns, m at least n"""
        seen: Array = self.matrix @ factor[: self.size]
        return seen

    def value(self, factor: Array) -> float:
        """Return J of C = F Fᵀ.  factor : F (m, k) or a vector (m,), m at least n"""
        return float(np.sum(self.of(factor) ** 2))

    @property
    def gram(self) -> Gram:
        """W = VᵀV."""
        return Gram(self.matrix.T @ self.matrix)


@dataclass(frozen=True, eq=False, slots=True)
class Gram:
    """W of a criterion J = tr(W C).  matrix : (n, n) symmetric, over the leading n unknowns; raises ShapeError."""

    matrix: Array

    def __post_init__(self) -> None:
        """Refuse what is no Gram matrix, such as a root."""
        rows, columns = self.matrix.shape
        apart = _SYMMETRIC * np.abs(self.matrix).max(initial=0.0)
        if rows != columns or not np.allclose(self.matrix, self.matrix.T, rtol=0.0, atol=apart):
            raise ShapeError(f"A Gram matrix is square and symmetric; this one has shape {self.matrix.shape}.")

    @property
    def root(self) -> Root:
        """V (r, n) with W = VᵀV, for W of any rank r."""
        values, vectors = np.linalg.eigh(self.matrix)
        kept = values > _ROUNDING * values[-1]
        return Root((vectors[:, kept] * np.sqrt(values[kept])).T)

    def value(self, covariance: Array) -> float:
        """Return J.  covariance : C (m, m), m at least n"""
        size = len(self.matrix)
        return float(np.trace(self.matrix @ covariance[:size, :size]))


def need_root(root: Root) -> Root:
    """Return the root of a criterion; raises ShapeError for anything else, such as a Gram matrix."""
    if not isinstance(root, Root):
        raise ShapeError(f"A Root is asked for, V with W = VᵀV, not {type(root).__name__}; Gram(W).root is one.")
    return root


def volume_root(moments: VolumeMoments) -> Root:
    """Return V of the criterion `volume`, W = E[HᵀH]: the mean variance of the TCP deviation over the volume."""
    return Gram(moments.gram).root


def joint_root(model: ErrorModel) -> Root:
    """Return V of the paper's criterion: one Gram matrix per spline (B&H eq. 24-26; several joints B&H eq. 34-36).

    A rotation counts as the displacement it makes at the machine's own reach, half the diagonal of its linear travels.
    """
    gram = np.zeros((model.size, model.size))
    reach = machine_reach(model)
    for term in model.terms:
        scale = reach if term.angular else 1.0
        own = term.gram() if isinstance(term, PlaneError) else term.basis.gram()
        gram[term.columns, term.columns] = scale**2 * own
    return Gram(gram).root


def machine_reach(model: ErrorModel) -> float:
    """Return half the diagonal of the linear travels, m; 1 for a machine without linear axes."""
    travels = [axis.length for axis in model.machine.axes if not axis.rotary]
    return float(np.linalg.norm(travels)) / 2 if travels else 1.0


def value(belief: Belief, root: Root) -> float:
    """Return J of a belief over the root's unknowns and perhaps more."""
    return need_root(root).value(belief.factor)
