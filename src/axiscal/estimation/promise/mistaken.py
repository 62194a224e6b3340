"""What readings gain in log L by what a mistake adds: to all from one on, or to a stretch of one set-up.

Columns B of standard deviation s, as of a zero that is set anew, come on top of all other unknowns:

    gain = ½ gᵀ(F + s⁻²)⁻¹g − ½ log |1 + s² F|,    g = BᵀK⁻¹y, F = BᵀK⁻¹B

Where values are not what was read, each reading, or each pass from one turn to the next, has a part d of what is wrong.
Sums that grow from part to part give the gain of all stretches at once. Of many places these are sought coarse to fine:

    y' = y + Σ dᵢ,    gain = −Σ gᵢ − ½ Σ Fᵢⱼ,    gᵢ = dᵢᵀK⁻¹y, Fᵢⱼ = dᵢᵀK⁻¹dⱼ

For a sign that turned, d is −2 yᵢ. For an axis that is counted from its other end, the values of a pass come in
opposite order, and d is what that changes. Sides that are swapped change K: twice each column of backlash comes on
top. Stretches reach to the last reading, or from one turn to another.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.promise.agreement import NAMED, PRIOR, Explained, Mistake
from axiscal.estimation.promise.causes import AtFeed
from axiscal.numerics import Array
from axiscal_core.draws import as_stated, sized
from axiscal_core.problem import Problem
from axiscal_core.spaces import Given, sums_of
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
_AT_ONCE = 1000
"""Places that are looked at in one go: more take time and memory, and between them lie few readings."""
_DIGITS = 6
"""Of log odds: what is as likely before a reading as behind it is said of the later ones."""


class Suspect(NamedTuple):
    """A mistake that readings may tell.  make : returns them as a problem with it; places : it is one of"""

    mistake: Explained
    make: Callable[[], Problem]
    places: int


class _Parts(NamedTuple):
    """What is wrong, part by part.

    edges : (u + 1,) number of the first reading of each part in its set-up, and their count
    added : (q, m) to the numbers of each part, nothing to those of other set-ups
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
    return _gains(columns @ weighted.transpose(0, 2, 1), weighted @ values, stds)


def gains_of_steps(each: Sequence[Given], ways: Array, starts: NDArray[np.intp], stds: Sequence[float]) -> Array:
    """Return the gain of columns that begin at each of some numbers, (n, s, r), as of `gains_of_columns`.

    Sums that grow take their place: m p + r p² operations and r p numbers, and not r m p and r m.
    each : of n sizes with the same noise; ways : (k, m) each from the first number on; starts : (r,) ascending
    """
    return np.array([_gains(*sums.to_the_end(), stds) for sums in sums_of(each, ways, starts)])


def _gains(fisher: Array, pulled: Array, stds: Sequence[float]) -> Array:
    """Return the gain of columns of each standard deviation, (s, r).  fisher : F (r, k, k); pulled : g (r, k)"""
    alone, gains = np.eye(pulled.shape[1]), np.empty((len(stds), len(pulled)))
    for k, size in enumerate(stds):
        solved = np.linalg.solve(fisher + size**-2 * alone, pulled[:, :, None])[:, :, 0]
        gains[k] = 0.5 * (np.sum(pulled * solved, axis=1) - np.linalg.slogdet(alone + size**2 * fisher)[1])
    return gains


