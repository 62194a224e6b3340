"""Common errors of sisters, learnt by Gibbs sampling: every unknown drawn anew, given the others and the readings.

With Σ = D^½ (I + B Bᵀ) D^½ and W_j = (R_j Σ R_jᵀ + I)⁻¹, one sweep draws

    μ ~ N(P⁻¹h, P⁻¹),  P = diag(1/cω) + Σ_j R_jᵀ W_j R_j,  h = Σ_j R_jᵀ W_j z_j          (the d_j integrated out)
    d_j = d⁰ + Σ R_jᵀ W_j (z_j − R_j (μ + d⁰) − e⁰),  d⁰ ~ N(0, Σ),  e⁰ ~ N(0, I)         (Matheron's rule)
    along_j | d_j, then the rows of B, from D^−½ d_j = B along_j + N(0, I); τ² by its conjugate
    (c_f, ω_f) from 9 × 11 places about where they are, then log c and m

The places lie at random about the present one, which is as likely to be any of them. Their distance is drawn anew. So
the draw leaves the posterior as it is, however coarse the places are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from axiscal.estimation.data_equation import DataEquation
from axiscal.language.stages import staged
from axiscal.numerics import Array
from axiscal.numerics.gaussian import lower_root
from axiscal.ports.fleet.hierarchy import CERTAINTY, LEVEL, MEANS, SCALE, SHAPE, SPREAD, Hierarchy, Sisters, usual
from axiscal_core.from_scipy import back_solution, inverse_of_product, solution
from axiscal_core.threads import one_thread

_SCALES, _SHARES = 9, 11
"""Places tried for a scale and for a share at once; any few do."""
_NEAR, _FAR = np.log(0.03), np.log(0.9)
"""Logarithms of the least and the largest distance between them, in log c and in the logit of ω."""
_LOGIT = 12.0
"""Farther out a share is 0 or 1 to all digits that matter."""
BEFORE, SWEEPS = 60, 160
"""Sweeps until it has forgotten where it began, and those that count: twice as many move no figure by a tenth."""


class Common(NamedTuple):
    """What is known of μ with the machines' own parts integrated out: mean (n,), covariance (n, n)."""

    mean: Array
    covariance: Array


def half_covariance(state: Sisters, hierarchy: Hierarchy) -> tuple[Array, Array]:
    """Return D^½ (n,) and D^½ B (n, r): Σ = D + (D^½ B)(D^½ B)ᵀ."""
    roots = np.sqrt(state.scales * (1 - state.shares))[hierarchy.owner]
    return roots, roots[:, None] * state.together


def swept(
    state: Sisters, data: Sequence[DataEquation], hierarchy: Hierarchy, rng: np.random.Generator
) -> tuple[Sisters, Common]:
    """Return the next state, and what the sweep knew of what is common before it drew it."""
    state, common = _machines_drawn(state, data, hierarchy, rng)
    state = _directions_drawn(state, hierarchy, rng)
    state = _scales_drawn(state, hierarchy, rng)
    return _levels_drawn(state, hierarchy, rng), common


def _machines_drawn(
    state: Sisters, data: Sequence[DataEquation], hierarchy: Hierarchy, rng: np.random.Generator
) -> tuple[Sisters, Common]:
    roots, joint = half_covariance(state, hierarchy)
    lowers = []
    precision = np.diag(1.0 / (state.scales * state.shares)[hierarchy.owner])
    pull = np.zeros(hierarchy.unknowns)
    for each in data:
        half = np.hstack([each.rows * roots, each.rows @ joint])
        lower = lower_root(half @ half.T + np.eye(len(half)))
        white = solution(lower, each.rows)
        precision += white.T @ white
        pull += white.T @ solution(lower, each.values)
        lowers.append(lower)
    root = lower_root(precision)
    covariance = inverse_of_product(root)
    mean = covariance @ pull
    common = mean + back_solution(root, rng.standard_normal(hierarchy.unknowns))
    own = np.empty_like(state.own)
    for j, (each, lower) in enumerate(zip(data, lowers, strict=True)):
        first = roots * rng.standard_normal(hierarchy.unknowns) + joint @ rng.standard_normal(hierarchy.directions)
        left = each.values - each.rows @ (common + first) - rng.standard_normal(len(each.values))
        back = each.rows.T @ back_solution(lower, solution(lower, left))
        own[j] = first + roots**2 * back + joint @ (joint.T @ back)
    return replace(state, common=common, own=own), Common(mean, covariance)


def _directions_drawn(state: Sisters, hierarchy: Hierarchy, rng: np.random.Generator) -> Sisters:
    directions, count = hierarchy.directions, len(state.own)
    if directions == 0:
        return state
    scaled = state.own / half_covariance(state, hierarchy)[0]
    root = lower_root(np.eye(directions) + state.together.T @ state.together)
    along = scaled @ state.together @ inverse_of_product(root)
    along += rng.standard_normal((count, directions)) @ np.linalg.inv(root)
    root = lower_root(along.T @ along + np.eye(directions) / state.width)
    together = scaled.T @ along @ inverse_of_product(root)
    together += rng.standard_normal((hierarchy.unknowns, directions)) @ np.linalg.inv(root)
    width = (SCALE + np.sum(together**2) / 2) / rng.gamma(SHAPE + together.size / 2)
    return replace(state, along=along, together=together, width=float(width))


