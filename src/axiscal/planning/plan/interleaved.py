"""Readings interleaved along an axis, so that no drift and no growth passes for an error of the axis.

Read out and back, a zero that comes and goes is the same on both ways, and an axis that grows and shrinks again has
always grown by half at its far end. Both then look like an error. So pairs of readings change their turns where that
lowers D times the seconds of the plan. D is J with all that passes and with reversals that need a way, less the J that
readings without noise would leave at these places. With rows G, the criterion V and columns P of what passes

    D = tr(K₀⁻¹ B) − tr(K⁻¹ B),    K = K₀ + R + P Pᵀ,    K₀ = G C Gᵀ,    B = G C Vᵀ V C Gᵀ
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.promise.passing import Turning, drift_functions, growing, growth_functions, turning
from axiscal.measurement.place import Places
from axiscal.measurement.setup import Setup
from axiscal.measurement.travel import way_seconds
from axiscal.numerics import Array
from axiscal.planning.gains.covariance import Covariance
from axiscal.planning.plan.order import counting, returns, seconds_along, seconds_each
from axiscal.planning.plan.task import Limits, Task

_LARGER = 3.0
"""Times its default, so large is what passes here: with the defaults readings interleave too little."""
_WOUND = 10.0
"""Times its default, so large is what a reversal lacks here: with the default no order of readings shows it."""
_PAIRS, _WORK = 300, 1e9
"""Pairs that are tried, and operations at most: a hundred pairs leave J within 2 % of what a thousand do."""
_SAME = 1e-9
"""Readings that differ by less of their variances are the same."""
_SEED = 1
"""Any: a plan is the same every time."""


class _AtTurns(NamedTuple):
    """What passes at the turns of a set-up: covariances of its zeros and of its growth, (r, r)."""

    zeros: Array
    growth: Array

    @classmethod
    def at(cls, setup: Setup, clock: Array) -> _AtTurns:
        """Return it.  clock : (r,) of the turns, s"""
        drift, growth = (_LARGER * each(setup, clock) for each in (drift_functions, growth_functions))
        return cls(drift @ drift.T, growth @ growth.T)


@dataclass(frozen=True, eq=False)
class _OneSetup:
    """Readings of one set-up, in any order.

    exact : tr(K₀⁻¹ B); lasting : (k, k) K₀ + R; weights : B (k, k); owner : (k,) the reading of each number
    shared : (k, k) whether two numbers have one zero; growing : (k, k) how alike two of them grow
    turning : reversals that need a way; inside : (k,) which number of its reading each is; poses : (r, q)
    ways : (r, r) seconds from each reading to each; first : (r,) seconds to each from where the machine stands
    """

    passing: _AtTurns
    exact: float
    lasting: Array
    weights: Array
    owner: NDArray[np.intp]
    shared: Array
    growing: Array
    turning: list[Turning]
    inside: NDArray[np.intp]
    poses: Array
    ways: Array
    first: Array

    def value(self, turns: NDArray[np.intp]) -> float:
        """Return D.  turns : (r,) of each reading"""
        at = np.ix_(turns[self.owner], turns[self.owner])
        known = self.lasting + self.passing.zeros[at] * self.shared + self.passing.growth[at] * self.growing
        for each in self.turning:
            missing = _WOUND * each.missing(self.poses, np.argsort(turns))[self.inside, self.owner]
            known += np.outer(missing, missing)
        return self.exact - float(np.sum(np.linalg.inv(known) * self.weights))

    def seconds(self, turns: NDArray[np.intp]) -> float:
        """Return the time of the ways.  turns : (r,) of each reading"""
        order = np.argsort(turns)
        return float(self.first[order[0]] + self.ways[order[:-1], order[1:]].sum())


def interleaved(task: Task, limits: Limits, order: Places) -> Places:
    """Return readings with those of set-ups that move one axis interleaved, as far as the time allows.

    order : in which they would be taken, set-up by set-up
    """
    result = order
    for setup in dict.fromkeys(order.setups.tolist()):
        where = np.flatnonzero(order.setups == setup)
        if returns(task.observation.setups[setup]) and len(where) > 2:
            every = np.arange(len(order))
            every[where] = where[_turned(task, limits, result, where)]
            result = result.within(every)
    return result


def _turned(task: Task, limits: Limits, order: Places, where: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the order of the readings of one set-up.  where : (r,) they are, among all"""
    way, count = _way(task, order, where), len(where)
    turns = np.arange(count)
    others = seconds_along(task, order) - way.seconds(turns)
    most = np.inf if limits.budget is None else max(limits.budget, others + way.seconds(turns))
    least = way.value(turns) * (others + way.seconds(turns))
    rng = np.random.default_rng(_SEED)
    for _ in range(int(min(_PAIRS, _WORK / (2 * len(way.owner) ** 3)))):
        changed, pair = turns.copy(), rng.choice(count, 2, replace=False)
        changed[pair] = turns[pair[::-1]]
        seconds = others + way.seconds(changed)
        if seconds <= most and (cost := way.value(changed) * seconds) < least:
            turns, least = changed, cost
    return np.argsort(turns)


def _way(task: Task, order: Places, where: NDArray[np.intp]) -> _OneSetup:
    mine, index = order.within(where), int(order.setups[where[0]])
    setup, machine = task.observation.setups[index], task.observation.machine
    state = _after_others(task, order, where).opened(mine)
    rows, variances, owner = state.rows(mine)
    seen = rows @ state.factor
    lasting, crossed = seen @ seen.T, state.weighted @ seen.T
    weights = crossed.T @ crossed
    inside = np.arange(len(rows)) - np.searchsorted(owner, owner)
    grown = [axis[inside, owner] for axis in growing(task.observation, index, mine.poses)]
    counted = counting(task, mine)
    here = task.here if task.here is not None and int(task.here.setups[0]) == index else None
    first = np.zeros(len(mine)) if here is None else way_seconds(machine, setup, here.poses, mine.poses, counted)
    return _OneSetup(
        _AtTurns.at(setup, np.cumsum(seconds_each(task, order)[where])),
        float(np.sum(np.linalg.pinv(lasting, _SAME, hermitian=True) * weights)),
        lasting + np.diag(variances),
        weights,
        owner,
        inside[:, None] == inside,
        sum((np.outer(each, each) for each in grown), np.zeros((len(rows), len(rows)))),
        turning(task.observation, index, mine.poses, mine.approaches),
        inside,
        mine.poses,
        way_seconds(machine, setup, mine.poses[:, None], mine.poses[None], counted[None]),
        first,
    )


def _after_others(task: Task, order: Places, where: NDArray[np.intp]) -> Covariance:
    """Return what is known after the readings of other set-ups."""
    others = np.setdiff1d(np.arange(len(order)), where)
    return task.state.after_readings(order.within(others)) if len(others) else task.state
