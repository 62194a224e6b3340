"""Readings that chips may have shifted, where nothing decides which: every way in which they may have fallen.

Expectation propagation ends at one side where the density has two humps: of two readings that contradict each other
it believes one, because the other one's site was there first. So of the readings that stand out the most, up to
`_MOST`, all 2ᵏ ways h are weighed,

    p(h | y) ∝ π^|h| (1 − π)^(k−|h|) N(y; m + b h, P + D_h),   D_h = σ² + b² h,

m, P what the sites of all others leave open there; and the sites of these are changed until the estimate has mean and
variance of that mixture at each of them.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from axiscal.inference.normal_sites import SHARE, WIDEST, Sites
from axiscal.inference.weighted_fit import Fitted
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import solution
from axiscal.numerics.gaussian import lower_root

_MOST = 8
"""Readings of which every way is weighed: 256 ways take a hundredth of a second."""
_SWEEPS, _DAMPING = 60, 0.5
"""Of the sites towards moments that stay: half steps halve what is left where two see the same."""


def every_way(fitted: Fitted, found: Sites, scatter: Array, chips: Array) -> Sites:
    """Return sites with the moments of every way in which chips may have fallen.

    found : sites of all numbers; scatter : (m,) σ²; chips : (m,) b with its sign, 0 where none shifts a reading
    """
    mine = _standing_out(fitted, found, scatter, chips)
    if len(mine) < 2:
        return found
    mean, variance = _moments(fitted, found, scatter, chips, mine)
    values, precisions = found.values.copy(), 1.0 / found.variances
    for _ in range(_SWEEPS):
        now, spread = (each[mine] for each in fitted.estimate(values, precisions))
        own = precisions[mine]
        cavity = np.maximum(1.0 / spread - own, 1.0 / (WIDEST * fitted.noise[mine]))
        pull = mean / variance - (now / spread - own * values[mine])
        fresh = np.maximum(1.0 / variance - cavity, 1.0 / (WIDEST * fitted.noise[mine]))
        mixed = (1 - _DAMPING) * own + _DAMPING * fresh
        values[mine] = ((1 - _DAMPING) * own * values[mine] + _DAMPING * pull) / mixed
        precisions[mine] = mixed
    return Sites(values, 1.0 / precisions)


def _standing_out(fitted: Fitted, found: Sites, scatter: Array, chips: Array) -> NDArray[np.intp]:
    """Return the indices of those readings that the others leave in doubt the most, at most `_MOST` of them.

    What the others say is taken without the sites of all that chips may have shifted: with their plain noise.
    """
    precisions = np.where(chips != 0, 1.0 / (scatter + chips**2), 1.0 / found.variances)
    values = np.where(chips != 0, fitted.values, found.values)
    mean, spread = fitted.estimate(values, precisions)
    open_part = np.maximum(1.0 - spread * precisions, np.finfo(float).eps)
    away = np.abs(values - mean) / open_part / np.sqrt(spread / open_part + scatter)
    which = np.flatnonzero(chips != 0)
    order = which[np.argsort(-away[which], kind="stable")]
    return np.sort(order[:_MOST])


def _moments(fitted: Fitted, found: Sites, scatter: Array, chips: Array, mine: NDArray[np.intp]) -> tuple[Array, Array]:
    """Return mean and variance (k,) of what was read, over every way in which chips fell on these."""
    centre, prior = _of_the_others(fitted, found, mine)
    logs, means, variances = [], [], []
    for hit in product((0.0, 1.0), repeat=len(mine)):
        fallen = np.array(hit)
        lower = lower_root(prior + np.diag(scatter[mine] + fallen * chips[mine] ** 2))
        white = solution(lower, fitted.values[mine] - fallen * chips[mine] - centre)
        half = solution(lower, prior)
        odds = fallen.sum() * np.log(SHARE) + (1 - fallen).sum() * np.log1p(-SHARE)
        logs.append(odds - 0.5 * float(white @ white) - float(np.log(np.diag(lower)).sum()))
        means.append(centre + half.T @ white)
        variances.append(np.diag(prior) - np.sum(half**2, axis=0))
    share = np.exp(np.array(logs) - max(logs))
    share /= share.sum()
    mean: Array = share @ np.array(means)
    variance: Array = share @ (np.array(variances) + (np.array(means) - mean) ** 2)
    return mean, variance


def _of_the_others(fitted: Fitted, found: Sites, mine: NDArray[np.intp]) -> tuple[Array, Array]:
    """Return mean (k,) and covariance (k, k) that all other sites leave of what was read here."""
    others = np.setdiff1d(np.arange(len(found.values)), mine)
    prior = fitted.covariance() - np.diag(fitted.noise)
    lower = lower_root(prior[np.ix_(others, others)] + np.diag(found.variances[others]))
    half = solution(lower, prior[np.ix_(others, mine)])
    mean: Array = half.T @ solution(lower, found.values[others])
    return mean, prior[np.ix_(mine, mine)] - half.T @ half
