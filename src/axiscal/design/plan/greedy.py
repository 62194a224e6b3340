"""Which set-ups to use, and how many readings each is worth: greedily by gain per second, over sets of set-ups."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from axiscal.design.gains.candidate_rows import Pool
from axiscal.design.gains.running_accuracy import RunningAccuracy
from axiscal.design.gains.running_gains import Scores
from axiscal.design.plan.openings import openings
from axiscal.design.plan.task import Clock, Limits, Task
from axiscal.measurement.place import Places
from axiscal.numerics.ties import ALIKE, first_best

_COARSE = 1000
_PICKS = 50
_TRIED = 150
_EVERY_SUBSET = 4
"""Sets of up to so many set-ups are all tried; beyond it they would be hundreds."""
_MOST = 1000
"""A plan of more readings is for a robot; what it asks takes days."""
_STALLED = 1e-7
"""Share of the first J: a reading that brings less is none."""

Setups = tuple[int, ...]


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
        """What to compare trials by, the smaller the better: time where the accuracy is reached, else J."""
        if self.met and limits.accurate:
            return 0.0, self.seconds
        return 1.0, self.scores.state.value


def chosen_setups(task: Task, limits: Limits, times: Clock) -> Setups:
    """Return the set-ups that are worth their mounting.

    All sets of up to four set-ups are tried on a coarse lattice; with more, sets grow and shrink by one while it helps.
    """
    everything = tuple(int(s) for s in np.unique(task.lattice.setups))
    if len(everything) == 1:
        return everything
    base = Scores(Pool(task.observation, _thinned(task), task.memory), task.state)
    meter = RunningAccuracy.of(task.yardstick, base.state.factor)

    longest = np.inf

    def key(setups: Setups) -> tuple[float, float]:
        nonlocal longest
        bundle = _bundle(limits, times, setups)
        trial = filled(base.fork(), meter, limits, times, setups, bundle, _TRIED, longest)
        if trial.met and limits.accurate:
            longest = min(longest, trial.seconds)
        return trial.key(limits)

    if len(everything) <= _EVERY_SUBSET:
        sets = [s for count in range(len(everything), 0, -1) for s in combinations(everything, count)]
        return min(sets, key=key)
    return _grown(everything, key)


def _grown(everything: Setups, key: Callable[[Setups], tuple[float, float]]) -> Setups:
    key(everything)
    best: Setups = min(((s,) for s in everything), key=key)
    value = key(best)
    while True:
        more = [(*best, s) for s in everything if s not in best]
        fewer = [s for s in combinations(best, len(best) - 1) if s]
        tried = {tuple(sorted(s)): key(tuple(sorted(s))) for s in [*more, *fewer]}
        step = min(tried, key=lambda s: tried[s], default=best)
        if not tried or not tried[step] < value:
            return best
        best, value = step, tried[step]


def _bundle(limits: Limits, times: Clock, setups: Setups) -> int:
    """Return how many readings to take for one, so that a set of set-ups is judged by a few dozen picks.

    Where an accuracy is asked for it is one: which set-ups reach it first is a matter of single readings.
    """
    if limits.accurate:
        return 1
    most = limits.readings or _MOST
    if limits.budget is not None:
        left = limits.budget - float(times.mounting[list(setups)].sum())
        most = min(most, int(max(left, 0.0) / float(times.reading[list(setups)].min())))
    return 1 + most // _PICKS


def filled(
    scores: Scores,
    meter: RunningAccuracy,
    limits: Limits,
    times: Clock,
    setups: Setups,
    bundle: int = 1,
    most: int = _MOST,
    longest: float = np.inf,
) -> Trial:
    """Take the candidate with the most gain (per second, where time counts) until a limit is reached.

    bundle : readings that are taken together as one with so much less noise
    most, longest : picks and seconds after which to give up an accuracy
    """
    of = scores.pool.lattice.setups
    spent, cost = float(times.mounting[list(setups)].sum()), bundle * times.reading[of]
    allowed = np.isin(of, setups)
    for index in openings(scores, setups, limits.readings or _MOST):
        scores.enter(index, bundle=bundle)
        meter, spent = _after(meter, scores, limits), spent + float(cost[index])
    start = scores.state.value
    picks = 0
    while not (met := limits.accurate and limits.met(meter.accuracy)) and bundle * len(scores.members) < (
        limits.readings or _MOST
    ):
        picks += 1
        if picks > most or spent > longest:
            break
        open_to = allowed & (spent + cost <= (limits.budget or np.inf))
        if not open_to.any():
            break
        rate = np.where(open_to, scores.gains / (cost if limits.timed else 1.0), -np.inf)
        best = first_best(rate, ALIKE)
        gain = scores.enter(best, bundle=bundle)
        meter, spent = _after(meter, scores, limits), spent + float(cost[best])
        if gain < _STALLED * start and limits.readings is None and limits.budget is None:
            break
    return Trial(scores, setups, spent, met)


def _after(meter: RunningAccuracy, scores: Scores, limits: Limits) -> RunningAccuracy:
    """Return the accuracy after the last reading, or what there is where none is asked for."""
    return meter.after(scores.last) if limits.accurate else meter


def affordable(times: Clock, setups: Setups, slack: float) -> Callable[[Scores, int], NDArray[np.bool_]]:
    """Return which candidates may stand in a slot: of these set-ups, and no dearer than what it held plus the slack."""

    used = np.isin(np.arange(len(times.reading)), setups)

    def allowed(scores: Scores, slot: int) -> NDArray[np.bool_]:
        room = times.reading[scores.places.setups[slot]] + slack
        fitting: NDArray[np.bool_] = (used & (times.reading <= room + 1e-9))[scores.pool.lattice.setups]
        return fitting

    return allowed


def _thinned(task: Task) -> Places:
    step = max(1, len(task.lattice) // _COARSE)
    return task.lattice.within(np.arange(0, len(task.lattice), step))
