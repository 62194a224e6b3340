"""Readings that chips may have shifted, where nothing decides which: every way in which they may have fallen.

Expectation propagation ends at one side where the density has two humps. It then trusts one of two contradicting
readings, because the site of the other one was there first. So of the readings that stand out the most, up to `_MOST`,
all 2ᵏ ways h are weighed,

    p(h | y) ∝ π^|h| (1 − π)^(k−|h|) N(y; m + b h, P + D_h),   D_h = σ² + b² h,

with m, P the mean and covariance there from the sites of all others. These readings get sites that leave mean and
variance of that mixture at each of them. Precisions Λ of sites that leave variances v are where the concave

    log|1 + Fᵀ Λ F| − Σ λ v,    P = F Fᵀ,

is the largest; with them, values μ + α/λ leave the mean μ = m + P α, whatever Λ is.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.inference.weighted_fit import SHARE, WIDEST, Fitted, Sites
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import solution
from axiscal.numerics.gaussian import lower_root, positive_root

_MOST = 8
"""Readings of which every way is weighed: 256 ways take a hundredth of a second."""
_SWEEPS, _SETTLED = 400, 1e-6
"""Of the precisions; they end where none changes by more than that share. Few need a hundred."""


def every_way(fitted: Fitted, found: Sites, scatter: Array, chips: Array) -> Sites:
    """Return sites with the moments of every way in which chips may have fallen.

    found : sites of all numbers; scatter : (m,) σ²; chips : (m,) b with its sign, 0 where none shifts a reading
    """
    mine = _standing_out(fitted, found, scatter, chips)
    if len(mine) < 2:
        return found
    centre, prior = _of_the_others(fitted, found, mine)
    pull, variance = _moments(fitted.values[mine] - centre, prior, scatter[mine], chips[mine])
    least = 1.0 / (WIDEST * fitted.noise[mine])
    own = _precisions(prior, variance, 1.0 / found.variances[mine], least)
    values, variances = found.values.copy(), found.variances.copy()
    values[mine], variances[mine] = centre + prior @ pull + pull / own, 1.0 / own
    return Sites(values, variances)


def _precisions(prior: Array, variances: Array, start: Array, least: Array) -> Array:
    """Return the precisions (k,) of sites that leave these variances of a prior (k, k), none below the least.

    Each alone has its best in closed form. All at once they overshoot where they see the same. The function is concave,
    so the mean of k single steps is never worse than their start.
    """
    root, own = positive_root(prior, np.diag(prior)), np.maximum(start, least)
    for _ in range(_SWEEPS):
        inner = np.eye(root.shape[1]) + (root.T * own) @ root
        left = np.einsum("kr,kr->k", root @ np.linalg.inv(inner), root)
        change = (np.maximum(own + 1.0 / variances - 1.0 / left, least) - own) / len(own)
        own = own + change
        if float(np.max(np.abs(change) / own)) < _SETTLED:
            break
    return own


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


def _moments(shown: Array, prior: Array, scatter: Array, chips: Array) -> tuple[Array, Array]:
    """Return α and the variances (k,) of what was read, over every way in which chips fell; the mean is P α.

    shown : (k,) values less what the others predict; prior : (k, k) what these leave open; scatter, chips : (k,)
    """
    logs, pulls, variances = [], [], []
    for hit in product((0.0, 1.0), repeat=len(shown)):
        fallen = np.array(hit)
        lower = lower_root(prior + np.diag(scatter + fallen * chips**2))
        white, half = solution(lower, shown - fallen * chips), solution(lower, prior)
        odds = fallen.sum() * np.log(SHARE) + (1 - fallen).sum() * np.log1p(-SHARE)
        logs.append(odds - 0.5 * float(white @ white) - float(np.log(np.diag(lower)).sum()))
        pulls.append(np.linalg.solve(lower.T, white))
        variances.append(np.diag(prior) - np.sum(half**2, axis=0))
    share = np.exp(np.array(logs) - max(logs))
    share /= share.sum()
    each = np.array(pulls)
    pull: Array = share @ each
    variance: Array = share @ (np.array(variances) + ((each - pull) @ prior) ** 2)
    return pull, variance


def _of_the_others(fitted: Fitted, found: Sites, mine: NDArray[np.intp]) -> tuple[Array, Array]:
    """Return mean (k,) and covariance (k, k) that all other sites leave of what was read here."""
    others = np.setdiff1d(np.arange(len(found.values)), mine)
    prior = fitted.covariance() - np.diag(fitted.noise)
    lower = lower_root(prior[np.ix_(others, others)] + np.diag(found.variances[others]))
    half = solution(lower, prior[np.ix_(others, mine)])
    mean: Array = half.T @ solution(lower, found.values[others])
    return mean, prior[np.ix_(mine, mine)] - half.T @ half
