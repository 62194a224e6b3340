"""A zero that jumped between two readings of one set-up, or what stands on the table and moved there.

Sizes that are learnt swallow a jump: a drift of a hundred noises has it between any two readings. Those stated do where
the machine is better. So it is sought at these, at a tenth, a third and three times as much, by the gain of its columns
(`mistaken`). Signs, sides and places that are wrong for a stretch are sought with it.

The likeliest one is then weighed with the sizes integrated out, by the evidence of the readings with its columns and
without. No size is beyond ten times what is stated (`description.usual`), so none stands for a jump. At odds above 20 :
1, its prior of 1 % over all its places included, its columns stay, and the next one is sought. One reading alone beyond
a jump is a bad reading. What stands on the table may have stood elsewhere since its first reading, too.

Readings out and back along one axis cannot tell a jump where it turns from backlash: both add the same to them. Such a
step is weighed likewise, and named unless backlash is 20 times as likely; over a plane unless a detail is likelier.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.promise.agreement import (
    CONTRADICTS,
    NAMED,
    PRIOR,
    SEVERAL,
    Explained,
    Mistake,
    Tried,
    numbers_of_one,
    tail_of,
)
from axiscal.estimation.promise.mistaken import (
    Suspect,
    as_stated_or_not,
    gains_of_steps,
    log_odds_of,
    some_of,
    stretches,
)
from axiscal.numerics import Array
from axiscal_core.draws import Weighed, sized
from axiscal_core.left_out import BAD_SHARE, MOST_BAD, OFF
from axiscal_core.problem import Problem
from axiscal_core.spaces import Given

_JUMPS = 30.0, 1e3, 3e4
"""Noises: standard deviations of a jump, one as likely as the other: it slips, is nudged, or is set to zero anew."""
_BEYOND = 2
"""Readings before and behind a jump, at least; between two jumps lie several."""
_NAMED = float(np.log(NAMED))
LOG_BAD = float(np.log(BAD_SHARE / OFF))
"""Of log odds: what a bad reading costs."""
_ALIKE = 1e-6
"""Of a column: rounding, below which others make it as well."""
_WEIGHED = 3
"""Suspects that are weighed: each costs as much as an estimate."""


class Jumped(NamedTuple):
    """problem : with columns for the jumps; found, without : its draws, and those for the readings without any jump

    jumps : in the order found; log_prior : of all of them; rivals : that do as well as the last one
    """

    problem: Problem
    found: Weighed
    without: Weighed
    jumps: tuple[Explained, ...] = ()
    log_prior: float = 0.0
    rivals: tuple[Tried, ...] = ()

    @property
    def log_odds(self) -> float:
        """Of all jumps together, beside none."""
        return self.found.log_evidence - self.without.log_evidence + self.log_prior


def jumped(problem: Problem, found: Weighed | None = None, sure: Collection[int] = ()) -> Jumped | None:
    """Return the jumps that readings tell, one after the other; None for none.

    found : draws for the readings without any; sure : readings before which what seems a jump is backlash
    """
    known, told = None, tuple[Explained, ...]()
    while suspected := [
        one for one in suspects(known.problem if known else problem, told, sure) if one.mistake.log_odds > _NAMED
    ]:
        found = found or sized(problem)
        following = _weighed(known or Jumped(problem, found, found), suspected)
        if following is None:
            break
        known, told = following, following.jumps
    return known


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
    if gain + moved.log_prior <= _NAMED or 2 * p < CONTRADICTS:
        return ()
    if len(every) - len(mine) + len(moved.jumps) > MOST_BAD * len(every):
        return ()
    told = tuple(Tried(each._replace(log_odds=moved.log_odds), p) for each in moved.jumps)
    return told + moved.rivals


def _evidence(problem: Problem, found: Weighed, kept: NDArray[np.intp]) -> float:
    """Return the log evidence of some of the readings, up to a constant."""
    among = np.isin(problem.reading, kept)
    return (found if among.all() else sized(problem.only(among))).log_evidence


def _weighed(known: Jumped, suspected: list[Suspect]) -> Jumped | None:
    """Return what is known with one more mistake, None where readings tell no other."""
    best, tried = known, list[Tried]()
    for suspect in sorted(suspected, key=lambda one: -one.mistake.log_odds)[:_WEIGHED]:
        other, prior = suspect.make(), known.log_prior + float(np.log(PRIOR / suspect.places))
        found = sized(other)
        moved = Jumped(other, found, known.without, (*known.jumps, suspect.mistake), prior)
        tried.append(Tried(suspect.mistake._replace(log_odds=moved.log_odds), tail_of(other, found)))
        best = moved if best is known or moved.log_odds > best.log_odds else best
    if best.log_odds - known.log_odds <= _NAMED:
        return None
    others = sorted(tried, key=lambda one: -one.mistake.log_odds)[1:]
    return best._replace(rivals=tuple(one for one in others if one.mistake.log_odds > best.log_odds - _NAMED))


def at_turns(problem: Problem, found: Weighed, sure: Collection[int]) -> Iterator[Tried]:
    """Yield the jumps where an axis turned, unless backlash is 20 times as likely, and those over a plane.

    found : draws for the readings without any; sure : readings before which it is backlash
    """
    over_plane = any(size.kind == "together" for size in problem.sizes.of)
    for setup in np.unique(problem.setup).tolist():
        mine = problem.setup == setup
        of, turn = np.unique(problem.reading[mine]), turn_of(problem, mine)
        readings = np.array([turn]) if turn >= 0 else of[_BEYOND : -_BEYOND if over_plane else 0]
        readings = np.setdiff1d(readings, [*sure])
        if not len(readings) or numbers_of_one(problem.reading[mine]) > 1:
            continue
        suspect = _suspect(problem, as_stated_or_not(problem, found.drawn.stated), mine, readings, False)
        if suspect.mistake.log_odds <= -_NAMED:
            continue
        prior = float(np.log(PRIOR / suspect.places)) - found.log_evidence
        yield Tried.of(suspect.mistake._replace(detail=turn < 0), prior, suspect.make())


def turn_of(problem: Problem, mine: NDArray[np.bool_]) -> int:
    """Return the reading of a set-up, by its index, before which a jump does what backlash does; −1 for none."""
    of_backlash = np.isin(problem.size_at, [i for i, size in enumerate(problem.sizes.of) if size.kind == "reversal"])
    backlash, reading = problem.rows[:, of_backlash], problem.reading[mine]
    turns = np.flatnonzero(np.diff(np.sign(backlash[mine].sum(axis=1)))) + 1
    if len(turns) != 1 or numbers_of_one(reading) > 1 or not _BEYOND <= turns[0] <= len(reading) - _BEYOND:
        return -1
    turn = int(reading[turns[0]])
    column = (mine & (problem.reading >= turn)) / problem.noise
    others = np.hstack([backlash, problem.rows[:, problem.rows.shape[1] - problem.unknowns :]])
    left = column - others @ np.linalg.lstsq(others, column, rcond=None)[0]
    return turn if np.linalg.norm(left) < _ALIKE * np.linalg.norm(column) else -1


def suspects(problem: Problem, told: Sequence[Explained] = (), sure: Collection[int] = ()) -> Iterator[Suspect]:
    """Yield the likeliest jump of each set-up, at sizes as stated and others.

    told : jumps that have columns; sure : readings before which what seems a jump is backlash
    """
    if len(np.unique(problem.reading)) < _BEYOND:
        return
    each = as_stated_or_not(problem)
    for setup in np.unique(problem.setup).tolist():
        mine = problem.setup == setup
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
            yield _suspect(problem, each, mine, readings, bool(readings[0] == of[0]))
        yield from stretches(problem, each, mine)


def _suspect(
    problem: Problem, each: list[Given], mine: NDArray[np.bool_], readings: NDArray[np.intp], stands: bool
) -> Suspect:
    """Return the likeliest of the jumps before some readings.  stands : the first of them is that of the set-up"""
    ways = ways_of(problem, mine) / problem.noise * float(np.median(problem.noise[mine]))
    tried = some_of(len(readings))
    for finest in (len(tried) == len(readings), True):
        starts = np.searchsorted(problem.reading, readings[tried])
        log_odds = log_odds_of(each, gains_of_steps(each, ways, starts, _JUMPS))
        size, place = np.unravel_index(np.argmax(log_odds), log_odds.shape)
        best = int(tried[place])
        if finest:
            break
        tried = some_of(len(readings), best)
    places = len(_JUMPS) * len(readings)
    name: Mistake = "place" if stands and best == 0 else "jump"
    odds = float(log_odds[size, place] + np.log(PRIOR / places))
    setup, first = int(problem.setup[mine][0]), int(readings[best])
    mistake = Explained(name, odds, (setup,), first, backlash=first == turn_of(problem, mine))
    columns = _JUMPS[size] * ways * (problem.reading >= first)
    return Suspect(mistake, partial(problem.wider, columns), places)


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
