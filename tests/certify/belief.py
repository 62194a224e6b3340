"""A million updates against 80 digits: `make certify PART=belief`.

Two natural splines of 20 control values, of which only the sum is read. The readings stand at few distinct poses, so
the exact posterior is one information sum. Judged are the standard deviations of the sum: eigenvalues and diagonal of
a covariance do not show the loss of digits, what can be observed does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.estimation.belief import Belief
from axiscal.numerics import Array
from axiscal_core.splines import NaturalSpline, even_knots
from tests.certify.models import exact

CASES = ((20e-6, 0.5e-6), (1e-3, 0.5e-6), (1e-2, 0.1e-6), (1.0, 0.1e-6), (1.0, 1e-9))
"""Prior and noise standard deviation, m."""
LIMITS = (1e-9, 1e-9, 1e-9, np.inf, np.inf)
_SIZE, _DISTINCT, _CHUNK, _PROBES = 20, 64, 10_000, 50


@dataclass(frozen=True)
class Verdict:
    """error : worst relative error of a predicted standard deviation; mean : worst error of a mean, in predicted
    standard deviations; bad : how many variances are not positive.
    """

    error: float
    mean: float
    bad: int


def sums(poses: Array) -> Array:
    """Return the rows that read the sum of both splines.  poses : (m, 2) in [0, 1]."""
    spline = NaturalSpline(even_knots(0.0, 1.0, _SIZE))
    return np.hstack([spline.rows(poses[:, 0]), spline.rows(poses[:, 1])])


def judged(prior: float, noise: float, updates: int, seed: int = 1) -> Verdict:
    """Feed so many readings one by one and compare with the exact posterior."""
    rng = np.random.default_rng(seed)
    distinct, probes = sums(rng.random((_DISTINCT, 2))), sums(rng.random((_PROBES, 2)))
    truth = prior * rng.standard_normal(2 * _SIZE)
    values = distinct @ truth + noise * rng.standard_normal(_DISTINCT)
    belief, counts, begun = _begin(prior), np.zeros(_DISTINCT, dtype=int), 0
    while begun < updates:
        order = rng.integers(0, _DISTINCT, min(_CHUNK, updates - begun))
        belief = belief.update(distinct[order], values[order], noise**2)
        counts += np.bincount(order, minlength=_DISTINCT)
        begun += len(order)
    mean, std = exact(np.full(2 * _SIZE, prior**2), distinct, values, counts, noise**2, probes)
    found = belief.predict(probes)
    bad = np.sum(~(found.std > 0)) + np.sum(~(np.diagonal(belief.covariance) > 0))
    return Verdict(float(np.max(np.abs(found.std / std - 1))), float(np.max(np.abs(found.mean - mean) / std)), int(bad))


def _begin(prior: float) -> Belief:
    return Belief(np.zeros(2 * _SIZE), prior**2 * np.eye(2 * _SIZE))
