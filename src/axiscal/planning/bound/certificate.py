"""What proves a bound: a matrix Z, and how much every plan must leave because of it.

A plan of k numbers has whitened rows b_i (of Σ^-½ G F). With any estimate X = Σ l_i b_iᵀ of Φ = V F it leaves

    J = min over l of |Φ − X|² + Σ |l_i|²   with   |l_i|² ≥ 2 l_iᵀZb_i − |Z b_i|²  for any Z,  so
    J ≥ min over X of |Φ − X|² + 2 <Z, X> − Σ |Z b_i|² = |Φ|² − |Φ − Z|²_k − Σ |Z b_i|²

where X has at most rank k and |.|²_k is the sum of the k largest squared singular values (Eckart and Young 1936). The
general equivalence theorem (Kiefer and Wolfowitz 1960) has Z = Φ (I + Σ x_i b_i b_iᵀ)⁻¹, optimal weights x, and all
singular values. Weyl (1912) has Z = 0. A share of the first Z is better than both.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from axiscal.numerics import Array
from axiscal.planning.bound.open_zeros import Zeros
from axiscal.planning.gains.covariance import Covariance, unexplained

_MARGIN = 1e-12
"""Rounding, with room: what a proof gives away for float64 is a millionth of a millionth of J."""
_GOLDEN = (np.sqrt(5.0) - 1) / 2
"""Mathematics: the golden section."""
_STEPS = 24
"""Steps of the golden section: the multiplier to 1e-5, and any multiplier proves a bound."""
_MOST = 2.5
"""The largest multiplier that is tried; any proves a bound, and the best is near one."""
_PARTS = (0.0, 0.3, 0.6, 0.8, 0.9, 0.97)
"""Shares that are tried: each proves a bound, and the best is taken."""


@dataclass(frozen=True, eq=False)
class Dual:
    """state : of the prior, with the cells of all rows that Z was made from; z : Z (w, r)."""

    state: Covariance
    z: Array

    @classmethod
    def of(cls, state: Covariance, scaled: Array) -> Dual:
        """Return Φ (I + BᵀB)⁻¹.  scaled : B (m, r), rows of unit noise under the state's factor."""
        target = state.weighted
        if not len(scaled):
            return cls(state, target)
        return cls(state, unexplained(target, scaled))

    @cached_property
    def reach(self) -> Array:
        """F Zᵀ (n, w): a row g of noise σ has |Z b|² = |gᵀ F Zᵀ|²/σ²."""
        reach: Array = self.state.factor @ self.z.T
        return reach

    @cached_property
    def value(self) -> float:
        """J of the weights that Z was made from, <Φ, Z>."""
        return float(np.sum(self.state.weighted * self.z))

    @property
    def whole(self) -> float:
        """|Φ|² − |Φ − Z|²."""
        return 2 * self.value - float(np.sum(self.z**2))

    def floor(self, spent: float, numbers: int, zeros: Zeros | None = None) -> float:
        """Return the best bound on J of plans of so many numbers that a share of Z proves.

        spent : what Σ |Z b_i|² of a plan may come to at most; zeros : that all of these plans must find out
        """
        target, z, lost, count = self.state.weighted, self.z, 0.0, 0
        if zeros is not None:
            count = len(zeros.columns)
            lost = float(np.sum(z[:, zeros.columns] ** 2))
            target, z = np.delete(target, zeros.columns, axis=1), np.delete(z, zeros.columns, axis=1)
        own, cross, other = target @ target.T, target @ z.T, z @ z.T
        cross, weight = cross + cross.T, float(np.trace(other)) + spent

        def bound(share: float) -> float:
            values = np.linalg.eigvalsh(own - share * cross + share**2 * other)[::-1]
            left = float(np.sum(np.maximum(values[numbers:], 0.0))) + share * (2 * self.value - share * weight)
            if zeros is None:
                return left
            half = float(np.sum(np.maximum(values[max(numbers - count, 0) : numbers], 0.0)))
            return left + max(_kept(zeros.stiffness, part) * half - share**2 * lost / (1 - part) for part in _PARTS)

        best = max(_largest(bound), bound(1.0))
        return max(best - _MARGIN * float(np.trace(own)), 0.0) * (1 - _MARGIN)


def _kept(stiffness: float, part: float) -> float:
    """Return the share that stays of a direction whose removal costs `stiffness` times its square."""
    return stiffness * part / (1 + stiffness * part)


def rank_bound(state: Covariance, readings: int) -> float:
    """Return what so many scalar readings must leave, wherever they are taken and however good they are.

    A reading takes away a covariance of rank one, so at least the smaller eigenvalues of V C₀ Vᵀ stay (Weyl 1912).
    """
    target = state.weighted
    values = np.linalg.eigvalsh(target @ target.T)[::-1]
    return float(max(np.sum(values[readings:]), 0.0)) * (1 - _MARGIN)


def _largest(concave: Callable[[float], float]) -> float:
    """Return the largest value on [0, 2.5] by golden section."""
    low, high = 0.0, _MOST
    left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    at_left, at_right = concave(left), concave(right)
    for _ in range(_STEPS):
        if at_left >= at_right:
            high, right, at_right = right, left, at_left
            left = high - _GOLDEN * (high - low)
            at_left = concave(left)
        else:
            low, left, at_left = left, right, at_right
            right = low + _GOLDEN * (high - low)
            at_right = concave(right)
    return max(at_left, at_right)
