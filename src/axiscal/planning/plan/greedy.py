"""Which set-ups to use, and how many readings each is worth: greedily by gain per second, over sets of set-ups."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.reading import Places
from axiscal.numerics import even_subset
from axiscal.numerics.remembered import remembered
from axiscal.numerics.ties import ALIKE, first_best
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.covariance import LowRank, RunningAccuracy, informed
from axiscal.planning.gains.running_gains import Scores
from axiscal.planning.plan.run import first_seconds
from axiscal.planning.plan.task import Clock, Limits, Task, clock

_TRIED = 150
_WORTH = 1e-3
"""Share of J that a set-up more must bring, or it is mounted for nothing."""
_EVERY_SUBSET = 4
"""Sets of up to so many set-ups are all tried; beyond it they would be hundreds."""
_ROUNDING = 1e-9
"""Share of a budget: what takes longer by less fits."""
_MOST = 1000
"""A plan of more readings is for a robot; what it asks takes days."""
_STALLED = 1e-7
"""Share of the first J: a reading that brings less is none."""

Setups = tuple[int, ...]
_RECENT = 16
"""Picks by which it is judged what the next ones bring: gains fall, so that none brings more."""
_TOLD = 0.5
"""Of an unknown's variance: a reading that takes more of it away tells of little else."""


@dataclass(frozen=True, eq=False, slots=True)
class Trial:
    """A plan in the making.

    setups : that it may use; seconds : with the usual ways; met : whether the accuracy asked for is reached
    """

    scores: Scores
    setups: Setups
    seconds: float
    met: bool

    def key(self, limits: Limits) -> tuple[float, float]:
        """Key to compare trials by, the smaller the better: time where the accuracy is reached, else J."""
        if self.met and limits.accurate:
            return 0.0, self.seconds
        return 1.0, self.scores.state.value


@remembered
def chosen_setups(task: Task, limits: Limits) -> Setups:
    """Return the set-ups that are worth their mounting, by picks from a coarse lattice.

    For so many readings one set of each size is tried, see `_growing`. For an accuracy all sets of up to four set-ups
    are; of more one of each size, and the best of these grows and shrinks by one while it helps.
    """
    everything = tuple(int(s) for s in np.unique(task.lattice.setups))
    if len(everything) == 1:
        return everything
    base, meter, times = *_coarse(task), clock(task)
    longest = np.inf

    def key(setups: Setups) -> tuple[float, float]:
        nonlocal longest
        trial = filled(base.among(setups), meter, limits, times, setups, _TRIED, longest)
        if trial.met and limits.accurate:
            longest = min(longest, trial.seconds)
        return trial.key(limits)

    if not limits.accurate or len(everything) > _EVERY_SUBSET:
        parts = _parts(task, everything)
        sets = _growing(base, parts, limits, times)
        return _changed(sets, parts, key) if limits.accurate else of_best_size(sets, key)
    # all of them first: what takes longer than they do to reach the accuracy is given up at once
    values = {everything: key(everything)}
    values |= {s: key(s) for count in range(1, len(everything)) for s in combinations(everything, count)}
    return min(values, key=lambda setups: (values[setups], len(setups)))


def sets_within(task: Task, limits: Limits) -> list[Setups]:
    """Return sets of set-ups that grow, all of which a budget can mount and read; none where it is too short."""
    most, first = (limits.budget or 0.0) * (1 + _ROUNDING), first_seconds(task)

    def fits(setups: Setups) -> bool:
        return sum(first[setup] for setup in setups) <= most

    everything = tuple(setup for setup in first if fits((setup,)))
    parts = [part for part in _parts(task, everything) if fits(part)]
    sets = parts if len(parts) < 2 else _growing(_coarse(task)[0], parts, limits, clock(task))
    return [setups for setups in sets if fits(setups)]


def worth_most(task: Task) -> int:
    """Return the set-up of the candidate with the most gain in its time, mounting included where it is not mounted."""
    times, (scores, _) = clock(task), _coarse(task)
    of = scores.pool.lattice.setups
    return int(of[first_best(scores.gains / (times.mounting + times.reading)[of], ALIKE)])


