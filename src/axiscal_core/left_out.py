"""What the others expect of a reading that is left out, and the odds that it is bad.

It is expected with r = (K⁻¹_ii)⁻¹ (K⁻¹y)_i and covariance S = (K⁻¹_ii)⁻¹ (Rasmussen and Williams 2006, eq. 5.12). It is
bad with odds, sizes integrated out, of

    0.01/0.99 Σ w L_θ/N(r; 0, S) N(r; 0, S + (30 σ)²) / Σ w L_θ

the sizes as stated among the draws, whatever their weight: a bad reading hides behind the noise that it teaches. The
worst one is taken out while its odds are above 1, with those of nearly the same odds, but no more than a fifth of all.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from axiscal_core.draws import Draws, Weighed, sized
from axiscal_core.problem import MOST_NUMBERS, Problem
from axiscal_core.refusals import Array
from axiscal_core.spaces import Given, parts_of
from axiscal_core.theta import Kind

BAD_SHARE, OFF = 0.01, 30.0
"""Assumption: one of a hundred readings is bad, and then off by so many noises."""
MOST_BAD = 0.2
"""Where more than a fifth seem bad it is the model that is."""
_ALIKE = float(np.log(2.0))  # of log odds: which of such readings is bad nobody can say, and all go
_ODDS = BAD_SHARE / (1 - BAD_SHARE)  # of a bad reading before any is taken, by definition
_DOUBTED = 3.0  # standard deviations from which on all draws are asked about one of many readings


def surprises(residuals: Array, covariances: Array) -> Array:
    """Return z of readings of k numbers each, (r,): √(rᵀS⁻¹r/k).  residuals : (r, k); covariances : S (r, k, k)"""
    solved = np.linalg.solve(covariances, residuals[..., None])[..., 0]
    return np.asarray(np.sqrt(np.sum(residuals * solved, axis=1) / residuals.shape[1]))


@dataclass(frozen=True, eq=False)
class LeftOut:
    """What the others expect of one reading.

    residual : (k,) read less expected, over the base noise; covariance : (k, k) of that; log_odds : that it is bad
    z : of its numbers together, in standard deviations
    """

    residual: Array
    covariance: Array
    log_odds: float
    z: float


def left_out(problem: Problem, found: Weighed) -> dict[int, LeftOut]:
    """Return what the others expect of each reading, by its index.

    The heaviest draw goes first if numbers are many; all draws then judge only the readings that it suspects.
    """
    result = dict[int, LeftOut]()
    judged = _of_draws if len(problem.values) <= MOST_NUMBERS else _of_many
    for part in parts_of(problem.reading):
        result.update(zip(problem.reading[part[:, 0]].tolist(), judged(problem, found, part), strict=True))
    return dict(sorted(result.items()))


def with_stated(problem: Problem, found: Weighed, left: Mapping[int, LeftOut]) -> dict[int, LeftOut]:
    """Return what is known of the readings that are left out, their odds with one draw more: the sizes as stated.

    A bad reading makes noise seem large: without it the sizes may be those stated, of which no draw is left.
    """
    given, log_stated, result = found.drawn.stated, found.log_stated, dict(left)
    log_total = np.logaddexp(0.0, log_stated)
    for part in parts_of(problem.reading):
        _, _, ratios = _of_draw(problem, given, given.theta, part)
        for reading, ratio in zip(problem.reading[part[:, 0]].tolist(), ratios, strict=True):
            odds = np.logaddexp(left[reading].log_odds, np.log(_ODDS) + log_stated + ratio)
            result[reading] = replace(left[reading], log_odds=float(odds - log_total))
    return result


@dataclass(frozen=True, eq=False)
class Judged:
    """Readings, and draws of the sizes that they teach."""

    problem: Problem
    found: Weighed

    @classmethod
    def of(cls, problem: Problem, apart: Sequence[int] = (), before: Draws | None = None) -> Judged:
        """Return the readings of a problem but for some, by index.  before : draws for nearly the same ones"""
        mine = problem.only(~np.isin(problem.reading, apart)) if apart else problem
        return cls(mine, sized(mine, before))

    @cached_property
    def left(self) -> dict[int, LeftOut]:
        """What the others expect of each reading, by its index."""
        return with_stated(self.problem, self.found, left_out(self.problem, self.found))

    @property
    def sizes(self) -> dict[tuple[Kind, str], float]:
        """Each size, by kind and owner, as a factor on what is stated: variances add up, and lengths do not."""
        roots, logs = (
            np.sqrt(self.found.weights @ np.exp(2 * self.found.thetas)),
            self.found.weights @ self.found.thetas,
        )
        each = zip(self.problem.sizes.of, roots.tolist(), np.exp(logs).tolist(), strict=True)
        return {
            (size.kind, owner): middle if size.kind == "length" else root
            for size, root, middle in each
            for owner in size.owners
        }


def taken_out(first: Judged, accepted: Collection[int] = ()) -> tuple[dict[int, LeftOut], Judged]:
    """Return bad readings, the worst first, and the others.

    first : with all; accepted : are not taken out
    """
    bad, mine, count = dict[int, LeftOut](), first, len(np.unique(first.problem.reading))
    while True:
        doubtful = {i: each.log_odds for i, each in mine.left.items() if i not in accepted}
        highest = max(doubtful.values(), default=0.0)
        worst = [i for i, odds in doubtful.items() if odds >= highest - _ALIKE]
        if highest <= 0 or len(bad) + len(worst) > MOST_BAD * count:
            return bad, mine
        bad |= {i: mine.left[i] for i in worst}
        mine = Judged.of(first.problem, [*bad])


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
    most = np.max(ratios, axis=0)
    odds = np.log(_ODDS * (found.weights @ np.exp(ratios - most))) + most
    z = surprises(residual, spread).tolist()
    return [LeftOut(*one) for one in zip(residual, spread, odds.tolist(), z, strict=True)]


def _of_draw(problem: Problem, given: Given, theta: Array, part: NDArray[np.intp]) -> tuple[Array, Array, Array]:
    """Return residuals (r, k), covariances (r, k, k) and log ratios of bad over good (r,) of readings at one draw."""
    weighted, blocks = given.left_out(part)
    covariances: Array = np.asarray(np.linalg.inv(blocks), dtype=float)
    residuals = (covariances @ weighted[..., None])[..., 0]
    sigma = np.exp(np.append(theta, 0.0))[problem.groups[part]]
    wide = covariances + (OFF * sigma[:, :, None]) ** 2 * np.eye(part.shape[1])
    inner = np.sum(residuals * np.linalg.solve(wide, residuals[..., None])[..., 0], axis=1)
    log_dets = np.linalg.slogdet(blocks)[1] + np.linalg.slogdet(wide)[1]
    gain = np.sum(residuals * weighted, axis=1) - inner - log_dets
    return residuals, covariances, np.asarray(0.5 * gain)
