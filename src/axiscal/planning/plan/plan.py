"""A plan: which set-ups, which readings in each, in which order, how long, how good, and how good any plan could be.

    plan = make_plan(task, Limits(readings=40))
    plan.places.poses[0], plan.accuracy.rms, plan.seconds, plan.ratio

Exchange chooses the readings together. It improves a greedy, a space-filling, an evenly spaced and the best random
design; the best result is the plan. So no plan is worse than one of these.

While measuring, `renewed` plans the rest: from the readings that are still open, by what exchanges still help. Readings
of linear instruments sharpen a belief by their places, not by their values. So the rest of a plan is still the plan, as
long as each reading is accepted at its planned place. Otherwise the search here begins with it, so that the renewed
plan is no worse than the old one, and little has to be looked at.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.accuracy.yardstick import Accuracy
from axiscal.exceptions import PlanError
from axiscal.language.stages import stage
from axiscal.measurement.reading import Places
from axiscal.measurement.travel import reading_seconds
from axiscal.numerics.threads import one_thread
from axiscal.numerics.ties import ALIKE, ranked
from axiscal.planning.bound.lower_bound import Bound, lower_bound
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.covariance import RunningAccuracy, after_each
from axiscal.planning.gains.running_gains import Scores
from axiscal.planning.plan.beginnings import best_of_random, plain_designs
from axiscal.planning.plan.exchange import SWEEPS, drop, exchange, polish, shrunk
from axiscal.planning.plan.greedy import (
    Setups,
    Trial,
    affordable,
    chosen_setups,
    filled,
    scores_among,
    sets_within,
    within_reach,
)
from axiscal.planning.plan.irregular import shaken, spread_if_as_good
from axiscal.planning.plan.order import arriving, in_order, interleaved, seconds_along, seconds_each
from axiscal.planning.plan.run import first_seconds
from axiscal.planning.plan.task import PATIENCE, Clock, Limits, Patience, Task, clock
from axiscal.planning.plan.tour import retoured, toured

_SWEEPS = 3
_WORTH = 0.01
"""An exchange must bring a hundredth more than the reading it replaces: less is not worth another way."""
_ROUNDS_OF_RENEWAL = 2
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
    left = _mountable(task, limits, left)
    mounted = [] if task.here is None else task.here.setups.tolist()
    setups, order = tuple(sorted({*mounted, *left.setups.tolist()})), left
    within = tuple(setup for setup in setups if setup in task.lattice.setups)
    hurried = _hurried(task, limits)
    if within and not hurried:
        places = _renewed(task, replace(limits, budget=None), setups, left, patience, unsure)
        if places is None:
            return Places.none(left.poses.shape[1])
        order = _ordered(task, limits, in_order(task, places), left, usual)
    if within and (hurried or _too_long(task, limits, order)):
        order = _ordered(task, limits, retoured(task, limits, within, left, patience, _WORTH), left, usual)
    return replace(order, approaches=arriving(task, order))


def _renewed(task: Task, limits: Limits, setups: Setups, left: Places, patience: float, unsure: float) -> Places | None:
    """Return readings to come of these set-ups in any order; None where they fall short and others do not."""
    base, times = scores_among(task, setups), clock(task)
    others = np.setdiff1d(task.lattice.setups, setups) if limits.accurate else np.zeros(0, dtype=np.intp)
    trial = _filled(task, limits, times, _begun(base.fork(), limits, times, setups, left), others)
    if len(others) and not trial.met and within_reach(task, limits):
        return None
    exchange(trial.scores, affordable(times, setups, limits.slack), _SWEEPS, _WORTH)
    polish(trial.scores, affordable(times, setups, 0.0), _ROUNDS_OF_RENEWAL, Patience(patience))
    trial = shrunk(task, limits.times(1 / unsure), times, trial)
    return _needed(task, limits, times, base, trial.scores.places)


def _hurried(task: Task, limits: Limits) -> bool:
    """Return whether minutes decide: there is no other limit, or no time for as many readings as there may be."""
    if limits.budget is None or limits.accurate:
        return False
    quickest = min(reading_seconds(setup) for setup in task.observation.setups)
    return limits.readings is None or limits.readings * quickest > limits.budget


def _too_long(task: Task, limits: Limits, order: Places) -> bool:
    return limits.budget is not None and seconds_along(task, order) > limits.budget


def _ordered(task: Task, limits: Limits, order: Places, left: Places, usual: bool) -> Places:
    """Return readings in their order: as it was where it holds the same ones, and a way out and back takes no less."""
    same = order.same_as(left)
    if same and (usual or seconds_along(task, left) <= seconds_along(task, order)):
        return left
    return interleaved(task, limits, order) if usual else order


def _needed(task: Task, limits: Limits, times: Clock, base: Scores, places: Places) -> Places:
    """Return a plan, or readings of the set-up that is mounted where these reach the accuracy in less time.

    base : the gains of the candidates before the first reading
    """
    here: Setups = () if task.here is None else (int(task.here.setups[0]),)
    mine = np.isin(places.setups, here)
    if not limits.accurate or not np.isin(task.lattice.setups, here).any() or mine.all():
        return places
    scores = _begun(base.among(here), limits, times, here, places.within(mine)).scores
    meter = RunningAccuracy.from_factor(task.yardstick, scores.state.factor)
    spent, longest = (seconds_along(task, in_order(task, each)) for each in (places.within(mine), places))
    alone = filled(scores, meter, limits, times, here, _MOST, longest, begun=spent)
    return scores.places if alone.met else places


def _mountable(task: Task, limits: Limits, left: Places) -> Places:
    """Return the readings of the set-ups that there is time to mount, one after another."""
    first, spent, kept = first_seconds(task), 0.0, set[int]()
    for setup in dict.fromkeys(left.setups.tolist()):
        if limits.budget is None or spent + first.get(setup, 0.0) <= limits.budget:
            spent += first.get(setup, 0.0)
            kept.add(setup)
    return left.within(np.isin(left.setups, list(kept)))


def _begun(scores: Scores, limits: Limits, times: Clock, setups: Setups, left: Places) -> Trial:
    """Return the plan that is left, of no more readings than there may be.  scores : before the first, taken over"""
    scores.enter_all(left)
    while limits.readings is not None and len(scores.places) > limits.readings:
        drop(scores, times)
    return Trial(scores, setups, 0.0, met=False)


def _filled(task: Task, limits: Limits, times: Clock, trial: Trial, others: NDArray[np.intp]) -> Trial:
    """Return the plan with more readings where it misses the accuracy.

    others : set-ups that could be mounted instead of reading on for longer than that takes
    """
    most, longest = _MORE, np.inf
    if len(others):
        mounted = float((times.mounting + times.reading)[others].max())
        most, longest = _MOST, max(mounted, _FAR * float(times.reading[list(trial.setups)].min()))
    meter = RunningAccuracy.from_factor(task.yardstick, trial.scores.state.factor)
    return filled(trial.scores, meter, limits, times, trial.setups, most, longest, begun=0.0)


_RANDOM = 0.2
"""Share of the patience that random starts may take besides."""
_MUCH = 1e9
"""Operations of exchange from which on only the best beginning is swept, or goes on after its first sweep."""
_ROUNDS = 6
"""Rounds end where no reading moves; this only ends what would go round."""


@dataclass(frozen=True, eq=False, slots=True)
class PlannedReading:
    """Accuracy and elapsed seconds after a reading of a plan.  value : J"""

    value: float
    accuracy: Accuracy
    seconds: float


@dataclass(frozen=True, eq=False, slots=True)
class Plan:
    """Readings in the order of a short way, set-up by set-up.

    places : from the sides from which the machine comes to them; readings : what each of them leaves
    value : J after the last; before : the accuracy now; met : whether the accuracy asked for is reached
    bound : what no plan can beat, None if it was not asked for; candidates : size of the lattice it holds for
    among : the set-ups that were worth their mounting, of which it was chosen
    checks : indices of readings that were drawn at random
    """

    places: Places
    readings: tuple[PlannedReading, ...]
    value: float
    before: Accuracy
    met: bool
    bound: Bound | None
    candidates: int
    among: Setups
    checks: frozenset[int] = frozenset()

    @property
    def accuracy(self) -> Accuracy:
        """The figures after the last reading."""
        return self.readings[-1].accuracy if self.readings else self.before

    @property
    def seconds(self) -> float:
        """The time of the whole plan."""
        return self.readings[-1].seconds if self.readings else 0.0

    @property
    def ratio(self) -> float:
        """J over its lower bound; infinite without one."""
        return self.value / self.bound.value if self.bound and self.bound.value > 0 else np.inf


@one_thread()
def make_plan(
    task: Task,
    limits: Limits,
    *,
    patience: float = PATIENCE,
    bounded: bool = True,
    usual: bool = False,
) -> Plan:
    """Return a plan that ends at the first limit it reaches. Raises PlanError.

    patience : operations that climbing off the lattice may take; the same plan on any machine, and under any load
    bounded : whether the lower bound is wanted
    usual : with what usually goes wrong: places keep no regular distances, and their order is interleaved
    """
    _refuse(task, limits)
    order = None if _hurried(task, limits) else _any_time(task, limits, patience, usual)
    if order is None or _too_long(task, limits, order):
        order = _in_minutes(task, limits, patience, usual)
    return judged(task, limits, replace(order, approaches=arriving(task, order)), bounded)


def _any_time(task: Task, within: Limits, patience: float, usual: bool) -> Places:
    """Return readings in their order, however long they take; they are interleaved within a budget."""
    limits, times = replace(within, budget=None), clock(task)
    with stage("which set-ups"):
        setups = chosen_setups(task, limits)
    with stage("readings chosen together"):
        trial = _together(task, limits, times, setups, _RANDOM * patience)
    with stage("off the lattice"):
        polish(trial.scores, affordable(times, setups, 0.0), _ROUNDS, Patience(patience))
    places = shrunk(task, limits, times, trial).scores.places
    if usual and len(places):
        places = spread_if_as_good(task, limits, shaken(task, places))
    order = in_order(task, places)
    return interleaved(task, within, order) if usual else order


def _in_minutes(task: Task, limits: Limits, patience: float, usual: bool) -> Places:
    """Return readings in their order that a budget has time for."""
    with stage("which set-ups"):
        sets = sets_within(task, limits)
    with stage("readings chosen together"):
        order = toured(task, limits, sets, patience)
        if not usual or not len(order):
            return order
        places, setups = spread_if_as_good(task, limits, shaken(task, order)), tuple(np.unique(order.setups).tolist())
        return interleaved(task, limits, retoured(task, limits, setups, places, 0.0, np.inf))


def _refuse(task: Task, limits: Limits) -> None:
    if limits == Limits():
        raise PlanError("nothing would ever end this plan", "Say how many readings, which accuracy or how much time")
    if not len(task.lattice):
        raise PlanError("there is no place where a reading may be taken", "Allow an axis to move, or add a set-up")
    first = first_seconds(task)
    quickest = min(first, key=lambda setup: first[setup])
    if limits.budget is not None and limits.budget < first[quickest]:
        what = '{given:.3g} min is less than the {needed:.3g} min that the first reading takes with "{setup}"'
        remedy = "Allow more time, or give a set-up that is mounted faster"
        setup = task.observation.setups[quickest].name
        raise PlanError(what, remedy, given=limits.budget / 60, needed=first[quickest] / 60, setup=setup)


def _together(task: Task, limits: Limits, times: Clock, setups: Setups, work: float) -> Trial:
    """Return the best of what exchange makes of several beginnings with the same number of readings per set-up.

    work : operations that random starts may take
    """
    base, meter = scores_among(task, setups), RunningAccuracy.from_factor(task.yardstick, task.state.factor)
    greedy = filled(base.fork(), meter, limits, times, setups)
    counts = [(s, int(np.sum(greedy.scores.places.setups == s))) for s in setups]
    trials = [greedy]
    random = best_of_random(task, counts, work)
    for begun in [*plain_designs(task, counts), *([] if random is None else [random])]:
        scores = base.fork()
        scores.enter_all(begun)
        trials.append(replace(greedy, scores=scores))
    allowed, done = affordable(times, setups, limits.slack), 0.0
    for sweeps in (1, SWEEPS):
        for place, trial in enumerate(_best_first(trials)):
            if place == 0 or done < _MUCH:
                done += exchange(trial.scores, allowed, sweeps)
    return _best_first(trials)[0]


def _best_first(trials: Sequence[Trial]) -> list[Trial]:
    return [trials[k] for k in ranked(-np.array([trial.scores.state.value for trial in trials]), ALIKE)]


def judged(task: Task, limits: Limits, places: Places, bounded: bool = True) -> Plan:
    """Return the plan of readings in their order: what each leaves, and what no plan could beat.

    bounded : whether the lower bound is wanted
    """
    state = task.state
    among = chosen_setups(task, limits) if limits.budget is None else tuple(np.unique(places.setups).tolist())
    lattice = task.lattice.within(np.isin(task.lattice.setups, among))
    before = RunningAccuracy.from_factor(task.yardstick, state.factor).accuracy
    ends = np.cumsum(seconds_each(task, places)).tolist()
    known = zip(after_each(state, task.yardstick, places), ends, strict=True)
    readings = tuple(PlannedReading(value, accuracy, seconds) for (value, accuracy), seconds in known)
    value, accuracy = (readings[-1].value, readings[-1].accuracy) if readings else (state.value, before)
    bound = None
    if bounded:
        with stage("the bound"):
            bound = _bound(task, limits, Pool(task.observation, lattice), places)
    return Plan(places, readings, value, before, limits.met(accuracy), bound, len(lattice), among)


def _bound(task: Task, limits: Limits, pool: Pool, places: Places) -> Bound:
    """Return the bound for as many readings as the plan has, or for its seconds of settling and reading."""
    of = np.concatenate([pool.lattice.setups, places.setups])
    costs = np.ones(len(of))
    if limits.timed:
        seconds = np.array([s.settle + s.reading_time for s in task.observation.setups])[of]
        costs = seconds if seconds.min(initial=np.inf) > 0 else costs
    return lower_bound(pool, task.state, places, costs, float(costs[len(pool) :].sum()))
