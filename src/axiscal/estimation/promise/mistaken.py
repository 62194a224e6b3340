"""What readings gain in log L by what a mistake adds: to all from one on, or to a stretch of one set-up.

Columns B of standard deviation s, as of a zero that is set anew, come on top of all other unknowns:

    gain = ½ gᵀ(F + s⁻²)⁻¹g − ½ log |1 + s² F|,    g = BᵀK⁻¹y, F = BᵀK⁻¹B

Where values are not what was read, each reading, or each pass from one turn to the next, has a part d of what is wrong.
Sums that grow from part to part give the gain of all stretches at once:

    y' = y + Σ dᵢ,    gain = −Σ gᵢ − ½ Σ Fᵢⱼ,    gᵢ = dᵢᵀK⁻¹y, Fᵢⱼ = dᵢᵀK⁻¹dⱼ

For a sign that turned, d is −2 yᵢ. For an axis that is counted from its other end, the values of a pass come in
opposite order, and d is what that changes. Sides that are swapped change K: twice each column of backlash comes on
top. Stretches reach to the last reading, or from one turn to another.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.promise.agreement import NAMED, PRIOR, Explained, Mistake
from axiscal.estimation.promise.causes import AtFeed
from axiscal.numerics import Array
from axiscal_core.draws import as_stated, sized
from axiscal_core.problem import Problem
from axiscal_core.spaces import Given
from axiscal_core.theta import Kind
from axiscal_core.unknowns import space_of

_SHORTEST = 3
"""Readings of a stretch, and beside it: one or two bad readings are bad readings."""
_TWICE = 2.0
"""Standard deviations of a backlash that is turned round."""
_FEED = (3.0, 30.0), (1.0, 3.0)
"""Standard deviations at feed: of a lag, noises; of what is missing of a reversal that has just turned, itself."""
_OFF = tuple(np.log([0.1, 1 / 3, 3.0]).tolist())
"""Of θ: factors that stated sizes are off by. Far larger ones than the machine's swallow what is wrong."""
_DIGITS = 6
"""Of log odds: what is as likely before a reading as behind it is said of the later ones."""


class Suspect(NamedTuple):
    """A mistake that readings may tell.  other : they as a problem with it; places : it is one of"""

    mistake: Explained
    other: Problem
    places: int


class _Parts(NamedTuple):
    """What is wrong, part by part.

    edges : (u + 1,) number of the first reading of each part in its set-up, and their count; added : (q, u, m)
    std : of each of the q, 0 where it is no unknown
    """

    wrong: Mistake
    edges: NDArray[np.intp]
    added: Array
    std: float = 0.0


def _of_kinds(problem: Problem, *kinds: Kind) -> NDArray[np.bool_]:
    """Return which columns have a size of these kinds, (p,)."""
    return np.isin(problem.size_at, [i for i, size in enumerate(problem.sizes.of) if size.kind in kinds])


def as_stated_or_not(problem: Problem, stated: Given | None = None) -> list[Given]:
    """Return everything at sizes as stated, and at a tenth, a third and three times these.  stated : the former"""
    space = space_of(problem)
    kept = np.array([size.kind in ("length", "noise") for size in problem.sizes.of], dtype=bool)
    others = [space.given(np.where(kept, 0.0, off)) for off in _OFF]
    return [stated or as_stated(space), *(other for other in others if other is not None)]


def log_odds_of(each: Sequence[Given], gains: Array) -> Array:
    """Return log odds over some sizes.  gains : of each of the sizes first"""
    densities = np.array([given.density for given in each])
    beside = densities.reshape(-1, *[1] * (gains.ndim - 1))
    return np.asarray(np.logaddexp.reduce(gains + beside) - np.logaddexp.reduce(densities))


def gains_of_columns(given: Given, columns: Array, values: Array, stds: Sequence[float]) -> Array:
    """Return the gain of columns of each standard deviation, (s, r).  columns : (r, k, m)"""
    weighted = given.judged(columns.reshape(-1, len(values)).T).T.reshape(columns.shape)
    fisher, pulled = columns @ weighted.transpose(0, 2, 1), weighted @ values
    alone, gains = np.eye(columns.shape[1]), np.empty((len(stds), len(columns)))
    for k, size in enumerate(stds):
        solved = np.linalg.solve(fisher + size**-2 * alone, pulled[:, :, None])[:, :, 0]
        gains[k] = 0.5 * (np.sum(pulled * solved, axis=1) - np.linalg.slogdet(alone + size**2 * fisher)[1])
    return gains


