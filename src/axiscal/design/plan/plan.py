"""A plan: which set-ups, which readings in each, in which order, how long, how good, and how good any plan could be.

    plan = make_plan(task, Limits(readings=40))
    plan.places.poses[0], plan.accuracy.rms, plan.seconds, plan.ratio

The readings are chosen together: the best of what exchange makes of a greedy, a space-filling, an evenly spaced and the
best random design, so that no plan is worse than one of these. While measuring, `renewal.renewed` plans the rest.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from axiscal.accuracy.yardstick import Accuracy
from axiscal.design.bound.lower_bound import Bound, lower_bound
from axiscal.design.gains.candidate_rows import Pool
from axiscal.design.gains.running_accuracy import RunningAccuracy, along
from axiscal.design.gains.running_gains import Scores
from axiscal.design.plan.exchange import exchange, polish
from axiscal.design.plan.greedy import Setups, Trial, affordable, chosen_setups, filled
from axiscal.design.plan.order import arriving, in_order, seconds_each
from axiscal.design.plan.patience import PATIENCE, Patience
from axiscal.design.plan.plain_designs import plain_designs
from axiscal.design.plan.random_starts import best_of_random
from axiscal.design.plan.shaken import shaken
from axiscal.design.plan.task import Clock, Limits, Task, clock
from axiscal.design.plan.within_limits import fitted
from axiscal.exceptions import PlanError
from axiscal.measurement.place import Places
from axiscal.numerics.threads import one_thread
from axiscal.numerics.ties import ALIKE, first_best

Progress = Callable[[str], None]

_RANDOM = 0.05
"""Share of the patience that random starts may take besides."""
_ROUNDS = 6
"""Rounds end where no reading moves; this only ends what would go round."""


@dataclass(frozen=True, eq=False, slots=True)
class PlannedReading:
    """What is known, and how many seconds have gone, after a reading of a plan.  value : J"""

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
    """

    places: Places
    readings: tuple[PlannedReading, ...]
    value: float
    before: Accuracy
    met: bool
    bound: Bound | None
    candidates: int
    among: Setups

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
    shake: bool = False,
    progress: Progress = lambda _: None,
) -> Plan:
    """Return a plan that ends at the first limit it reaches. Raises PlanError.

    patience : operations that climbing off the lattice may take; the same plan on any machine, and under any load
    bounded : whether the lower bound is wanted; shake : whether places are shaken off their regular distances
    progress : is given what is being done, in words
    """
    _refuse(task, limits)
    times = clock(task)
    progress("which set-ups")
    setups = chosen_setups(task, limits, times)
    pool = Pool(task.observation, task.lattice.within(np.isin(task.lattice.setups, setups)), task.memory)
    progress("readings chosen together")
    trial = _together(task, limits, times, pool, setups, _RANDOM * patience)
    progress("off the lattice")
    polish(trial.scores, affordable(times, setups, 0.0), _ROUNDS, Patience(patience))
    trial = fitted(task, limits, times, trial)
    if shake and (moved := shaken(task, pool, trial.scores.places)) is not None:
        trial = replace(trial, scores=moved)
    progress("the bound")
    bound = _bound(task, limits, times, pool, trial) if bounded else None
    return _plan(task, limits, trial, bound, len(pool))


def _refuse(task: Task, limits: Limits) -> None:
    if limits == Limits():
        remedy = "Say how many readings, which accuracy or how much time"
        raise PlanError("nothing would ever end this plan", remedy)
    if not len(task.lattice):
        raise PlanError("there is no place where a reading may be taken", "Allow an axis to move, or add a set-up")
    times = clock(task)
    first = float((times.mounting + times.reading)[np.unique(task.lattice.setups)].min())
    if limits.budget is not None and limits.budget < first:
        what = f"{limits.budget / 60:.3g} min is less than the {first / 60:.3g} min that the first reading takes"
        raise PlanError(what, "Allow more time, or give a set-up that is mounted faster")


def _together(task: Task, limits: Limits, times: Clock, pool: Pool, setups: Setups, work: float) -> Trial:
    """Return the best of what exchange makes of several beginnings with the same number of readings per set-up.

    work : operations that random starts may take
    """
    base, meter = Scores(pool, task.state), RunningAccuracy.of(task.yardstick, task.state.factor)
    greedy = filled(base.fork(), meter, limits, times, setups)
    counts = [(s, int(np.sum(greedy.scores.places.setups == s))) for s in setups]
    trials = [greedy]
    random = best_of_random(task, counts, work)
    for begun in [*plain_designs(task, counts), *([] if random is None else [random])]:
        scores = base.fork()
        scores.enter_all(begun)
        trials.append(replace(greedy, scores=scores))
    for trial in trials:
        exchange(trial.scores, affordable(times, setups, limits.slack))
    return trials[first_best(-np.array([trial.scores.state.value for trial in trials]), ALIKE)]


def _bound(task: Task, limits: Limits, times: Clock, pool: Pool, trial: Trial) -> Bound:
    """Return the bound for as many readings as the plan has, or for its seconds of settling and reading."""
    places, setups = trial.scores.places, task.observation.setups
    of = np.concatenate([pool.lattice.setups, places.setups])
    counted = np.ones(len(of))
    if not limits.timed:
        return lower_bound(pool, task.state, places, counted, float(len(places)))
    costs = np.array([s.settle + s.reading_time for s in setups])[of]
    if not costs.min() > 0:
        return lower_bound(pool, task.state, places, counted, float(len(places)))
    return lower_bound(pool, task.state, places, costs, float(costs[len(pool) :].sum()))


def _plan(task: Task, limits: Limits, trial: Trial, bound: Bound | None, candidates: int) -> Plan:
    state, order = task.state, in_order(task, trial.scores.places)
    before = RunningAccuracy.of(task.yardstick, state.factor).accuracy
    ends = np.cumsum(seconds_each(task, order)).tolist()
    known = zip(along(state, task.yardstick, order), ends, strict=True)
    readings = tuple(PlannedReading(value, accuracy, seconds) for (value, accuracy), seconds in known)
    places = replace(order, approaches=arriving(task, order))
    value, accuracy = (readings[-1].value, readings[-1].accuracy) if readings else (state.value, before)
    return Plan(places, readings, value, before, limits.met(accuracy), bound, candidates, trial.setups)
