"""A plan made such that its readings can vouch for it: what they would not show is made small along with the promise.

From the plan that is the best for its model, from that with as many readings evenly spaced, and from that exchanged:
of all of them, and of the two plain ones, the one whose readings, taken when their way takes them, vouch for least.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from axiscal.design.gains.running_gains import Scores
from axiscal.design.plan.defended import DefendedScores
from axiscal.design.plan.exchange import Allowed, exchange
from axiscal.design.plan.greedy import Trial, affordable
from axiscal.design.plan.order import in_order, seconds_each, seconds_of
from axiscal.design.plan.plain_designs import evenly_spaced, space_filling
from axiscal.design.plan.task import Clock, Limits, Task
from axiscal.design.plan.watch import Watch, retimed, watch
from axiscal.estimation.defence import Defence, EffectMap, vouched
from axiscal.measurement.place import Places
from axiscal.measurement.reading import Reading


class _How(NamedTuple):
    """How an exchange goes.  squarings : of p of the objective; better : by which share another reading brings more"""

    squarings: int
    sweeps: int
    better: float


_ROUGHLY = _How(2, 3, 0.02)
"""p = 4: nearly the largest of promise and damages counts, and the search sees which of them come next."""
_CLOSELY = _How(4, 4, 0.001)
"""p = 16: the largest of them counts."""


def guardable(task: Task, limits: Limits, scores: Scores) -> bool:
    """Whether plans are guarded here: of the volume, for no accuracy, of set-ups that read one number each."""
    return task.root is task.yardstick.root and not limits.accurate and scores.pool.scalar


def guarded(task: Task, limits: Limits, times: Clock, trial: Trial) -> Trial:
    """Return a plan with as many readings of each set-up that can vouch for most."""
    search = _Guarding(task, trial, affordable(times, trial.setups, limits.slack))
    tried = search.plain()
    tried += [search.exchanged(places, search.watched, _ROUGHLY) for places in tried]
    order = in_order(task, _best(task, limits, tried))
    later = retimed(search.watched, order, np.cumsum(seconds_each(task, order)))
    tried.append(search.exchanged(order, later, _CLOSELY))
    return replace(trial, scores=search.scored(_best(task, limits, tried)))


def _best(task: Task, limits: Limits, tried: Sequence[Places]) -> Places:
    """Return the readings that vouch for most; the first of them are within the limits, others may take too long."""
    most = np.inf if limits.budget is None else max(limits.budget, seconds_of(task, tried[0]))
    return min(
        (each for each in tried if seconds_of(task, each) <= most), key=lambda each: vouched_for(task, each).u_def
    )


class _Guarding:
    """What exchange makes of plans, of which the readings of each set-up keep their number."""

    def __init__(self, task: Task, trial: Trial, allowed: Allowed) -> None:
        self._task, self._trial, self._allowed = task, trial, allowed
        self.watched = watch(task.observation, task.yardstick, task.lattice)

    def plain(self) -> list[Places]:
        """Return the plan that is the best for its model, and those that need no thought."""
        places = self._trial.scores.places
        counts = [(s, int(np.sum(places.setups == s))) for s in self._trial.setups]
        return [places, evenly_spaced(self._task, counts), space_filling(self._task, counts)]

    def exchanged(self, places: Places, watched: Watch, how: _How) -> Places:
        """Return what exchange makes of readings."""
        scores = DefendedScores(self._trial.scores.pool, self._task.state, watched, self._task.yardstick, how.squarings)
        for index in range(len(places)):
            scores.enter(places.at(index))
        exchange(scores, self._allowed, how.sweeps, how.better)
        return scores.places

    def scored(self, places: Places) -> Scores:
        """Return plain scores of readings, which count the promise alone."""
        scores = Scores(self._trial.scores.pool, self._task.state)
        for index in range(len(places)):
            scores.enter(places.at(index))
        return scores


def vouched_for(task: Task, places: Places) -> Defence:
    """Return what readings can vouch for, each taken when the way through all of them takes it."""
    order = in_order(task, places)
    state, ends = task.state.opened(order), np.cumsum(seconds_each(task, order))
    rows, variances, owner = state.rows(order)
    others = np.bincount(owner) - 1
    setups, columns = task.observation.setups, (order.setups, order.poses, order.approaches, ends, others)
    readings = [
        Reading(setups[setup].name, tuple(pose), tuple(int(s) for s in sides), 0.0, others=(0.0,) * more, time=end)
        for setup, pose, sides, end, more in zip(*(column.tolist() for column in columns), strict=True)
    ]
    effects = EffectMap(task.yardstick, rows @ state.factor, np.sqrt(variances), state.weighted)
    promise = task.yardstick.rms_of(state.after_readings(order).value)
    return vouched(task.observation, readings, effects, promise)
