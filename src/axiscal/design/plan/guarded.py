"""A plan made such that its readings can vouch for it: what they would not show is made small along with the promise.

From the plan that is the best for its model, from that with as many readings evenly spaced, and from that exchanged:
of all of them, and of the two plain ones, the one whose readings, taken when their way takes them, vouch for least.
Where one bad reading of it does much more than that, it is exchanged such that others contradict that one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.accuracy.damage import KAPPA
from axiscal.design.gains.candidate_rows import Pool
from axiscal.design.gains.running_accuracy import RunningAccuracy
from axiscal.design.gains.running_gains import Allowed, Scores
from axiscal.design.plan.defended import DefendedScores
from axiscal.design.plan.exchange import exchange
from axiscal.design.plan.greedy import Trial, affordable
from axiscal.design.plan.order import in_order, seconds_each
from axiscal.design.plan.plain_designs import plain_designs
from axiscal.design.plan.task import Clock, Limits, Task, clock
from axiscal.design.plan.watch import Humps, Watch, doubting, retimed, watch
from axiscal.estimation.defence import OPEN, Defence, vouched, with_gaps
from axiscal.estimation.effect_map import EffectMap
from axiscal.measurement.place import Places
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.ties import ALIKE, first_best


class _How(NamedTuple):
    """How an exchange goes.  squarings : of p of the objective; better : by which share another reading brings more

    humps : watched for
    """

    squarings: int
    sweeps: int
    better: float
    humps: Humps


_ROUGHLY, _FINELY = _How(2, 3, 0.02, "bump"), _How(2, 3, 0.02, "detail")
"""p = 4: nearly the largest of promise and damages counts, and the search sees which of them come next. Neither leads
to the better plan always: 24 readings of an axis vouch for 0.693 or 0.733 um, of another one for 0.715 or 0.691.
"""
_CLOSELY = _How(4, 4, 0.001, "detail")
"""p = 16: the largest of them counts."""
_AGAIN = 3
"""So often the best plan is exchanged once more with the times of its own way, while that brings a better one."""
_MANY = 120
"""Unknowns beyond which only the plan that is the best for its model is exchanged, and a larger one once, of time."""
_FEWEST = 3
"""Two readings contradict nothing, wherever they are, and more of them are another plan."""
_NEARLY = 1.02
"""A plan that vouches for nearly what it promises needs no search, unless for a bad reading."""
_MORE, _A_FEW, _MOST = 1.5, 8, 1000
"""Times as many readings, and so many, that an accuracy may take beyond those that promise it: a limit of time."""


def guarded(task: Task, limits: Limits, times: Clock, trial: Trial) -> Trial:
    """Return a plan with as many readings of each set-up that can vouch for most; with more for an accuracy.

    An accuracy is met by what the readings can vouch for: to the plan that promises it so many are added as that
    takes, or none where `_MORE` times as many could not.
    """
    plain = _tried(task, limits, trial.scores.places)
    search, best = _Guarding(task, limits, trial, affordable(times, trial.setups, limits.slack), plain), plain
    if plain.vouched > _NEARLY * plain.promise:
        best = search.best(search.tried())
        if limits.rms is not None:
            best = _enough(search, times, best)
        if limits.accurate and not (best.met and best.checked):
            best = plain
    best = search.contradicted(best)
    return trial if best is plain else replace(trial, scores=search.scored(best.order), met=best.met)


class Enough(NamedTuple):
    """So many readings could vouch for so much.  vouched : standard uncertainty, m"""

    readings: int
    vouched: float


def enough_readings(task: Task, places: Places, times_promise: float) -> Enough | None:
    """Return how many readings could vouch for their promise, or a little more; None where not half as many again.

    places : of a plan of fewer; times_promise : what is vouched for may be so many times what is promised
    With more than `_MANY` unknowns nothing is searched, of time.
    """
    if len(places) < _FEWEST or task.root is not task.yardstick.root or task.observation.size > _MANY:
        return None
    setups = tuple(int(setup) for setup in np.unique(places.setups))
    pool = Pool(task.observation, task.lattice.within(np.isin(task.lattice.setups, setups)), task.memory)
    trial, times = Trial(Scores(pool, task.state), setups, 0.0, met=False), clock(task)
    found = _tried(task, Limits(), places)
    search = _Guarding(task, Limits(), trial, affordable(times, setups, np.inf), found)
    while not (enough := _if_enough(task, found, times_promise)) and len(found.order) < _most(len(places)):
        found = search.grown(found, max(len(places) // 8, 1), times)
    return enough


def _if_enough(task: Task, found: _Tried, times_promise: float) -> Enough | None:
    """Return the readings where what they can vouch for is little more than their promise, in their gaps too."""
    if found.vouched > times_promise * found.promise:
        return None
    whole = vouched_along(task, found.order, found.ends, gaps=True)
    return None if whole.u_def > times_promise * found.promise or whole.hides else Enough(len(found.order), whole.u_def)


def _most(readings: int) -> int:
    """Return how many readings are tried at most to vouch for what so many promise."""
    return int(_MORE * readings) + _A_FEW


class _Tried(NamedTuple):
    """Readings in their order.  ends : (m,) when each ends, s

    promise, vouched : what they promise and can vouch for, m
    met : whether the accuracy that is asked for is promised; checked : whether they can vouch for an RMS
    """

    order: Places
    ends: Array
    promise: float
    vouched: float
    met: bool
    checked: bool

    @property
    def can_hold(self) -> bool:
        """Whether what they vouch for is near enough to what they promise."""
        return self.vouched <= KAPPA * self.promise


def _tried(task: Task, limits: Limits, places: Places) -> _Tried:
    order = in_order(task, places)
    ends = np.cumsum(seconds_each(task, order))
    found = vouched_along(task, order, ends, gaps=limits.rms is not None)
    accuracy = RunningAccuracy.of(task.yardstick, task.state.after_readings(order).factor).accuracy
    least = max((each.least for each in found.departures), default=0.0)
    checked = limits.rms is None or least <= accuracy.attainable(limits.rms)
    return _Tried(order, ends, found.promise, found.u_def, limits.met(accuracy), checked)


def _enough(search: _Guarding, times: Clock, found: _Tried) -> _Tried:
    """Return the plan with the fewest readings found that can vouch for an accuracy, or the last that was tried."""
    budget, first = search.limits.budget, len(found.order)
    most = min(_most(first), search.limits.readings or _MOST)
    while not (found.met and found.checked) and len(found.order) < most:
        grown = search.grown(found, min(max(first // 8, 1), most - len(found.order)), times)
        if budget is not None and float(grown.ends[-1]) > budget:
            return found
        found = grown
    return found


class _Guarding:
    """What exchange makes of plans, of which the readings of each set-up keep their number."""

    def __init__(self, task: Task, limits: Limits, trial: Trial, allowed: Allowed, first: _Tried) -> None:
        self._task, self.limits, self._trial, self._allowed, self._first = task, limits, trial, allowed, first
        seen = task.observation, task.yardstick, task.lattice, first.order, first.ends
        self._watched = cache(lambda humps: watch(*seen, humps))

    def tried(self) -> list[_Tried]:
        """Return plans with as many readings of each set-up as the first one, that among them."""
        few, plain = self._task.observation.size <= _MANY, self.plain()
        tried = starts = [self._first, *(self._tried(places) for places in plain if few)]
        for how in (_ROUGHLY, _FINELY)[: 1 + few]:
            roughly = [self._tried(self.exchanged(each.order, self._watched(how.humps), how)) for each in starts]
            tried = [*tried, *roughly, self._closely(self.best([self._first, *roughly]))]
        if not few:
            return tried + [self._tried(places) for places in plain if self._could_be(places, self.best(tried))]
        for _ in range(_AGAIN):
            before = self.best(tried)
            in_time = [self._exchanged_in_time(before, how) for how in (_ROUGHLY, _FINELY)]
            tried = [*tried, *in_time, self._closely(self.best(in_time))]
            if self.best(tried) is before:
                break
        return tried

    def grown(self, before: _Tried, more: int, times: Clock) -> _Tried:
        """Return a plan with so many readings more, of those that lower the objective most for their time."""
        scores = self._entered(
            before.order, retimed(self._watched(_ROUGHLY.humps), before.order, before.ends), _ROUGHLY
        )
        cost = times.reading[scores.pool.lattice.setups]
        for _ in range(more):
            scores.enter(first_best(scores.gains / cost, ALIKE))
        exchange(scores, self._allowed, _ROUGHLY.sweeps, _ROUGHLY.better)
        found = self._tried(scores.places)
        many = self._task.observation.size > _MANY
        return found if many else self.best([found, self._closely(found)])

    def contradicted(self, found: _Tried) -> _Tried:
        """Return readings a bad one of which does less, where these vouch for no more than a quarter more.

        The same where it does no more than a quarter above what they vouch for, or where more than `_MANY` unknowns
        take long. One of several numbers is exchanged as if these were off alike, and judged in its worst direction.
        """
        if self._task.observation.size > _MANY or (slip := worst_slip(self._task, found.order)) <= OPEN * found.vouched:
            return found
        tried, worst = [found], [max(found.vouched, slip)]
        for how in (_ROUGHLY, _FINELY, _CLOSELY):
            watched = retimed(self._watched(how.humps), found.order, found.ends)
            places = self.exchanged(found.order, doubting(watched, len(found.order)), how)
            each = self._tried(places)
            if self._as_good(each, found):
                slip = worst_slip(self._task, each.order)
                tried.append(each)
                worst.append(max(each.vouched, slip))
                if slip <= OPEN * each.vouched <= OPEN * _NEARLY * found.vouched:
                    break
        return tried[first_best(-np.array(worst), ALIKE)]

    def _as_good(self, each: _Tried, found: _Tried) -> bool:
        """Whether readings keep what others do: the time, the accuracy that is asked for, what can hold."""
        near = each.vouched <= OPEN * found.vouched and each.can_hold >= found.can_hold
        return near and each.met >= found.met and each.checked >= found.checked and each.ends[-1] <= self._longest

    def _could_be(self, places: Places, best: _Tried) -> bool:
        """Whether readings may vouch for as much as the best: for no more than they promise."""
        promise = self._task.yardstick.rms_of(self._task.state.after_readings(places).value)
        return promise <= best.vouched * (1 + ALIKE)

    def _tried(self, places: Places) -> _Tried:
        return _tried(self._task, self.limits, places)

    def _closely(self, before: _Tried) -> _Tried:
        return self._exchanged_in_time(before, _CLOSELY)

    def _exchanged_in_time(self, before: _Tried, how: _How) -> _Tried:
        """Return what exchange makes of a plan, with the times of its own way."""
        watched = retimed(self._watched(how.humps), before.order, before.ends)
        return self._tried(self.exchanged(before.order, watched, how))

    def best(self, tried: Sequence[_Tried]) -> _Tried:
        """Return the readings that vouch for the least uncertainty within the time; where none is, the first."""
        fitting = [each for each in tried if each.ends[-1] <= self._longest] or tried[:1]
        return fitting[first_best(-np.array([each.vouched for each in fitting]), ALIKE)]

    @property
    def _longest(self) -> float:
        """How long a plan may take, s: what there is, or what the first one takes."""
        budget = self.limits.budget
        return np.inf if budget is None else max(budget, float(self._first.ends[-1]))

    def plain(self) -> list[Places]:
        """Return plans that need no thought."""
        places = self._trial.scores.places
        counts = [(s, int(np.sum(places.setups == s))) for s in self._trial.setups]
        return plain_designs(self._task, counts)

    def exchanged(self, places: Places, watched: Watch, how: _How) -> Places:
        """Return what exchange makes of readings."""
        scores = self._entered(places, watched, how)
        exchange(scores, self._allowed, how.sweeps, how.better)
        return scores.places

    def _entered(self, places: Places, watched: Watch, how: _How) -> DefendedScores:
        pool, yardstick = self._trial.scores.pool, self._task.yardstick
        scores = DefendedScores(pool, self._task.state, watched, yardstick, how.squarings)
        scores.enter_all(places)
        return scores

    def scored(self, places: Places) -> Scores:
        """Return plain scores of readings, which count the promise alone."""
        scores = Scores(self._trial.scores.pool, self._task.state)
        scores.enter_all(places)
        return scores


def vouched_for(task: Task, places: Places, gaps: bool = False) -> Defence:
    """Return what readings can vouch for, each taken when the way through all of them takes it.  gaps : as below"""
    order = in_order(task, places)
    return vouched_along(task, order, np.cumsum(seconds_each(task, order)), gaps)


def vouched_along(task: Task, order: Places, ends: Array, gaps: bool = False) -> Defence:
    """Return what readings in this order can vouch for.

    ends : (m,) when each ends, s; gaps : whether with what may stay hidden between them, which takes longer
    """
    effects, owner = _effects(task, order)
    others = np.bincount(owner) - 1
    setups, columns = task.observation.setups, (order.setups, order.poses, order.approaches, ends, others)
    readings = [
        Reading(setups[setup].name, tuple(pose), tuple(int(s) for s in sides), 0.0, others=(0.0,) * more, time=end)
        for setup, pose, sides, end, more in zip(*(column.tolist() for column in columns), strict=True)
    ]
    promise = task.yardstick.rms_of(task.state.after_readings(order).value)
    found = vouched(task.observation, readings, effects, promise)
    return with_gaps(found, task.observation, readings, effects, task.observation.errors.machine) if gaps else found


def worst_slip(task: Task, places: Places) -> float:
    """Return the most that one bad reading of these does when the others just show it, m."""
    effects, owner = _effects(task, places)
    return max((each.damage for each in effects.alone(owner)), default=0.0)


def _effects(task: Task, places: Places) -> tuple[EffectMap, NDArray[np.intp]]:
    """Return the effects of readings, and the reading of each of their numbers, (m,)."""
    state = task.state.opened(places)
    rows, variances, owner = state.rows(places)
    return EffectMap(task.yardstick, rows @ state.factor, np.sqrt(variances), state.weighted), owner