def _scales_drawn(state: Sisters, hierarchy: Hierarchy, rng: np.random.Generator) -> Sisters:
    """Draw c and ω of every error from places about the present ones, all errors at once."""
    errors = len(hierarchy.parts)
    logs = _places(np.log(state.scales), _SCALES, rng)[:, :, None]
    logits = _places(np.log(state.shares) - np.log1p(-state.shares), _SHARES, rng)[:, None, :]
    share_log, rest_log = -np.logaddexp(0.0, -logits), -np.logaddexp(0.0, logits)
    own_log = logs + rest_log
    squares, products, count = _sums(state, hierarchy)
    common = hierarchy.summed(state.common**2)
    density = (
        -0.5 * hierarchy.sizes[:, None, None] * (logs + share_log)
        - 0.5 * common[:, None, None] * np.exp(-logs - share_log)
        - 0.5 * count * hierarchy.sizes[:, None, None] * own_log
        - 0.5 * squares[:, None, None] * np.exp(-own_log)
        + products[:, None, None] * np.exp(-own_log / 2)
        - 0.5 * ((logs - state.level) / SPREAD) ** 2
    )
    means = state.means[hierarchy.kind_of][:, None, None]
    density = density + CERTAINTY * means * share_log + CERTAINTY * (1 - means) * rest_log
    density = np.where(np.abs(logits) > _LOGIT, -np.inf, density).reshape(errors, -1)
    noise = rng.gumbel(size=density.shape)
    chosen = np.argmax(density + noise, axis=1)
    index = np.arange(errors)
    scales = np.exp(logs[index, chosen // _SHARES, 0])
    logit = logits[index, 0, chosen % _SHARES]
    return replace(state, scales=scales, shares=1.0 / (1.0 + np.exp(-logit)))


def _places(present: Array, count: int, rng: np.random.Generator) -> Array:
    """Return places at one distance, the present one among them, (f, count).  present : (f,)"""
    distance = np.exp(rng.uniform(_NEAR, _FAR, len(present)))
    number = rng.integers(0, count, len(present))
    return present[:, None] + (np.arange(count) - number[:, None]) * distance[:, None]


def _sums(state: Sisters, hierarchy: Hierarchy) -> tuple[Array, Array, int]:
    """Return Σ|d|² and Σ d·(B along) over the sisters for each error, (f,), and how many sisters there are."""
    squares = hierarchy.summed(np.sum(state.own**2, axis=0))
    products = hierarchy.summed(np.sum(state.own * (state.along @ state.together.T), axis=0))
    return squares, products, len(state.own)


def _levels_drawn(state: Sisters, hierarchy: Hierarchy, rng: np.random.Generator) -> Sisters:
    precision = len(hierarchy.parts) / SPREAD**2 + 1 / LEVEL**2
    mean = np.sum(np.log(state.scales)) / SPREAD**2 / precision
    level = float(mean + rng.standard_normal() / np.sqrt(precision))
    means = state.means.copy()
    logs, rests = np.log(state.shares), np.log1p(-state.shares)
    for kind in range(len(means)):
        mine = hierarchy.kind_of == kind
        density = (
            CERTAINTY * (MEANS * logs[mine].sum() + (1 - MEANS) * rests[mine].sum()) - mine.sum() * hierarchy.constants
        )
        means[kind] = MEANS[int(np.argmax(density + rng.gumbel(size=len(MEANS))))]
    return replace(state, level=level, means=means)


@dataclass(frozen=True, eq=False, slots=True)
class SisterPrior:
    """Prior of the next machine, in units of the stated prior.

    mean : (n,); covariance : (n, n); common : (n, n) the part of it that more sisters would take away
    scales, scale_stds : (f,) c and its std; shares, share_stds : (f,) ω and its std
    """

    mean: Array
    covariance: Array
    common: Array
    scales: Array
    scale_stds: Array
    shares: Array
    share_stds: Array


@one_thread()
def sister_prior(data: Sequence[DataEquation], hierarchy: Hierarchy, seed: Sequence[int]) -> SisterPrior:
    """Return the prior of the next machine: a mixture over sweeps, by its moments.

    m̄ = mean P⁻¹h,    C̄ = mean(P⁻¹ + Σ) + scatter of P⁻¹h

    data : of each sister, over the unknowns of the hierarchy; seed : the same one gives the same prior
    """
    rng, squeezed = np.random.default_rng(list(seed)), [each.squeezed for each in data]
    state, size = usual(hierarchy, len(data), rng), hierarchy.unknowns
    means, states = list[Array](), list[Sisters]()
    within, own = (np.zeros((size, size)) for _ in range(2))
    for sweep in staged("sweeps", range(BEFORE + SWEEPS), BEFORE + SWEEPS):
        before = state
        state, common = swept(state, squeezed, hierarchy, rng)
        if sweep < BEFORE:
            continue
        roots, joint = half_covariance(before, hierarchy)
        means.append(common.mean)
        states.append(before)
        within += common.covariance / SWEEPS
        own += (np.diag(roots**2) + joint @ joint.T) / SWEEPS
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
    )
