"""The readings of one machine as an equation for its errors, without a prior: R a + e = z, e ~ N(0, I).

It integrates out unknowns of set-ups, rests and drifts. With y = G a + G_b b + v, cov v = V and cov b = C_b,

    L Lᵀ = V + G_b C_b G_bᵀ,    R = L⁻¹ G,    z = L⁻¹ y
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.description.usual import NONE_VARY
from axiscal.estimation.promise.problem import Inherited, problem
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import places_of, rows_at
from axiscal.numerics import Array
from axiscal.numerics.gaussian import lower_root
from axiscal_core.from_scipy import solution


@dataclass(frozen=True, eq=False, slots=True)
class DataEquation:
    """rows : (m, n) R over the errors; values : (m,) z; the noise of each is independent and of std 1"""

    rows: Array
    values: Array

    def in_units(self, units: Array) -> DataEquation:
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


def data_equation(observation: Observation, readings: Sequence[Reading], others: Array | None = None) -> DataEquation:
    """Return what readings say of the errors.

    others : (n, k) F of errors that are no part of the question: their covariance F Fᵀ is integrated out as well
    """
    posed = problem(observation, readings, NONE_VARY, usual=False)
    count = observation.errors.size
    rows = rows_at(observation, places_of(observation.setups, readings)).rows[:, :count] / posed.noise[:, None]
    beside = np.delete(posed.rows, slice(posed.first, posed.own + count), axis=1)
    if others is not None:
        beside = np.hstack([rows @ others, beside])
    lower = lower_root(np.eye(len(rows)) + beside @ beside.T)
    return DataEquation(solution(lower, rows), solution(lower, posed.values))


def shares_of(data: DataEquation, priors: Sequence[Inherited], weights: Array) -> Array:
    """Return how probable each prior is after the readings, P_i ∝ w_i N(z; R m_i, R C_i Rᵀ + I), (k,), sum 1.

    weights : (k,) before them
    """
    logs = np.log(weights) + np.array([log_evidence(data, prior) for prior in priors])
    odds = np.exp(logs - logs.max())
    shares: Array = odds / odds.sum()
    return shares


def log_evidence(data: DataEquation, prior: Inherited) -> float:
    """Return log N(z; R m, R C Rᵀ + I), up to the constant of so many numbers."""
    if not len(data.values):
        return 0.0
    lower = lower_root(data.rows @ prior.covariance @ data.rows.T + np.eye(len(data.values)))
    left = solution(lower, data.values - data.rows @ prior.mean)
    return float(-0.5 * left @ left - np.log(np.diagonal(lower)).sum())


def moments_of(parts: Sequence[Inherited], shares: Array) -> Inherited:
    """Return mean and covariance of a mixture (law of total variance).  shares : (k,), sum 1"""
    mean = np.sum([share * part.mean for share, part in zip(shares, parts, strict=True)], axis=0)
    covariance = np.zeros((len(mean), len(mean)))
    for share, part in zip(shares, parts, strict=True):
        away = part.mean - mean
        covariance += share * (part.covariance + np.outer(away, away))
    return Inherited(mean, covariance)
