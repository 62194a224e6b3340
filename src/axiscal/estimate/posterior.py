"""The posterior of errors and set-ups' unknowns, sizes averaged over, and whether the readings agree with each other.

    m = Σ w m_θ,    C = Σ w (C_θ + (m_θ − m)(m_θ − m)ᵀ)

A reading left out is expected with r = (K⁻¹_ii)⁻¹ (K⁻¹y)_i and covariance S = (K⁻¹_ii)⁻¹ (Rasmussen and Williams 2006,
eq. 5.12). It is bad with odds, sizes integrated out, of

    0.01/0.99 Σ w L_θ/N(r; 0, S) N(r; 0, S + (30 σ)²) / Σ w L_θ

Above 1 it is taken out, and again, up to a fifth of the readings. Without it half of what it says may still be a detail
of the machine: with h the regression of the unknowns on it, m += ½ h r, C += h hᵀ (½ s² + ¼ r²).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from axiscal.estimate.agreement import Agreement, agreement
from axiscal.estimate.draws import Draws, Mode, Weighed, draws, mode, redrawn, weighed
from axiscal.estimate.heavy_tails import Volume, shares_that_count
from axiscal.estimate.model import BAD
from axiscal.estimate.problem import MOST_NUMBERS, Problem
from axiscal.estimate.room import space_of
from axiscal.estimate.sizes import Kind
from axiscal.estimate.spaces import Given, parts_of
from axiscal.numerics import Array
from axiscal.numerics.threads import one_thread

_ODDS = 0.01 / 0.99
_MOST_BAD = 0.2
_DOUBTED = 3.0
"""Standard deviations from which on all draws are asked about one of many readings."""
_RENEWED = 10.0
"""Effective number of draws below which they are drawn anew."""


@dataclass(frozen=True, eq=False)
class LeftOut:
    """What the others expect of one reading.

    residual : (k,) read less expected, over the base noise; covariance : (k, k) of that; odds : that it is bad
    z : largest residual of its numbers, in standard deviations
    """

    residual: Array
    covariance: Array
    odds: float
    z: float


@dataclass(frozen=True, eq=False)
class Posterior:
    """mean (k,), covariance (k, k) : of errors, then set-ups' unknowns, m and rad

    cells : means of the rests of visited cells by (term, cell), m or rad
    sizes : root mean square of exp θ by kind and owner; effective : number of draws
    bad : readings that were taken out, in this order, by index; agreement : of the others
    left_out : of each reading that stayed
    """

    mean: Array
    covariance: Array
    cells: dict[tuple[int, int], float]
    sizes: dict[tuple[Kind, str], float]
    effective: float
    bad: dict[int, LeftOut]
    agreement: Agreement
    left_out: dict[int, LeftOut]
    drawn: Draws
    best: Mode


@one_thread()
def posterior(
    problem: Problem,
    before: Posterior | None = None,
    never: Iterable[int] = (),
    sure: Iterable[int] = (),
    over: Volume | None = None,
) -> Posterior:
    """Return the posterior of a problem.

    before : of nearly the same readings, whose draws are weighed anew while they are good for it
    never : readings that are not used; sure : readings that are not taken out
    over : the volume by which draws with large sizes are cut
    """
    bad = dict[int, LeftOut]()
    accepted, count = frozenset(sure), len(np.unique(problem.reading))
    drawn = before.drawn if before is not None and before.drawn.sizes == problem.sizes else None
    best = before.best if before is not None and drawn is not None else None
    stale = False
    while True:
        apart = [*never, *bad]
        mine = problem.only(~np.isin(problem.reading, apart)) if apart else problem
        space = space_of(mine)
        found = weighed(space, drawn) if drawn is not None and not stale else None
        if found is None or best is None or found.effective < _RENEWED:
            best = mode(space, None if best is None else best.x)
            drawn, stale = draws(space, best), False
            found = weighed(space, drawn)
            if found.effective < _RENEWED:
                drawn = redrawn(space, drawn, found)
                found = weighed(space, drawn)
        left = _left_out(mine, found)
        doubtful = {i: each.odds for i, each in left.items() if i not in accepted}
        worst = max(doubtful, key=lambda i: doubtful[i], default=None)
        if worst is None or doubtful[worst] <= 1 or len(bad) + 1 > _MOST_BAD * count:
            break
        bad[worst] = left[worst]
        stale = True
    assert drawn is not None
    moments = _moments(found, over)
    sizes = _sizes(mine, found, moments.counted)
    agreed = agreement(mine, found, np.array([each.z for each in left.values()]))
    known = dict(zip(problem.cells, moments.cells.tolist(), strict=True))
    return Posterior(moments.mean, moments.covariance, known, sizes, found.effective, bad, agreed, left, drawn, best)


@dataclass(frozen=True, eq=False)
class _Moments:
    """mean (k,), covariance (k, k); cells : means of rests (c,); counted : factor on each draw's covariance, (d,)"""

    mean: Array
    covariance: Array
    cells: Array
    counted: Array