def stretches(problem: Problem, each: Sequence[Given], mine: NDArray[np.bool_]) -> Iterator[Suspect]:
    """Yield the likeliest stretch of each kind.  each : everything at some sizes; mine : (m,) of the set-up"""
    readings = np.unique(problem.reading[mine])
    alone = mine & (problem.reading == readings[:, None])
    backlash = problem.rows[:, _of_kinds(problem, "reversal")].T
    turns = np.flatnonzero(np.diff(np.sign(alone @ backlash.sum(axis=0)), prepend=np.nan, append=np.nan))
    for parts in _parts(problem, alone, backlash, turns):
        begin, end = (edge[::-1] for edge in np.triu_indices(len(parts.edges), 1))
        first, last = parts.edges[begin], parts.edges[end]
        between = np.isin(first, turns) & np.isin(last, turns[:-1])
        possible = (last - first >= _SHORTEST) & (between | ((first >= _SHORTEST) & (last == len(readings))))
        if not possible.any():
            continue
        begin, end = begin[possible], end[possible]
        log_odds = log_odds_of(each, np.array([_gains(given, problem.values, parts, begin, end) for given in each]))
        best = int(np.argmax(np.round(log_odds, _DIGITS)))
        start, stop = int(parts.edges[begin[best]]), int(parts.edges[end[best]])
        if parts.std:
            turned = np.outer(alone[start:stop].any(axis=0), _of_kinds(problem, "reversal", "way"))
            other = replace(problem, rows=np.where(turned, -problem.rows, problem.rows))
        else:
            other = replace(problem, values=problem.values + parts.added[0, begin[best] : end[best]].sum(axis=0))
        to = -1 if stop == len(readings) else int(readings[stop - 1])
        odds, factor = float(log_odds[best] + np.log(PRIOR / len(begin))), -1.0 if parts.wrong == "sign" else 1.0
        setups = (int(problem.setup[mine][0]),)
        wrong = Explained(parts.wrong, odds, setups, int(readings[start]), factor, last=to)
        yield Suspect(wrong, other, len(begin))


def _parts(problem: Problem, alone: NDArray[np.bool_], backlash: Array, turns: NDArray[np.intp]) -> Iterator[_Parts]:
    """Yield the parts of each kind.  alone : (r, m) numbers of each reading; backlash : (q, m); turns : edges"""
    every = np.arange(len(alone) + 1)
    if not problem.mean.any():  # what was inherited does not turn with what is read
        yield _Parts("sign", every, np.where(alone, -2 * problem.values, 0.0)[None])
    if len(turns) <= 2:
        return
    yield _Parts("sides", every, alone * backlash[:, None, :], _TWICE)
    values, passes = problem.values * problem.noise, np.zeros((len(turns) - 1, len(problem.values)))
    for part, (first, last) in zip(passes, pairwise(turns), strict=True):
        numbers = np.array([np.flatnonzero(one) for one in alone[first:last]])
        part[numbers] = values[numbers[::-1]] / problem.noise[numbers] - problem.values[numbers]
    yield _Parts("mirrored", turns, passes[None])


def _gains(given: Given, values: Array, parts: _Parts, begin: NDArray[np.intp], end: NDArray[np.intp]) -> Array:
    """Return the gain of each stretch, (s,).  begin, end : (s,) its edges"""
    gains, last = np.zeros(len(begin)), len(parts.edges)
    for added in parts.added:
        weighted = given.judged(added.T)
        pulled, fisher = np.zeros(last), np.zeros((last, last))
        pulled[1:] = np.cumsum(values @ weighted)
        fisher[1:, 1:] = np.cumsum(np.cumsum(added @ weighted, axis=0), axis=1)
        pull = pulled[end] - pulled[begin]
        square = fisher[end, end] - fisher[begin, end] - fisher[end, begin] + fisher[begin, begin]
        if parts.std:
            gains += 0.5 * (pull**2 / (square + parts.std**-2) - np.log1p(parts.std**2 * square))
        else:
            gains -= pull + square / 2
    return gains


def with_feed(problem: Problem, circles: Iterable[AtFeed]) -> Problem:
    """Return the problem with what servos do to circles, of each that is 20 times as likely with it.

    The likeliest of both, of each size, is weighed with the sizes integrated out: a large noise looks like them. Then
    both count, and a reversal is as large as stated: what a circle shows of it does not teach its size.

    circles : of `problem`
    """
    for circle in (circle for circle in circles if circle.both):
        each, both = as_stated_or_not(problem), [some / problem.noise for some in (circle.lag, circle.late)]
        tried = [std * some for some, stds in zip(both, _FEED, strict=True) for std in stds]
        gains = [[gains_of_columns(given, some[None], problem.values, [1.0])[0, 0] for some in tried] for given in each]
        log_odds = log_odds_of(each, np.array(gains))
        likeliest = tried[int(np.argmax(log_odds))]
        if log_odds.max() > 0 and _evidence(problem.wider(likeliest, "way")) > _evidence(problem) + np.log(NAMED):
            wide = problem.wider(np.vstack([max(stds) * some for stds, some in zip(_FEED, both, strict=True)]), "way")
            problem = replace(wide, size_at=np.where(_of_kinds(wide, "reversal"), -1, wide.size_at))
    return problem


def _evidence(problem: Problem) -> float:
    return sized(space_of(problem)).log_evidence
