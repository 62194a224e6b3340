"""Whether a machine is like its sisters: several priors side by side, each as likely as it foretells the readings.

P_i ∝ w_i N(z; R m_i, R C_i Rᵀ + I)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from axiscal.inference.sisters.data_equation import DataEquation
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import solution
from axiscal.numerics.gaussian import lower_root


class Moments(NamedTuple):
    """Mean (n,) and covariance (n, n)."""

    mean: Array
    covariance: Array


def shares_of(data: DataEquation, priors: Sequence[Moments], weights: Array) -> Array:
    """Return how probable each prior is after the readings, (k,), sum 1.  weights : (k,) before them"""
    logs = np.log(weights) + np.array([log_evidence(data, prior) for prior in priors])
    odds = np.exp(logs - logs.max())
    shares: Array = odds / odds.sum()
    return shares


def log_evidence(data: DataEquation, prior: Moments) -> float:
    """Return log N(z; R m, R C Rᵀ + I), up to the constant of so many numbers."""
    if not len(data.values):
        return 0.0
    lower = lower_root(data.rows @ prior.covariance @ data.rows.T + np.eye(len(data.values)))
    left = solution(lower, data.values - data.rows @ prior.mean)
    return float(-0.5 * left @ left - np.log(np.diagonal(lower)).sum())


def moments_of(parts: Sequence[Moments], shares: Array) -> Moments:
    """Return mean and covariance of a mixture (law of total variance).  shares : (k,), sum 1"""
    mean = np.sum([share * part.mean for share, part in zip(shares, parts, strict=True)], axis=0)
    covariance = np.zeros((len(mean), len(mean)))
    for share, part in zip(shares, parts, strict=True):
        away = part.mean - mean
        covariance += share * (part.covariance + np.outer(away, away))
    return Moments(mean, covariance)