def within_reach(task: Task, limits: Limits) -> bool:
    """Return whether picks reach the accuracy with all set-ups together."""
    scores, meter = _coarse(task)
    everything = tuple(int(s) for s in np.unique(task.lattice.setups))
    return filled(scores, meter, limits, clock(task), everything, most=_TRIED).met


def _coarse(task: Task) -> tuple[Scores, RunningAccuracy]:
    """Return the gains of a thinned lattice, and the accuracy before any reading."""
    scores = Scores(Pool(task.observation, task.coarse.lattice), task.state)
    return scores, RunningAccuracy.from_factor(task.yardstick, scores.state.factor)


def _parts(task: Task, everything: Setups) -> list[Setups]:
    """Return each set-up alone, and those together that share an unknown, as the legs of a square do."""
    own = {setup: set(task.observation.unknowns_of(setup).tolist()) for setup in everything}
    linked = {tuple(other for other in everything if own[setup] & own[other]) for setup in everything}
    return sorted({(setup,) for setup in everything} | linked - {()})


def _growing(base: Scores, parts: Sequence[Setups], limits: Limits, times: Clock) -> list[Setups]:
    """Return sets that grow part by part: by the part with which readings, dealt out evenly, leave least."""
    state, lattice = base.state, base.pool.lattice
    every = {setup: _in_a_row(lattice, setup) for setup in np.unique(lattice.setups).tolist()}

    def remaining(setups: Setups) -> float:
        shares = np.array_split(np.arange(_most_readings(limits, times, setups)), len(setups))
        dealt = [
            _evenly(every[setup], len(share), turn / len(setups))
            for turn, (setup, share) in enumerate(zip(setups, shares, strict=True))
        ]
        rows, _ = state.whitened(lattice.within(np.concatenate(dealt)))
        return float(np.sum(informed(state.weighted, rows) ** 2))

    sets: list[Setups] = [()]
    while more := [tuple(sorted({*sets[-1], *part})) for part in parts if not {*part} <= {*sets[-1]}]:
        sets.append(min(more, key=remaining))
    return sets[1:]


def _in_a_row(lattice: Places, setup: int) -> NDArray[np.intp]:
    """Return the candidates of a set-up in a row, of which every n-th stand for all."""
    mine = np.flatnonzero(lattice.setups == setup)
    return mine[even_subset(np.hstack([lattice.poses[mine], lattice.approaches[mine]]), len(mine))]


def _evenly(candidates: NDArray[np.intp], count: int, shift: float) -> NDArray[np.intp]:
    """Return so many candidates of a row; those of other shifts stand elsewhere.  shift : share of their distance"""
    return candidates[((np.arange(count) + shift) * len(candidates) / max(count, 1)).astype(np.intp)]


def of_best_size(sets: Sequence[Setups], key: Callable[[Setups], tuple[float, float]]) -> Setups:
    """Return the best of sets that grow: every next one is better up to it, and hardly better behind it."""
    low, high = 0, len(sets) - 1
    while low < high:
        middle = (low + high) // 2
        worth = key(sets[middle + 1])[1] < (1 - _WORTH) * key(sets[middle])[1]
        low, high = (middle + 1, high) if worth else (low, middle)
    return sets[low]


def _changed(sets: Sequence[Setups], parts: Sequence[Setups], key: Callable[[Setups], tuple[float, float]]) -> Setups:
    """Return the best of sets that grow, and what it becomes by a part more or a set-up less while that helps."""
    best = min(reversed(sets), key=key)
    value = key(best)
    while True:
        more = [tuple(sorted({*best, *part})) for part in parts if not {*part} <= {*best}]
        fewer = [s for s in combinations(best, len(best) - 1) if s]
        tried = {setups: key(setups) for setups in [*more, *fewer]}
        step = min(tried, key=lambda s: tried[s], default=best)
        if not tried or not tried[step] < value:
            return best
        best, value = step, tried[step]


def _most_readings(limits: Limits, times: Clock, setups: Setups) -> int:
    """Return how many readings the limits allow, but no more than are tried."""
    most = min(limits.readings or _TRIED, _TRIED)
    if limits.budget is None:
        return most
    left = limits.budget - float(times.mounting[list(setups)].sum())
    return min(most, int(max(left, 0.0) / float(times.reading[list(setups)].min())))


