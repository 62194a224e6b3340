"""A plan: which set-ups, which readings in each, in which order, how long, how good, and how good any plan could be.

    plan = make_plan(problem, Limits(readings=40))
    plan.readings[0].pose, plan.accuracy.rms, plan.seconds, plan.ratio

The readings are chosen together: the best of what exchange makes of a greedy, a space-filling and an evenly spaced
design, so that no plan is worse than one of these. While measuring, the same call with the belief so far and what is
left of the limits plans the rest; `begin` with the readings that are still open and a little patience for that.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from axiscal.design.accuracy import Accuracy
from axiscal.design.allocation import Setups, Trial, affordable, chosen_setups, filled
from axiscal.design.bound import Bound, lower_bound
from axiscal.design.exchange import exchange, polish
from axiscal.design.meter import Meter
from axiscal.design.pool import Pool
from axiscal.design.problem import Clock, Limits, Problem, clock, counting, ordered, way_seconds
from axiscal.design.regular import evenly_spaced, space_filling
from axiscal.design.scoring import Scores
from axiscal.design.state import Point, State
from axiscal.exceptions import PlanError
from axiscal.numerics import Array

Progress = Callable[[str], None]

PATIENCE = 20.0
"""Seconds that climbing off the lattice may take unless said otherwise."""
_ROUNDS = 6
_SHRINKS = 60


@dataclass(frozen=True, eq=False, slots=True)
class PlannedReading:
    """A reading of a plan, and what is known and how much time has gone after it.

    setup : index; pose, approach : (q,); value : J
    """

    setup: int
    pose: Array
    approach: Array
    value: float
    accuracy: Accuracy
    seconds: float


@dataclass(frozen=True, eq=False, slots=True)
class Plan:
    """Readings in the order of a short way, set-up by set-up.

    value : J after the last; before : the accuracy now; met : whether the accuracy asked for is reached
    bound : what no plan can beat, None if it was not asked for; candidates : size of the lattice it holds for
    """

    readings: tuple[PlannedReading, ...]
    value: float
    before: Accuracy
    met: bool
    bound: Bound | None
    candidates: int

    @property
    def accuracy(self) -> Accuracy:
        """The figures after the last reading."""
        return self.readings[-1].accuracy if self.readings else self.before

    @property
    def seconds(self) -> float:
        """The time of the whole plan."""
        return self.readings[-1].seconds if self.readings else 0.0

    @property
    def points(self) -> list[Point]:
        """The readings to take."""
        return [Point(r.setup, r.pose, r.approach) for r in self.readings]

    @property
    def ratio(self) -> float:
        """J over its lower bound; infinite without one."""
        return self.value / self.bound.value if self.bound and self.bound.value > 0 else np.inf


def make_plan(
    problem: Problem,
    limits: Limits,
    *,
    patience: float = PATIENCE,
    begin: list[Point] | None = None,
    bounded: bool = True,
    progress: Progress = lambda _: None,
) -> Plan:
    """Return a plan that ends at the first limit it reaches. Raises PlanError.

    patience : seconds for climbing off the lattice
    begin : the readings left of an earlier plan, whose set-ups are kept and from which exchange starts as well
    bounded : whether the lower bound is wanted; progress : told what is being done
    """
    _refuse(problem, limits)
    spent = _Patience(patience)
    times = clock(problem)
    progress("which set-ups")
    setups = tuple(sorted({p.setup for p in begin})) if begin else chosen_setups(problem, limits, times)
    pool = Pool(problem.observation, problem.lattice.within(np.isin(problem.lattice.setups, setups)), problem.memory)
    progress("readings chosen together")
    trial = _together(problem, limits, times, pool, setups, begin)
    progress("off the lattice")
    polish(trial.scores, affordable(times, setups, 0.0), _ROUNDS, spent)
    trial = _fitted(problem, limits, times, trial)
    progress("the bound")
    bound = _bound(problem, limits, times, pool, trial) if bounded else None
    return _plan(problem, limits, trial, bound, len(pool))


class _Patience:
    """Says when time is up."""

    def __init__(self, seconds: float) -> None:
        self._until = time.monotonic() + seconds

    def __call__(self) -> bool:
        return time.monotonic() > self._until


def _refuse(problem: Problem, limits: Limits) -> None:
    if limits == Limits():
        remedy = "Say how many readings, which accuracy or how much time"
        raise PlanError("nothing would ever end this plan", remedy)
    if not len(problem.lattice):
        raise PlanError("there is no place where a reading may be taken", "Allow an axis to move, or add a set-up")
    times = clock(problem)
    first = float((times.mounting + times.reading)[np.unique(problem.lattice.setups)].min())
    if limits.budget is not None and limits.budget < first:
        what = f"{limits.budget / 60:.3g} min is less than the {first / 60:.3g} min that the first reading takes"
        raise PlanError(what, "Allow more time, or give a set-up that is mounted faster")


def _together(
    problem: Problem, limits: Limits, times: Clock, pool: Pool, setups: Setups, begin: list[Point] | None
) -> Trial:
    """Return the best of what exchange makes of several beginnings with the same number of readings per set-up."""
    base, meter = Scores(pool, problem.state), Meter.of(problem.yardstick, problem.state.factor)
    greedy = filled(base.fork(), meter, limits, times, setups)
    counts = [(s, sum(p.setup == s for p in greedy.scores.points)) for s in setups]
    beginnings = [make(problem, counts) for make in (evenly_spaced, space_filling)]
    if begin and len(begin) == len(greedy.scores.members):
        beginnings = [begin]
    trials = [greedy]
    for points in beginnings:
        scores = base.fork()
        for point in points:
            scores.enter(point)
        trials.append(replace(greedy, scores=scores))
    for trial in trials:
        exchange(trial.scores, affordable(times, setups, 0.0 if limits.timed else np.inf))
    return min(trials, key=lambda trial: trial.scores.state.value)


def _fitted(problem: Problem, limits: Limits, times: Clock, trial: Trial) -> Trial:
    """Return the plan without what an accuracy does not need, and within the time as the true way takes it."""
    if limits.accurate:
        trial = _shrunk(problem, limits, times, trial)
    if limits.budget is None:
        return trial
    if not trial.met:
        trial = _extended(problem, limits, times, trial)
    while len(trial.scores.members) > 1 and (over := _seconds(problem, trial.scores.points) - limits.budget) > 0:
        for _ in range(min(1 + int(over / times.reading.max()), len(trial.scores.members) - 1)):
            _drop(trial.scores, times)
    return trial


def _drop(scores: Scores, times: Clock) -> None:
    """Take out the reading that is worth least per second."""
    slot = int((scores.losses() / times.reading[[p.setup for p in scores.points]]).argmin())
    scores.leave(slot)
    scores.close(slot)


def _shrunk(problem: Problem, limits: Limits, times: Clock, trial: Trial) -> Trial:
    """Take out the readings that are worth least per second, while the accuracy asked for holds."""
    for _ in range(_SHRINKS):
        if not limits.met(Meter.of(problem.yardstick, trial.scores.state.factor).accuracy):
            return trial
        trial = replace(trial, met=True)
        if len(trial.scores.members) < 2:
            return trial
        fewer = trial.scores.fork()
        _drop(fewer, times)
        exchange(fewer, affordable(times, trial.setups, 0.0), 3)
        if not limits.met(Meter.of(problem.yardstick, fewer.state.factor).accuracy):
            return trial
        trial = replace(trial, scores=fewer)
    return trial


def _extended(problem: Problem, limits: Limits, times: Clock, trial: Trial) -> Trial:
    """Fill what the true way leaves of the budget; what is too much goes again."""
    cost = times.reading[trial.scores.pool.lattice.setups]
    left = (limits.budget or 0.0) - _seconds(problem, trial.scores.points)
    while len(trial.scores.members) < (limits.readings or np.inf):
        rate = np.where(cost <= left, trial.scores.gains / cost, -np.inf)
        if not np.isfinite(rate.max()):
            break
        left -= float(cost[int(rate.argmax())])
        trial.scores.enter(int(rate.argmax()))
    return trial


def _seconds(problem: Problem, points: list[Point]) -> float:
    """Return the time of readings on a short way, set-up by set-up."""
    total, before = 0.0, problem.here
    for point in _by_setup(problem, points):
        total += way_seconds(problem, before, point)
        before = point
    return total


def _by_setup(problem: Problem, points: list[Point]) -> list[Point]:
    """Return the readings in travel order, set-ups in order of their index, the mounted one first."""
    mounted = problem.here.setup if problem.here else -1
    setups = sorted({p.setup for p in points}, key=lambda s: (s != mounted, s))
    groups = [[p for p in points if p.setup == setup] for setup in setups]
    return [group[i] for group in groups for i in ordered(problem, group)]


def _bound(problem: Problem, limits: Limits, times: Clock, pool: Pool, trial: Trial) -> Bound:
    """Return the bound for as many readings as the plan has, or for its seconds of settling and reading."""
    points, setups = trial.scores.points, problem.observation.setups
    of = np.concatenate([pool.lattice.setups, [p.setup for p in points]]).astype(np.intp)
    counted = np.ones(len(of))
    if not limits.timed:
        return lower_bound(pool, problem.state, points, counted, float(len(points)))
    costs = np.array([s.settle + s.reading_time for s in setups])[of]
    if not costs.min() > 0:
        return lower_bound(pool, problem.state, points, counted, float(len(points)))
    return lower_bound(pool, problem.state, points, costs, float(costs[len(pool) :].sum()))


def _plan(problem: Problem, limits: Limits, trial: Trial, bound: Bound | None, candidates: int) -> Plan:
    state = problem.state
    meter = Meter.of(problem.yardstick, state.factor)
    start, readings, seconds, before = meter.accuracy, [], 0.0, problem.here
    for point in _in_order(problem, trial.scores.points):
        state = state.opened([point])
        row, variance = state.row(point)
        change = state.change(row, variance)
        state, meter = state.after(row, variance, change), meter.after(change)
        seconds += way_seconds(problem, before, point)
        arrived = _arriving(problem, before, point)
        readings.append(PlannedReading(point.setup, point.pose, arrived, state.value, meter.accuracy, seconds))
        before = point
    return Plan(tuple(readings), state.value, start, limits.met(meter.accuracy), bound, candidates)


def _in_order(problem: Problem, points: list[Point]) -> list[Point]:
    """Return the readings in travel order; the set-up that takes J down fastest per second comes first."""
    setups = {p.setup for p in points}
    groups = {setup: _by_setup(problem, [p for p in points if p.setup == setup]) for setup in setups}
    done: list[Point] = []
    state: State = problem.state
    while groups:
        mounted = problem.here is not None and problem.here.setup in groups and not done
        after = {setup: state.with_points(group) for setup, group in groups.items()}
        rates = {s: (state.value - after[s].value) / _seconds(problem, groups[s]) for s in groups}
        best = problem.here.setup if mounted and problem.here else max(rates, key=lambda s: rates[s])
        done, state = done + groups.pop(best), after[best]
    return done


def _arriving(problem: Problem, before: Point | None, point: Point) -> Array:
    """Return the approach of a reading, with the direction of travel where any direction will do."""
    counted = counting(problem, point)
    if before is None or before.setup != point.setup:
        return point.approach
    travel = np.sign(point.pose - before.pose)
    return np.where(counted != 0, counted, np.where(travel != 0, travel, point.approach) * (point.approach != 0))