def _moments(found: Weighed, over: Volume | None) -> _Moments:
    """Return the moments over the draws, those with the largest sizes cut to what they add to U."""
    answers = [each.answer() for each in found.given]
    about = answers[0].mean  # open zeros are large beside what draws differ by
    shift = np.sum([w * (each.mean - about) for w, each in zip(found.weights, answers, strict=True)], axis=0)
    aparts = [each.mean - about - shift for each in answers]
    counted = np.ones(len(answers))
    if over is not None:
        each = zip(answers, aparts, found.thetas, strict=True)
        counted = shares_that_count(np.array([over.square(a.covariance, b, c) for a, b, c in each]), found.weights)
    total = np.zeros_like(answers[0].covariance)
    for weight, answer, apart in zip(found.weights * counted, answers, aparts, strict=True):
        total += weight * (answer.covariance + np.outer(apart, apart))
    cells = np.sum([w * each.cells() for w, each in zip(found.weights, found.given, strict=True)], axis=0)
    return _Moments(about + shift, total, cells, counted)


def _sizes(problem: Problem, found: Weighed, counted: Array) -> dict[tuple[Kind, str], float]:
    """Return the root mean square of each size, as a factor on what is stated.  counted : (d,) of each draw"""
    squares = (found.weights * counted) @ np.exp(2 * found.thetas) if len(problem.sizes) else np.zeros(0)
    pairs = zip(problem.sizes.of, np.sqrt(squares).tolist(), strict=True)
    return {(size.kind, owner): factor for size, factor in pairs for owner in size.owners}


def _left_out(problem: Problem, found: Weighed) -> dict[int, LeftOut]:
    """Return what the others expect of each reading, by its index.

    Of many numbers the heaviest draw says it first, and all draws of those readings only that it doubts.
    """
    result = dict[int, LeftOut]()
    for part in parts_of(problem.reading):
        each = (
            _of_draws(problem, found, part) if len(problem.values) <= MOST_NUMBERS else _of_many(problem, found, part)
        )
        result.update(zip(problem.reading[part[:, 0]].tolist(), each, strict=True))
    return dict(sorted(result.items()))


def _of_many(problem: Problem, found: Weighed, part: NDArray[np.intp]) -> list[LeftOut]:
    """Return what the others expect of many readings of k numbers.  part : (r, k)"""
    heaviest = int(np.argmax(found.weights))
    alone = replace(found, thetas=found.thetas[[heaviest]], weights=np.ones(1), given=(found.given[heaviest],))
    result = _of_draws(problem, alone, part)
    doubted = [i for i, each in enumerate(result) if each.z > _DOUBTED]
    if doubted:
        for i, each in zip(doubted, _of_draws(problem, found, part[doubted]), strict=True):
            result[i] = each
    return result


def _of_draws(problem: Problem, found: Weighed, part: NDArray[np.intp]) -> list[LeftOut]:
    """Return what the others expect of readings of k numbers each, over all draws.  part : (r, k)"""
    each = [_of_draw(problem, given, theta, part) for given, theta in zip(found.given, found.thetas, strict=True)]
    residuals, covariances, ratios = (np.array(one) for one in zip(*each, strict=True))
    residual = np.einsum("n,nrk->rk", found.weights, residuals)
    apart = residuals - residual
    spread = np.einsum("n,nrkl->rkl", found.weights, covariances + apart[..., :, None] * apart[..., None, :])
    odds = _ODDS * found.weights @ np.exp(np.minimum(ratios, 600.0))
    squares = np.sum(residual * np.linalg.solve(spread, residual[..., None])[..., 0], axis=1) / part.shape[1]
    return [LeftOut(*one) for one in zip(residual, spread, odds.tolist(), np.sqrt(squares).tolist(), strict=True)]


def _of_draw(problem: Problem, given: Given, theta: Array, part: NDArray[np.intp]) -> tuple[Array, Array, Array]:
    """Return residuals (r, k), covariances (r, k, k) and log ratios of bad over good (r,) of readings at one draw."""
    weighted, blocks = given.left_out(part)
    covariances: Array = np.asarray(np.linalg.inv(blocks), dtype=float)
    residuals = (covariances @ weighted[..., None])[..., 0]
    sigma = np.exp(np.append(theta, 0.0))[problem.groups[part]]
    wide = covariances + (BAD.size * sigma[:, :, None]) ** 2 * np.eye(part.shape[1])
    inner = np.sum(residuals * np.linalg.solve(wide, residuals[..., None])[..., 0], axis=1)
    gain = np.sum(residuals * weighted, axis=1) - inner - _log_dets(blocks) - _log_dets(wide)
    return residuals, covariances, np.asarray(0.5 * gain)


def _log_dets(matrices: Array) -> Array:
    return np.asarray(np.linalg.slogdet(matrices)[1])
