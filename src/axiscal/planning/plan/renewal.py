"""The rest of a plan, renewed while measuring: from the readings that are still open, by what exchanges still help.

Readings of linear instruments sharpen a belief by their places, not by their values. So the rest of a plan is still the
plan, as long as each reading is accepted at its planned place. Otherwise the search here begins with it, so that the
renewed plan is no worse than the old one, and little has to be looked at.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.place import Places
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.covariance import RunningAccuracy
from axiscal.planning.gains.running_gains import Scores
from axiscal.planning.plan.exchange import drop, exchange, fitted, polish
from axiscal.planning.plan.greedy import Setups, Trial, affordable, filled, within_reach
from axiscal.planning.plan.interleaved import interleaved
from axiscal.planning.plan.order import arriving, in_order, seconds_along
from axiscal.planning.plan.task import Clock, Limits, Patience, Task, clock

_SWEEPS = 3
_WORTH = 0.01
"""An exchange must bring a hundredth more than the reading it replaces: less is not worth another way."""
_ROUNDS = 2
_MORE = 10
"""So many readings at once are added to a plan that has come to fall short."""
_FAR, _MOST = 40, 150
"""Readings more that are tried before a plan of other set-ups: the first always, all while mounting takes longer."""


def renewed(
    task: Task, limits: Limits, left: Places, patience: float = 0.0, unsure: float = 1.0, usual: bool = False
) -> Places:
    """Return the readings to come in their order, from those that are left of a plan and within its set-ups.

    limits : what is left of them; patience : operations that climbing off the lattice may take
    unsure : factor by which what is foreseen may yet become larger, as learnt sizes do: what may be needed stays
    usual : with what usually goes wrong: what is new is interleaved with the rest
    None are returned where there is no time for any of these set-ups, or they fall short by much and others do not.
    """
    times = clock(task)
    left = _mountable(limits, times, left)
    setups = _setups(task, left)
    lattice = task.lattice.within(np.isin(task.lattice.setups, setups))
    places = left
    if len(lattice):
        trial = _begun(task, limits, times, Pool(task.observation, lattice, task.memory), setups, left)
        others = np.setdiff1d(task.lattice.setups, setups) if limits.accurate else np.zeros(0, dtype=np.intp)
        trial = _filled(task, limits, times, trial, others)
        if len(others) and not trial.met and within_reach(task, limits):
            return Places.none(left.poses.shape[1])
        exchange(trial.scores, affordable(times, setups, limits.slack), _SWEEPS, _WORTH)
        polish(trial.scores, affordable(times, setups, 0.0), _ROUNDS, Patience(patience))
        places = fitted(task, limits.times(1 / unsure), times, trial).scores.places
    order = _ordered(task, limits, places, left, usual)
    return replace(order, approaches=arriving(task, order))


def _ordered(task: Task, limits: Limits, places: Places, left: Places, usual: bool) -> Places:
    """Return readings in their order: as it was where it holds the same ones, and a way out and back takes no less."""
    order, same = in_order(task, places), places.same_as(left)
    if same and (usual or seconds_along(task, left) <= seconds_along(task, order)):
        return left
    return interleaved(task, limits, order) if usual else order


def _mountable(limits: Limits, times: Clock, left: Places) -> Places:
    """Return the readings of the set-ups that there is time to mount, one after another."""
    spent, kept = 0.0, set[int]()
    for setup in dict.fromkeys(left.setups.tolist()):
        first = float(times.mounting[setup] + times.reading[setup])
        if limits.budget is None or spent + first <= limits.budget:
            spent += first
            kept.add(setup)
    return left.within(np.isin(left.setups, list(kept)))


def _setups(task: Task, left: Places) -> Setups:
    mounted = [] if task.here is None else task.here.setups.tolist()
    return tuple(sorted({*mounted, *left.setups.tolist()}))


def _begun(task: Task, limits: Limits, times: Clock, pool: Pool, setups: Setups, left: Places) -> Trial:
    """Return the plan that is left, of no more readings than there may be."""
    scores = Scores(pool, task.state)
    scores.enter_all(left)
    while limits.readings is not None and len(scores.places) > limits.readings:
        drop(scores, times)
    return Trial(scores, setups, 0.0, met=False)


def _filled(task: Task, limits: Limits, times: Clock, trial: Trial, others: NDArray[np.intp]) -> Trial:
    """Return the plan with more readings where it misses the accuracy; a budget is filled later.

    others : set-ups that could be mounted instead of reading on for longer than that takes
    """
    if limits.budget is not None and not limits.accurate:
        return trial
    most, longest = _MORE, np.inf
    if len(others):
        mounted = float((times.mounting + times.reading)[others].max())
        most, longest = _MOST, max(mounted, _FAR * float(times.reading[list(trial.setups)].min()))
    meter = RunningAccuracy.of(task.yardstick, trial.scores.state.factor)
    return filled(trial.scores, meter, replace(limits, budget=None), times, trial.setups, 1, most, longest, begun=0.0)
