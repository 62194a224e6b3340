"""From the data equations of sisters to the prior of the next machine: a mixture over sweeps, by its moments.

m̄ = mean P⁻¹h,    C̄ = mean(P⁻¹ + Σ) + scatter of P⁻¹h
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.inference.sisters.data_equation import DataEquation
from axiscal.inference.sisters.gibbs import half_covariance, swept
from axiscal.inference.sisters.hierarchy import Hierarchy, Sisters, usual
from axiscal.numerics import Array
from axiscal.numerics.threads import one_thread

BEFORE, SWEEPS = 60, 160
"""Sweeps until it has forgotten where it began, and those that count: twice as many move no figure by a tenth."""


@dataclass(frozen=True, eq=False, slots=True)
class SisterPrior:
    """What the next machine is believed to be, in units of the stated prior.

    mean : (n,); covariance : (n, n); common : (n, n) the part of it that more sisters would take away
    scales, scale_stds : (f,) c and its std; shares, share_stds : (f,) ω and its std; directions : (n, n) mean of B Bᵀ
    """

    mean: Array
    covariance: Array
    common: Array
    scales: Array
    scale_stds: Array
    shares: Array
    share_stds: Array
    directions: Array


@one_thread()
def sister_prior(
    data: Sequence[DataEquation],
    hierarchy: Hierarchy,
    seed: Sequence[int],
    told: Callable[[int, int], None] = lambda done, of: None,
) -> SisterPrior:
    """Return the prior of the next machine.

    data : of each sister, over the unknowns of the hierarchy; seed : the same one gives the same prior
    told : called after each sweep with how many are done, and of how many
    """
    rng, squeezed = np.random.default_rng(list(seed)), [each.squeezed for each in data]
    state, size = usual(hierarchy, len(data), rng), hierarchy.size
    means, states = list[Array](), list[Sisters]()
    within, own, directions = (np.zeros((size, size)) for _ in range(3))
    for sweep in range(BEFORE + SWEEPS):
        before = state
        state, common = swept(state, squeezed, hierarchy, rng)
        told(sweep + 1, BEFORE + SWEEPS)
        if sweep < BEFORE:
            continue
        roots, joint = half_covariance(before, hierarchy)
        means.append(common.mean)
        states.append(before)
        within += common.covariance / SWEEPS
        own += (np.diag(roots**2) + joint @ joint.T) / SWEEPS
        directions += before.together @ before.together.T / SWEEPS
    found = np.array(means)
    mean = found.mean(axis=0)
    shared = within + (found - mean).T @ (found - mean) / SWEEPS
    scales, shares = (np.array([getattr(each, name) for each in states]) for name in ("scales", "shares"))
    return SisterPrior(
        mean,
        own + shared,
        shared,
        np.exp(np.log(scales).mean(axis=0)),
        scales.std(axis=0),
        shares.mean(axis=0),
        shares.std(axis=0),
        directions,
    )
