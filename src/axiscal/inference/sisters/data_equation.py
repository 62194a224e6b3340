"""What the readings of one machine say of its errors, whatever was believed before: R a + e = z, e ~ N(0, I).

Unknowns of set-ups, rests and drifts are integrated out: with y = G a + G_b b + v, cov v = V and cov b = C_b,

    L Lᵀ = V + G_b C_b G_bᵀ,    R = L⁻¹ G,    z = L⁻¹ y
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.inference.reading_set import ReadingSet
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import solution
from axiscal.numerics.gaussian import lower_root


@dataclass(frozen=True, eq=False, slots=True)
class DataEquation:
    """rows : (m, n) R over the errors; values : (m,) z; the noise of each is independent and of std 1"""

    rows: Array
    values: Array

    def of(self, units: Array) -> DataEquation:
        """Return the equation over x where the errors are a = T x.  units : (n, k) T"""
        return DataEquation(self.rows @ units, self.values)

    @property
    def squeezed(self) -> DataEquation:
        """The same with no more rows than unknowns: what is left out says nothing of them."""
        count, size = self.rows.shape
        if count <= size:
            return self
        turned, upper = np.linalg.qr(self.rows)
        return DataEquation(upper, turned.T @ self.values)


def data_equation(numbers: ReadingSet, weights: Array, others: Array) -> DataEquation:
    """Return what readings say of the errors.

    weights : (r,) how much each reading counts, above zero
    others : (n, k) F of errors that are no part of the question: their covariance F Fᵀ is integrated out as well
    """
    beside, errors = numbers.features(others), len(others)
    noise = numbers.noise / weights[numbers.reading] + numbers.extra_variance
    lower = lower_root(np.diag(noise) + beside @ beside.T)
    return DataEquation(solution(lower, numbers.rows[:, :errors]), solution(lower, numbers.values))