def some_of(count: int, near: int | None = None) -> NDArray[np.intp]:
    """Return which of some places are looked at, coarse to fine: each of few, evenly many, or all about the best."""
    apart = -(-count // _AT_ONCE)
    return np.arange(0, count, apart) if near is None else np.arange(max(near - apart, 0), min(near + apart + 1, count))


def stretches(problem: Problem, each: Sequence[Given], mine: NDArray[np.bool_]) -> Iterator[Suspect]:
    """Yield the likeliest stretch of each kind.  each : everything at some sizes; mine : (m,) of the set-up"""
    readings, number = np.unique(problem.reading[mine], return_inverse=True)
    backlash = problem.rows[:, _of_kinds(problem, "reversal")].T * mine
    sides = np.bincount(number, backlash.sum(axis=0)[mine], len(readings))
    turns = np.flatnonzero(np.diff(np.sign(sides), prepend=np.nan, append=np.nan))
    for parts in _parts(problem, mine, backlash, turns):
        count, odds, start, stop = _likeliest(problem, each, parts, readings, turns)
        if not count:
            continue
        wrong = mine & (problem.reading >= readings[start]) & (problem.reading <= readings[stop - 1])
        values = problem.values + np.where(wrong, parts.added[0], 0.0)
        make = partial(_with_sides, problem, wrong) if parts.std else partial(replace, problem, values=values)
        to, factor = -1 if stop == len(readings) else int(readings[stop - 1]), -1.0 if parts.wrong == "sign" else 1.0
        setups, odds = (int(problem.setup[mine][0]),), odds + float(np.log(PRIOR / count))
        yield Suspect(Explained(parts.wrong, odds, setups, int(readings[start]), factor, last=to), make, count)


def _with_sides(problem: Problem, wrong: NDArray[np.bool_]) -> Problem:
    """Return the problem with the other side of some numbers.  wrong : (m,)"""
    turned = np.outer(wrong, _of_kinds(problem, "reversal", "way"))
    return replace(problem, rows=np.where(turned, -problem.rows, problem.rows))


def _parts(problem: Problem, mine: NDArray[np.bool_], backlash: Array, turns: NDArray[np.intp]) -> Iterator[_Parts]:
    """Yield the parts of each kind.  mine : (m,) of the set-up; backlash : (q, m) of it; turns : edges"""
    every = np.arange(turns[-1] + 1)
    if not problem.mean.any():  # what was inherited does not turn with what is read
        yield _Parts("sign", every, np.where(mine, -2 * problem.values, 0.0)[None])
    if len(turns) <= 2:
        return
    yield _Parts("sides", every, backlash, _TWICE)
    values, off = problem.values * problem.noise, np.zeros(len(problem.values))
    numbers = np.flatnonzero(mine).reshape(turns[-1], -1)
    for at in (numbers[first:last] for first, last in pairwise(turns)):
        off[at] = values[at[::-1]] / problem.noise[at] - problem.values[at]
    yield _Parts("mirrored", turns, off[None])


def _likeliest(
    problem: Problem, each: Sequence[Given], parts: _Parts, readings: NDArray[np.intp], turns: NDArray[np.intp]
) -> tuple[int, float, int, int]:
    """Return how many stretches there are, log odds of the likeliest one, and its edges.

    Of those that are as likely the one that begins last counts.  readings : (r,) of the set-up
    """
    edges, last, ends = parts.edges, len(readings), turns[:-1]
    count = np.count_nonzero((edges >= _SHORTEST) & (edges <= last - _SHORTEST))
    count += int(np.searchsorted(turns, ends - _SHORTEST, side="right").sum())
    begin = np.union1d(edges[some_of(len(edges))], turns[some_of(len(turns))])
    end = np.append(ends[some_of(len(ends))], last)
    for finest in (len(edges) <= _AT_ONCE, True):
        tried = np.union1d(begin, end)
        starts = np.searchsorted(problem.reading, readings[tried[:-1]])
        at = np.searchsorted(tried, begin), np.searchsorted(tried, end)
        gains = _of_stretches(each, parts, starts, *at)
        between = np.isin(begin, turns)[:, None] & (end < last)
        possible = (end - begin[:, None] >= _SHORTEST) & (between | ((begin[:, None] >= _SHORTEST) & (end == last)))
        log_odds = np.where(possible, log_odds_of(each, gains), -np.inf)
        place = np.unravel_index(np.argmax(np.round(log_odds, _DIGITS)[::-1, ::-1]), log_odds.shape)
        row, column = (len(of) - 1 - int(k) for of, k in zip((begin, end), place, strict=True))
        first, to = int(begin[row]), int(end[column])
        if finest:
            break
        begin = edges[some_of(len(edges), int(np.searchsorted(edges, first)))]
        end = end[-1:] if to == last else np.append(ends[some_of(len(ends), int(np.searchsorted(ends, to)))], last)
    return int(count), float(log_odds[row, column]), first, to


def _of_stretches(
    each: Sequence[Given], parts: _Parts, starts: NDArray[np.intp], begin: NDArray[np.intp], end: NDArray[np.intp]
) -> Array:
    """Return the gain of each stretch at each of n sizes, (n, b, e).

    starts : numbers; begin, end : of which of them it reaches to which
    """
    gains = np.zeros((len(each), len(begin), len(end)))
    for added in parts.added[parts.added.any(axis=1)]:
        for gain, sums in zip(gains, sums_of(each, added[None], starts), strict=True):
            square, pull = sums.between(begin, end)
            if parts.std:
                square = np.maximum(square, 0.0)  # of what ends before it begins
                gain += 0.5 * (pull**2 / (square + parts.std**-2) - np.log1p(parts.std**2 * square))
            else:
                gain -= pull + square / 2
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
    return sized(problem).log_evidence