def filled(
    scores: Scores,
    meter: RunningAccuracy,
    limits: Limits,
    times: Clock,
    setups: Setups,
    most: int = _MOST,
    longest: float = np.inf,
    begun: float | None = None,
) -> Trial:
    """Take the candidate with the most gain (per second, where time counts) until a limit is reached.

    most, longest : picks and seconds after which to give up an accuracy; with a longest, once it is out of reach
    begun : seconds of the readings that are there already; None where the plan begins, by opening its set-ups
    """
    of, readings = scores.pool.lattice.setups, limits.readings or _MOST
    spent = float(times.mounting[list(setups)].sum()) if begun is None else begun
    cost, allowed = times.reading[of], np.isin(of, setups)
    scores, opened = openings(scores, setups, readings) if begun is None else (scores, [])
    for index, change in opened:
        meter, spent = meter.after(change) if limits.accurate else meter, spent + float(cost[index])
    start, missed = scores.state.value, [limits.missed(meter.accuracy)]
    picks = 0
    while not (met := missed[-1] <= 0) and len(scores.places) < readings:
        picks += 1
        left = min(most - picks + 1, readings - len(scores.places))
        if picks > most or spent > longest or (longest < np.inf and _hopeless(missed, left)):
            break
        rate = np.where(allowed, scores.gains / (cost if limits.timed else 1.0), -np.inf)
        best = first_best(rate, ALIKE)
        gain = scores.enter(best)
        meter, spent = meter.after(scores.last) if limits.accurate else meter, spent + float(cost[best])
        missed.append(limits.missed(meter.accuracy))
        if gain < _STALLED * start and limits.readings is None:
            break
    return Trial(scores, setups, spent, met)


def _hopeless(missed: Sequence[float], left: float) -> bool:
    """Return whether so many picks more miss an accuracy, were each worth as much as the last ones.

    missed : what is left of the accuracy's excess after each pick so far
    """
    recent = missed[-_RECENT:]
    return len(missed) > _RECENT and recent[-1] * len(recent[1:]) > left * (recent[0] - recent[-1])


def scores_among(task: Task, setups: Setups) -> Scores:
    """Return the gains of the candidates of some set-ups, before the first reading of a plan."""
    lattice = task.lattice.within(np.isin(task.lattice.setups, setups))
    return Scores(Pool(task.observation, lattice), task.state)


def picked(task: Task, limits: Limits, setups: Setups) -> Places:
    """Return the readings that picks alone make a plan of, before any exchange: about as many."""
    meter = RunningAccuracy.from_factor(task.yardstick, task.state.factor)
    return filled(scores_among(task, setups), meter, limits, clock(task), setups).scores.places


def affordable(times: Clock, setups: Setups, slack: float) -> Callable[[Scores, int], NDArray[np.bool_]]:
    """Return which candidates may stand in a slot: of these set-ups, and no dearer than what it held plus the slack."""

    used = np.isin(np.arange(len(times.reading)), setups)

    def allowed(scores: Scores, slot: int) -> NDArray[np.bool_]:
        room = times.reading[scores.places.setups[slot]] + slack
        fitting: NDArray[np.bool_] = (used & (times.reading <= room + 1e-9))[scores.pool.lattice.setups]
        return fitting

    return allowed


def openings(scores: Scores, setups: Sequence[int], readings: int) -> tuple[Scores, list[tuple[int, LowRank]]]:
    """Return the gains after readings that make known what set-ups leave open of themselves, and their changes.

    The first reading of a set-up tells little but its zero, the next one on a square how that lies turned: no gain
    would ever open them. One unknown alone is opened by any reading.
    readings : so many there may be at most; where more are needed there are none
    """
    columns = np.unique(np.concatenate([scores.state.observation.unknowns_of(setup) for setup in setups]))
    if len(columns) < 2:
        return scores, []
    ahead, found = scores.fork(), list[tuple[int, LowRank]]()
    while True:
        told = ahead.told(columns)
        best = first_best(told, ALIKE)
        if not told[best] > _TOLD:
            return ahead, found
        if len(found) == readings:
            return scores, []
        ahead.enter(best)
        found.append((best, ahead.last))
