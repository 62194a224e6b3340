"""The rest of a plan, renewed while measuring: from the readings that are still open, by what exchanges still help.

Readings of linear instruments sharpen a belief by where they are taken, not by what they say: as long as each is taken
where it was planned and is believed, the rest of a plan is still the plan. Otherwise it is begun with here, so that
the renewed plan is no worse than the old one, and little has to be looked at.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from axiscal.design.gains.candidate_rows import Pool
from axiscal.design.gains.covariance import Point
from axiscal.design.gains.running_accuracy import RunningAccuracy
from axiscal.design.gains.running_gains import Scores
from axiscal.design.plan.exchange import exchange, polish
from axiscal.design.plan.greedy import Setups, Trial, affordable
from axiscal.design.plan.order import arriving, in_order, seconds_along, steps
from axiscal.design.plan.plan import Patience
from axiscal.design.plan.task import Clock, Limits, Task, clock
from axiscal.design.plan.within_limits import drop, fitted

_SWEEPS = 3
_WORTH = 0.01
"""An exchange must bring a hundredth more than the reading it replaces: less is not worth another way."""
_ROUNDS = 2
_MORE = 10
"""So many readings at once are added to a plan that has come to fall short."""


def renewed(problem: Task, limits: Limits, left: list[Point], patience: float = 0.0) -> list[Point]:
    """Return the readings to come in their order, from those that are left of a plan and within its set-ups.

    limits : what is left of them; patience : seconds for climbing off the lattice
    None are returned where there is no time for any of these set-ups.
    """
    times = clock(problem)
    left = _mountable(limits, times, left)
    setups = _setups(problem, left)
    lattice = problem.lattice.within(np.isin(problem.lattice.setups, setups))
    points = left
    if len(lattice):
        trial = _begun(problem, limits, times, Pool(problem.observation, lattice, problem.memory), setups, left)
        trial = _filled(problem, limits, times, trial)
        exchange(trial.scores, affordable(times, setups, limits.slack), _SWEEPS, _WORTH)
        polish(trial.scores, affordable(times, setups, 0.0), _ROUNDS, Patience(patience))
        points = fitted(problem, limits, times, trial).scores.points
    order = _shorter(problem, in_order(problem, points), left)
    return [p._replace(approach=arriving(problem, before, p)) for before, p in steps(problem, order)]


def _shorter(problem: Task, order: list[Point], left: list[Point]) -> list[Point]:
    """Return the order as it was, where it holds the same readings and takes no longer."""
    same = {id(point) for point in order} == {id(point) for point in left}
    return left if same and seconds_along(problem, left) <= seconds_along(problem, order) else order


def _mountable(limits: Limits, times: Clock, left: list[Point]) -> list[Point]:
    """Return the readings of the set-ups that there is time to mount, one after another."""
    spent, kept = 0.0, set[int]()
    for setup in dict.fromkeys(point.setup for point in left):
        first = float(times.mounting[setup] + times.reading[setup])
        if limits.budget is None or spent + first <= limits.budget:
            spent += first
            kept.add(setup)
    return [point for point in left if point.setup in kept]


def _setups(problem: Task, left: list[Point]) -> Setups:
    mounted = [] if problem.here is None else [problem.here.setup]
    return tuple(sorted({*mounted, *(point.setup for point in left)}))


def _begun(problem: Task, limits: Limits, times: Clock, pool: Pool, setups: Setups, left: list[Point]) -> Trial:
    """Return the plan that is left, of no more readings than there may be."""
    scores = Scores(pool, problem.state)
    for point in left:
        scores.enter(point)
    while limits.readings is not None and len(scores.members) > limits.readings:
        drop(scores, times)
    return Trial(scores, setups, 0.0, met=False)


def _filled(problem: Task, limits: Limits, times: Clock, trial: Trial) -> Trial:
    """Return the plan with a few readings more where it falls short of what is asked for; a budget is filled later."""
    scores, cost = trial.scores, times.reading[trial.scores.pool.lattice.setups]
    for _ in range(_MORE):
        met = limits.met(RunningAccuracy.of(problem.yardstick, scores.state.factor).accuracy)
        full = limits.readings is not None and len(scores.members) >= limits.readings
        if met or full or (limits.budget is not None and not limits.accurate):
            break
        scores.enter(int((scores.gains / (cost if limits.timed else 1.0)).argmax()))
    return replace(trial, met=met)
