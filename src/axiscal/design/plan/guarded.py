"""A plan made such that its readings can vouch for it: what they would not show is made small along with the promise.

From the plan that is the best for its model, from that with as many readings evenly spaced, and from that exchanged:
of all of them, and of the two plain ones, the one whose readings, taken when their way takes them, vouch for least.

What comes and goes on a way out and back no reading on it shows. So plans are compared by the rest, and in the best of
them two readings are given up for the place of the turn once more at the end and for one half way, where the readings
vouch for more so.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from axiscal.design.gains.candidate_rows import Pool
from axiscal.design.gains.running_accuracy import RunningAccuracy
from axiscal.design.gains.running_gains import Allowed, Scores
from axiscal.design.plan.defended import DefendedScores
from axiscal.design.plan.exchange import exchange
from axiscal.design.plan.greedy import Trial, affordable
from axiscal.design.plan.order import in_order, seconds_along, seconds_each
from axiscal.design.plan.out_and_back import repeats, returns
from axiscal.design.plan.plain_designs import plain_designs
from axiscal.design.plan.task import Clock, Limits, Task, clock
from axiscal.design.plan.watch import Humps, Watch, at_share, retimed, watch
from axiscal.estimation.defence import COUNTED, Defence, EffectMap, vouched, with_gaps
from axiscal.measurement.departures import COME_AND_GO
from axiscal.measurement.place import Places
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.ties import ALIKE, first_best

By = Literal["along", "vouched"]
"""By which of what readings can vouch for plans are compared."""


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
_MANY = 120
"""Unknowns beyond which only the plan that is the best for its model is exchanged, and a larger one once, of time."""
_FEWEST = 3
"""Two readings contradict nothing, wherever they are, and more of them are another plan."""
_FEW = 5
"""Of fewer readings none is given up to watch a drift."""
_CLOSING = 2
"""So many readings of a set-up are given up for places once more: at the turn, and half way there."""
_NEARLY = 1.02
"""A plan that vouches for nearly what it promises needs no search."""
_MORE, _A_FEW, _MOST = 1.5, 8, 1000
"""Times as many readings, and so many, that an accuracy may take beyond those that promise it: a limit of time."""


def guarded(task: Task, limits: Limits, times: Clock, trial: Trial) -> Trial:
    """Return a plan with as many readings of each set-up that can vouch for most; with more for an accuracy.

    An accuracy is met by what the readings can vouch for: to the plan that promises it so many are added as that
    takes, or none where `_MORE` times as many could not.
    """
    plain = _tried(task, limits, trial.scores.places)
    if plain.vouched <= _NEARLY * plain.promise:
        return trial
    search = _Guarding(task, limits, trial, affordable(times, trial.setups, limits.slack), plain)
    tried = search.tried()
    open_way = search.best(tried, "along")
    if limits.rms is None:
        best = search.best([*tried, search.closed(open_way)], "vouched")
    else:
        best = _enough(search, times, open_way)
    if limits.accurate and not (best.met and best.checked):
        best = plain
    return replace(trial, scores=search.scored(best.order), met=best.met)


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
    found = closed = _tried(task, Limits(), places)
    search = _Guarding(task, Limits(), trial, affordable(times, setups, np.inf), found)
    while not (enough := _if_enough(task, closed, times_promise)) and len(found.order) < _most(len(places)):
        found = search.grown(found, max(len(places) // 8, 1), times)
        closed = search.closed(found)
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

    promise, vouched : what they promise and can vouch for, m; along : the same but for what comes and goes
    met : whether the accuracy that is asked for is promised; checked : whether they can vouch for an RMS
    """

    order: Places
    ends: Array
    promise: float
    vouched: float
    along: float
    met: bool
    checked: bool

    def share(self, index: int) -> float:
        """Return at what share of the time of its set-up a reading is taken."""
        ends = self.ends[self.order.setups == self.order.setups[index]]
        return float((self.ends[index] - ends[0]) / (ends[-1] - ends[0]))


