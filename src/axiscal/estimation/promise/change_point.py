"""What changed from one reading on: a zero that jumped, what stands on the table and moved, a stretch with other signs.

The likeliest one is weighed, and at odds above 20 : 1 it stays and the next one is sought. No size is beyond ten times
what is stated (`description.usual`), so none stands for a jump. One reading alone beyond a jump is a bad reading. What
stands on the table may have stood elsewhere since its first reading, too.

Readings out and back along one axis cannot tell a jump where it turns from backlash: both add the same to them. Such a
step is weighed likewise, and named unless backlash is 20 times as likely; over a plane unless a detail is likelier.

Stretches reach to the last reading, or from one turn to another. For a sign that turned, each value y is −y. On an axis
that is counted from its other end the values of a pass come in opposite order. Sides that are swapped change K: twice
each column of backlash comes on top.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.promise.mistake import (
    CONTRADICTS,
    LOG_BAD,
    LOG_NAMED,
    PRIOR,
    SEVERAL,
    Explained,
    Mistake,
    Sought,
    Suspect,
    Tried,
    gains_of_steps,
    likeliest,
    numbers_of_one,
    of_kinds,
    some_of,
    tail_of,
)
from axiscal.numerics import Array
from axiscal_core.draws import Weighed, sized
from axiscal_core.left_out import MOST_BAD
from axiscal_core.problem import Problem
from axiscal_core.spaces import sums_of

_JUMPS = 30.0, 1e3, 3e4
"""Noises: standard deviations of a jump, one as likely as the other: it slips, is nudged, or is set to zero anew."""
_BEYOND = 2
"""Readings before and behind a jump, at least; between two jumps lie several."""
_ALIKE = 1e-6
"""Of a column: rounding, below which others make it as well."""
_SHORTEST = 3
"""Readings of a stretch, and beside it: one or two bad readings are bad readings."""
_TWICE = 2.0
"""Standard deviations of a backlash that is turned round."""
_DIGITS = 6
"""Of log odds: what is as likely before a reading as behind it is said of the later ones."""


class Jumped(NamedTuple):
    """problem : with columns for the jumps; found, without : its draws, and those for the readings without any jump

    jumps : in the order found; log_odds : of all of them together, beside none; rivals : that do as well as the last
    """

    problem: Problem
    found: Weighed
    without: Weighed
    jumps: tuple[Explained, ...] = ()
    log_odds: float = 0.0
    rivals: tuple[Tried, ...] = ()


def jumped(problem: Problem, found: Weighed | None = None, sure: Collection[int] = ()) -> Jumped | None:
    """Return the jumps that readings tell, one after the other; None for none.

    found : draws for the readings without any; sure : readings before which what seems a jump is backlash
    """
    known, log_prior = None, 0.0
    while suspected := likeliest(suspects(known or problem, sure), LOG_NAMED):
        found = found or sized(problem)
        before = known or Jumped(problem, found, found)
        moved = [_with_one_more(before, log_prior, each) for each in suspected]
        best = max(moved, key=lambda each: each.log_odds)
        if best.log_odds - before.log_odds <= LOG_NAMED:
            break
        rivals = (Tried(each.jumps[-1], tail_of(each.problem, each.found)) for each in moved if each is not best)
        near = tuple(each for each in rivals if each.mistake.log_odds > best.log_odds - LOG_NAMED)
        log_prior += suspected[moved.index(best)].prior
        known = best._replace(rivals=near)
    return known


def _with_one_more(before: Jumped, log_prior: float, suspect: Suspect) -> Jumped:
    other = suspect.make()
    found = sized(other)
    log_odds = found.log_evidence - before.without.log_evidence + log_prior + suspect.prior
    return Jumped(other, found, before.without, (*before.jumps, suspect.mistake._replace(log_odds=log_odds)), log_odds)


def likelier(moved: Jumped, here: tuple[Problem, Weighed], there: tuple[Problem, Weighed]) -> tuple[Tried, ...]:
    """Return jumps where these are 20 times as likely as bad readings alone, and the readings agree with them.

    here, there : the readings without the bad ones, beside the jumps and without any, with their draws
    Both are compared by what neither takes for bad. Each other bad reading costs its prior, over its width. Where jumps
    and bad readings are more than a fifth of all it is the model that is wrong.
    """
    mine, others, every = (np.unique(each.reading) for each in (here[0], there[0], moved.problem))
    both = np.intersect1d(mine, others)
    gain = _evidence(*here, both) - _evidence(*there, both) - (len(mine) - len(others)) * LOG_BAD
    p = tail_of(*here)
    log_prior = moved.log_odds - moved.found.log_evidence + moved.without.log_evidence
    if gain + log_prior <= LOG_NAMED or 2 * p < CONTRADICTS:
        return ()
    if len(every) - len(mine) + len(moved.jumps) > MOST_BAD * len(every):
        return ()
    told = tuple(Tried(each._replace(log_odds=moved.log_odds), p) for each in moved.jumps)
    return told + moved.rivals


def _evidence(problem: Problem, found: Weighed, kept: NDArray[np.intp]) -> float:
    """Return the log evidence of some of the readings, up to a constant."""
    among = np.isin(problem.reading, kept)
    return (found if among.all() else sized(problem.only(among))).log_evidence


def at_turns(sought: Sought, sure: Collection[int]) -> Iterator[Suspect]:
    """Yield the jumps where an axis turned, and those over a plane.  sure : readings before which it is backlash"""
    problem = sought.problem
    over_plane = any(size.kind == "together" for size in problem.sizes.of)
    for _, mine in sought.of_setups():
        of, turn = np.unique(problem.reading[mine]), turn_of(problem, mine)
        readings = np.array([turn]) if turn >= 0 else of[_BEYOND : -_BEYOND if over_plane else 0]
        readings = np.setdiff1d(readings, [*sure])
        if len(readings) and numbers_of_one(problem.reading[mine]) == 1:
            found = _likeliest_jump(sought, mine, readings)
            yield found._replace(mistake=found.mistake._replace(detail=turn < 0))


def turn_of(problem: Problem, mine: NDArray[np.bool_]) -> int:
    """Return the reading of a set-up, by its index, before which a jump does what backlash does; −1 for none."""
    backlash, reading = problem.rows[:, of_kinds(problem, "reversal")], problem.reading[mine]
    turns = np.flatnonzero(np.diff(np.sign(backlash[mine].sum(axis=1)))) + 1
    if len(turns) != 1 or numbers_of_one(reading) > 1 or not _BEYOND <= turns[0] <= len(reading) - _BEYOND:
        return -1
    turn = int(reading[turns[0]])
    column = (mine & (problem.reading >= turn)) / problem.noise
    others = np.hstack([backlash, problem.rows[:, problem.rows.shape[1] - problem.unknowns :]])
    left = column - others @ np.linalg.lstsq(others, column, rcond=None)[0]
    return turn if np.linalg.norm(left) < _ALIKE * np.linalg.norm(column) else -1


def suspects(known: Jumped | Problem, sure: Collection[int] = ()) -> Iterator[Suspect]:
    """Yield the likeliest jump and stretch of each set-up.

    known : with the jumps that have columns; sure : readings before which what seems a jump is backlash
    """
    problem, told = (known, ()) if isinstance(known, Problem) else (known.problem, known.jumps)
    if len(np.unique(problem.reading)) < _BEYOND:
        return
    sought = Sought.of(problem)
    for setup, mine in sought.of_setups():
        of = np.unique(problem.reading[mine])
        before = np.searchsorted(of, [each.reading for each in told if each.mistake == "jump" and setup in each.setups])
        readings = of[_BEYOND : len(of) - _BEYOND + 1]
        near = np.abs(np.searchsorted(of, readings)[:, None] - before) < SEVERAL
        readings = readings[~near.any(axis=1)]
        turn = turn_of(problem, mine)
        readings = readings[readings != turn] if turn in sure else readings
        if not len(before) and len(of) > 1 and numbers_of_one(problem.reading[mine]) > 1:
            readings = np.append(of[0], readings)
        if len(readings):
            yield _likeliest_jump(sought, mine, readings)
        yield from stretches(sought, mine)


def _likeliest_jump(sought: Sought, mine: NDArray[np.bool_], readings: NDArray[np.intp]) -> Suspect:
    """Return the likeliest of the jumps before some readings.  One before the first is another place of the set-up"""
    problem = sought.problem
    ways = ways_of(problem, mine) / problem.noise * float(np.median(problem.noise[mine]))
    tried = some_of(len(readings))
    for finest in (len(tried) == len(readings), True):
        starts = np.searchsorted(problem.reading, readings[tried])
        log_odds = sought.log_odds(gains_of_steps(sought.each, ways, starts, _JUMPS))
        size, place = np.unravel_index(np.argmax(log_odds), log_odds.shape)
        first = int(readings[tried[place]])
        if finest:
            break
        tried = some_of(len(readings), int(tried[place]))
    prior = float(np.log(PRIOR / (len(_JUMPS) * len(readings))))
    name: Mistake = "jump" if problem.reading[mine][0] < first else "place"
    setups, backlash = (int(problem.setup[mine][0]),), first == turn_of(problem, mine)
    mistake = Explained(name, prior + float(log_odds[size, place]), setups, first, backlash=backlash)
    return Suspect(mistake, prior, partial(problem.wider, _JUMPS[size] * ways * (problem.reading >= first)))


def ways_of(problem: Problem, mine: NDArray[np.bool_]) -> Array:
    """Return what a jump of each kind adds to the numbers of a set-up, one at most, (k, m).

    A zero adds the same to all. What is read in three directions may move by all that its mounting alone leaves open.
    """
    if numbers_of_one(problem.reading[mine]) == 1 or not problem.unknowns:
        return mine[None].astype(float)
    seen = problem.rows[:, -problem.unknowns :].T * problem.noise
    largest = np.abs(seen).max(axis=1)
    own = (largest > 0) & (np.abs(seen[:, ~mine]).max(axis=1, initial=0.0) == 0)
    return np.asarray(seen[own] / largest[own, None]) if own.any() else mine[None].astype(float)


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


def stretches(sought: Sought, mine: NDArray[np.bool_]) -> Iterator[Suspect]:
    """Yield the likeliest stretch of each kind.  mine : (m,) of the set-up"""
    problem = sought.problem
    readings, number = np.unique(problem.reading[mine], return_inverse=True)
    backlash = problem.rows[:, of_kinds(problem, "reversal")].T * mine
    sides = np.bincount(number, backlash.sum(axis=0)[mine], len(readings))
    turns = np.flatnonzero(np.diff(np.sign(sides), prepend=np.nan, append=np.nan))
    for parts in _parts(problem, mine, backlash, turns):
        count, odds, start, stop = _likeliest_stretch(sought, parts, readings, turns)
        if not count:
            continue
        wrong = mine & (problem.reading >= readings[start]) & (problem.reading <= readings[stop - 1])
        other = {"values": problem.values + np.where(wrong, parts.added[0], 0.0)}
        if parts.std:
            turned = np.outer(wrong, of_kinds(problem, "reversal", "way"))
            other = {"rows": np.where(turned, -problem.rows, problem.rows)}
        last, factor = -1 if stop == len(readings) else int(readings[stop - 1]), -1.0 if parts.wrong == "sign" else 1.0
        setups, prior = (int(problem.setup[mine][0]),), float(np.log(PRIOR / count))
        told = Explained(parts.wrong, odds + prior, setups, int(readings[start]), factor, last=last)
        yield Suspect(told, prior, partial(replace, problem, **other))


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


def _likeliest_stretch(
    sought: Sought, parts: _Parts, readings: NDArray[np.intp], turns: NDArray[np.intp]
) -> tuple[int, float, int, int]:
    """Return how many stretches there are, log odds of the likeliest one, and its edges.

    Of those that are as likely the one that begins last counts.  readings : (r,) of the set-up
    """
    edges, last, ends = parts.edges, len(readings), turns[:-1]
    count = np.count_nonzero((edges >= _SHORTEST) & (edges <= last - _SHORTEST))
    count += int(np.searchsorted(turns, ends - _SHORTEST, side="right").sum())
    begin = np.union1d(edges[some_of(len(edges))], turns[some_of(len(turns))])
    end = np.append(ends[some_of(len(ends))], last)
    for finest in (len(begin) >= len(edges), True):
        tried = np.union1d(begin, end)
        starts = np.searchsorted(sought.problem.reading, readings[tried[:-1]])
        at = np.searchsorted(tried, begin), np.searchsorted(tried, end)
        gains = _gains_of_stretches(sought, parts, starts, *at)
        between = np.isin(begin, turns)[:, None] & (end < last)
        possible = (end - begin[:, None] >= _SHORTEST) & (between | ((begin[:, None] >= _SHORTEST) & (end == last)))
        log_odds = np.where(possible, sought.log_odds(gains), -np.inf)
        place = np.unravel_index(np.argmax(np.round(log_odds, _DIGITS)[::-1, ::-1]), log_odds.shape)
        row, column = (len(of) - 1 - int(k) for of, k in zip((begin, end), place, strict=True))
        first, to = int(begin[row]), int(end[column])
        if finest:
            break
        begin = edges[some_of(len(edges), int(np.searchsorted(edges, first)))]
        end = end[-1:] if to == last else np.append(ends[some_of(len(ends), int(np.searchsorted(ends, to)))], last)
    return int(count), float(log_odds[row, column]), first, to


def _gains_of_stretches(
    sought: Sought, parts: _Parts, starts: NDArray[np.intp], begin: NDArray[np.intp], end: NDArray[np.intp]
) -> Array:
    """Return the gain of each stretch at each of n sizes, (n, b, e).

    starts : numbers; begin, end : of which of them it reaches to which
    """
    gains = np.zeros((len(sought.each), len(begin), len(end)))
    for added in parts.added[parts.added.any(axis=1)]:
        for gain, sums in zip(gains, sums_of(sought.each, added[None], starts), strict=True):
            square, pull = sums.between(begin, end)
            if parts.std:
                square = np.maximum(square, 0.0)  # of what ends before it begins
                gain += 0.5 * (pull**2 / (square + parts.std**-2) - np.log1p(parts.std**2 * square))
            else:
                gain -= pull + square / 2
    return gains
