"""A plan made to fit its limits: no reading that an accuracy does not need, none for which there is no time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from axiscal.design.gains.running_accuracy import RunningAccuracy
from axiscal.design.gains.running_gains import Scores
from axiscal.design.plan.exchange import exchange
from axiscal.design.plan.greedy import Trial, affordable
from axiscal.design.plan.order import seconds_of
from axiscal.design.plan.task import Clock, Limits, Task
from axiscal.numerics.ties import ALIKE, first_best

_SHRINKS = 60
"""Halvings of a time: to a second of any budget after twenty."""


def fitted(task: Task, limits: Limits, times: Clock, trial: Trial) -> Trial:
    """Return the plan without what an accuracy does not need, and within the time as the true way takes it."""
    if limits.accurate:
        trial = _shrunk(task, limits, times, trial)
    if limits.budget is None:
        return trial
    if not trial.met:
        trial = _extended(task, limits, times, trial)
    while len(trial.scores.members) > 1 and (over := seconds_of(task, trial.scores.places) - limits.budget) > 0:
        for _ in range(min(1 + int(over / times.reading.max()), len(trial.scores.members) - 1)):
            drop(trial.scores, times)
    return trial


def drop(scores: Scores, times: Clock) -> None:
    """Take out the reading that is worth least per second."""
    slot = first_best(-scores.losses() / times.reading[scores.places.setups], ALIKE)
    scores.leave(slot)
    scores.close(slot)


def _shrunk(task: Task, limits: Limits, times: Clock, trial: Trial) -> Trial:
    """Take out the readings that are worth least per second, while the accuracy asked for holds."""
    for _ in range(_SHRINKS):
        if not limits.met(RunningAccuracy.of(task.yardstick, trial.scores.state.factor).accuracy):
            return trial
        trial = replace(trial, met=True)
        if len(trial.scores.members) < 2:
            return trial
        fewer = trial.scores.fork()
        drop(fewer, times)
        exchange(fewer, affordable(times, trial.setups, 0.0), 3)
        if not limits.met(RunningAccuracy.of(task.yardstick, fewer.state.factor).accuracy):
            return trial
        trial = replace(trial, scores=fewer)
    return trial


def _extended(task: Task, limits: Limits, times: Clock, trial: Trial) -> Trial:
    """Fill what the true way leaves of the budget; what is too much goes again."""
    cost = times.reading[trial.scores.pool.lattice.setups]
    left = (limits.budget or 0.0) - seconds_of(task, trial.scores.places)
    while len(trial.scores.members) < (limits.readings or np.inf):
        rate = np.where(cost <= left, trial.scores.gains / cost, -np.inf)
        if not np.isfinite(rate.max()):
            break
        best = first_best(rate, ALIKE)
        left -= float(cost[best])
        trial.scores.enter(best)
    return trial
