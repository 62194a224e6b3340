"""A plan made such that its readings can vouch for it: what they would not show is made small along with the promise.

From the plan that is the best for its model, from that with as many readings evenly spaced, and from that exchanged:
of all of them, and of the two plain ones, the one whose readings, taken when their way takes them, vouch for least.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from axiscal.design.gains.running_gains import Scores
from axiscal.design.plan.defended import DefendedScores
from axiscal.design.plan.exchange import Allowed, exchange
from axiscal.design.plan.greedy import Trial, affordable
from axiscal.design.plan.order import in_order, seconds_each
from axiscal.design.plan.out_and_back import returns
from axiscal.design.plan.plain_designs import evenly_spaced, space_filling
from axiscal.design.plan.task import Clock, Limits, Task
from axiscal.design.plan.watch import Watch, retimed, watch
from axiscal.estimation.defence import Defence, EffectMap, vouched
from axiscal.measurement.place import Places
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.ties import ALIKE, first_best


class _How(NamedTuple):
    """How an exchange goes.  squarings : of p of the objective; better : by which share another reading brings more"""

    squarings: int
    sweeps: int
    better: float


_ROUGHLY = _How(2, 3, 0.02)
"""p = 4: nearly the largest of promise and damages counts, and the search sees which of them come next."""
_CLOSELY = _How(4, 4, 0.001)
"""p = 16: the largest of them counts."""
_MANY = 120
"""Unknowns beyond which only the plan that is the best for its model is exchanged, of time."""
_FEW = 5
"""Of fewer readings none is given up to watch a drift."""


def guardable(task: Task, limits: Limits, scores: Scores) -> bool:
    """Whether plans are guarded here: of the volume, for no accuracy, of set-ups that read one number each."""
    return task.root is task.yardstick.root and not limits.accurate and scores.pool.scalar


def guarded(task: Task, limits: Limits, times: Clock, trial: Trial) -> Trial:
    """Return a plan with as many readings of each set-up that can vouch for most."""
    search = _Guarding(task, trial, affordable(times, trial.setups, limits.slack))
    tried = [_tried(task, places) for places in search.plain()]
    starts = tried if task.observation.size <= _MANY else tried[:1]
    tried += [_tried(task, search.exchanged(each.order, search.watched, _ROUGHLY)) for each in starts]
    best = _best(limits, tried)
    later = retimed(search.watched, best.order, best.ends)
    tried.append(_tried(task, search.exchanged(best.order, later, _CLOSELY)))
    best = _best(limits, tried)
    closed = [_tried(task, places) for places in search.closed(best.order)]
    return replace(trial, scores=search.scored(_best(limits, [*tried[:1], best, *closed]).order))


class _Tried(NamedTuple):
    """Readings in their order.  ends : (m,) when each ends, s; vouched : what they can vouch for, m"""

    order: Places
    ends: Array
    vouched: float


def _tried(task: Task, places: Places) -> _Tried:
    order = in_order(task, places)
    ends = np.cumsum(seconds_each(task, order))
    return _Tried(order, ends, vouched_along(task, order, ends).u_def)


def _best(limits: Limits, tried: Sequence[_Tried]) -> _Tried:
    """Return the readings that vouch for most; the first of them are within the limits, others may take too long."""
    most = np.inf if limits.budget is None else max(limits.budget, float(tried[0].ends[-1]))
    fitting = [each for each in tried if each.ends[-1] <= most]
    return fitting[first_best(-np.array([each.vouched for each in fitting]), ALIKE)]


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

    def closed(self, order: Places) -> Iterator[Places]:
        """Yield the readings with one of a set-up of several axes given up for its first one once more, at its end.

        So for each of them, and for all; on a way out and back the search finds such readings by itself.
        """
        losses, closed, every = self.scored(order).losses(), order, 0
        for setup, mine in order.by_setup():
            if not returns(self._task.observation.setups[setup]) and len(mine) > _FEW:
                least = int(mine[1:][first_best(-losses[mine[1:]], ALIKE)])
                yield order.exchanged(least, order.at(int(mine[0])))
                closed, every = closed.exchanged(least, order.at(int(mine[0]))), every + 1
        if every > 1:
            yield closed

    def scored(self, places: Places) -> Scores:
        """Return plain scores of readings, which count the promise alone."""
        scores = Scores(self._trial.scores.pool, self._task.state)
        for index in range(len(places)):
            scores.enter(places.at(index))
        return scores


def vouched_for(task: Task, places: Places) -> Defence:
    """Return what readings can vouch for, each taken when the way through all of them takes it."""
    order = in_order(task, places)
    return vouched_along(task, order, np.cumsum(seconds_each(task, order)))


def vouched_along(task: Task, order: Places, ends: Array) -> Defence:
    """Return what readings in this order can vouch for.  ends : (m,) when each ends, s"""
    state = task.state.opened(order)
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