def _tried(task: Task, limits: Limits, places: Places) -> _Tried:
    order = in_order(task, places)
    ends = np.cumsum(seconds_each(task, order))
    found = vouched_along(task, order, ends, gaps=limits.rms is not None)
    accuracy = RunningAccuracy.of(task.yardstick, task.state.after_readings(order).factor).accuracy
    least = max((each.least for each in found.departures), default=0.0)
    checked = limits.rms is None or least <= accuracy.attainable(limits.rms)
    on_the_way = (each.least for each in found.departures if each.family not in COME_AND_GO)
    along = max([found.promise, *on_the_way])
    return _Tried(order, ends, found.promise, found.u_def, along, limits.met(accuracy), checked)


def _enough(search: _Guarding, times: Clock, found: _Tried) -> _Tried:
    """Return the plan with the fewest readings found that can vouch for an accuracy, or the last that was tried."""
    budget, first = search.limits.budget, len(found.order)
    most = min(_most(first), search.limits.readings or _MOST)
    closed = search.closed(found)
    while not (closed.met and closed.checked) and len(found.order) < most:
        found = search.grown(found, min(max(first // 8, 1), most - len(found.order)), times)
        grown = search.closed(found)
        if budget is not None and float(grown.ends[-1]) > budget:
            return closed
        closed = grown
    return closed


class _Guarding:
    """What exchange makes of plans, of which the readings of each set-up keep their number."""

    def __init__(self, task: Task, limits: Limits, trial: Trial, allowed: Allowed, first: _Tried) -> None:
        self._task, self.limits, self._trial, self._allowed, self._first = task, limits, trial, allowed, first
        self._seen = task.observation, task.yardstick, task.lattice, first.order, first.ends
        self._watched = {each: watch(*self._seen, each) for each in get_args(Humps)}

    def tried(self) -> list[_Tried]:
        """Return plans with as many readings of each set-up as the first one, that among them."""
        few, plain = self._task.observation.size <= _MANY, self.plain()
        tried = starts = [self._first, *(self._tried(places) for places in plain if few)]
        for how in (_ROUGHLY, _FINELY)[: 1 + few]:
            roughly = [self._tried(self.exchanged(each.order, self._watched[how.humps], how)) for each in starts]
            tried = [*tried, *roughly, self._closely(self.best([self._first, *roughly], "along"))]
        if not few:
            tried += [self._tried(places) for places in plain if self._could_be(places, self.best(tried, "along"))]
        return tried

    def grown(self, before: _Tried, more: int, times: Clock) -> _Tried:
        """Return a plan with so many readings more, of those that lower the objective most for their time."""
        scores = self._entered(
            before.order, retimed(self._watched[_ROUGHLY.humps], before.order, before.ends), _ROUGHLY
        )
        cost = times.reading[scores.pool.lattice.setups]
        for _ in range(more):
            scores.enter(first_best(scores.gains / cost, ALIKE))
        exchange(scores, self._allowed, _ROUGHLY.sweeps, _ROUGHLY.better)
        found = self._tried(scores.places)
        many = self._task.observation.size > _MANY
        return found if many else self.best([found, self._closely(found)], "along")

    def _could_be(self, places: Places, best: _Tried) -> bool:
        """Whether readings may vouch for as much as the best: for no more than they promise."""
        promise = self._task.yardstick.rms_of(self._task.state.after_readings(places).value)
        return promise <= best.along * (1 + ALIKE)

    def _tried(self, places: Places) -> _Tried:
        return _tried(self._task, self.limits, places)

    def _closely(self, before: _Tried) -> _Tried:
        """Return what a closer exchange makes of a plan, with the times of its own way."""
        watched = retimed(self._watched[_CLOSELY.humps], before.order, before.ends)
        return self._tried(self.exchanged(before.order, watched, _CLOSELY))

    def best(self, tried: Sequence[_Tried], by: By) -> _Tried:
        """Return the readings that vouch for most of those within the time; where none is, the first."""
        fitting = [each for each in tried if each.ends[-1] <= self._longest] or tried[:1]
        return fitting[first_best(-np.array([getattr(each, by) for each in fitting]), ALIKE)]

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
        scores = self._empty(watched, how)
        scores.enter_all(places)
        return scores

    def _empty(self, watched: Watch, how: _How) -> DefendedScores:
        return DefendedScores(self._trial.scores.pool, self._task.state, watched, self._task.yardstick, how.squarings)

    def closed(self, found: _Tried) -> _Tried:
        """Return a plan with readings given up for places once more at the end, where it vouches for more so.

        For that of each set-up first, then with others exchanged beside them, and these once more with their own times.
        """
        tried, ends = [found], list[_Tried]()
        for which in range(_CLOSING):
            for setup in [int(each) for each, mine in found.order.by_setup() if len(mine) > _FEW]:
                places = self._with_closing(tried[-1], setup, which)
                tried += [] if places is None else [self._tried(places)]
            ends += [] if any(tried[-1] is each for each in (found, *ends)) else [tried[-1]]
        if not ends:
            return found
        if self._task.observation.size > _MANY:
            return self.best([*tried, self._beside_closings(ends[-1], _ROUGHLY)], "vouched")
        beside = [self._beside_closings(each, how) for each in ends for how in (_ROUGHLY, _FINELY)]
        closest = sorted(beside, key=lambda each: each.vouched)[:2]
        once_more = [self._beside_closings(each, how) for each in closest for how in (_ROUGHLY, _FINELY)]
        return self.best([*tried, *beside, *once_more], "vouched")

    def _with_closing(self, found: _Tried, setup: int, which: int) -> Places | None:
        """Return the readings with some of a set-up given up for one of its places once more; None where none is left.

        The place of the turn of a way out and back, then the one half way there; the first one where several axes move.
        """
        losses, order = self.scored(found.order).losses(), found.order
        (mine,) = np.nonzero(order.setups == setup)
        once, _ = repeats(np.column_stack([order.poses[mine], order.approaches[mine]]))
        way = mine[once]
        shown = self._shown_again(order, way, setup)
        if which >= len(shown):
            return None
        others = np.setdiff1d(way, shown)
        given_up = others[np.argsort(losses[others], kind="stable")]
        for count in range(1, len(given_up) - _FEW):
            kept = np.setdiff1d(np.arange(len(order)), given_up[:count])
            closed = Places.joined([order.within(kept), order.at(shown[which])])
            if seconds_along(self._task, in_order(self._task, closed)) <= self._longest:
                return closed
        return None

    def _beside_closings(self, found: _Tried, how: _How) -> _Tried:
        """Return what an exchange makes of the readings that stand beside those of places once more."""
        order = found.order
        rows = np.column_stack([order.setups, order.poses, order.approaches])
        once, again = repeats(rows)
        if not len(again):
            return found
        shown = (rows[once][:, None] == rows[again]).all(axis=2).any(axis=1)
        watched = retimed(watch(*self._seen, how.humps, COUNTED), order, found.ends)
        scores = self._empty(watched, how)
        scores.enter_all(order.within(once))
        for index in again.tolist():
            scores.watched = at_share(watched, found.share(index))
            scores.enter(order.at(index))
        scores.watched = watched

        def allowed(scores: Scores, slot: int) -> NDArray[np.bool_]:
            fixed = slot >= len(once) or shown[slot]
            return np.zeros(len(scores.pool), dtype=bool) if fixed else self._allowed(scores, slot)

        exchange(scores, allowed, how.sweeps, how.better)
        return self._tried(scores.places)

    def _shown_again(self, order: Places, way: NDArray[np.intp], setup: int) -> list[int]:
        """Return which readings of a way would show what comes and goes, were they taken once more."""
        setups = self._task.observation.setups
        if not returns(setups[setup]):
            return [int(way[0])]
        at = order.poses[way, setups[setup].moves[0]]
        away = np.abs(at - at[0])
        return [int(way[np.argmax(away)]), int(way[np.argmin(np.abs(away - away.max() / 2))])]

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
    found = vouched(task.observation, readings, effects, promise)
    return with_gaps(found, task.observation, readings, effects, task.observation.errors.machine) if gaps else found
