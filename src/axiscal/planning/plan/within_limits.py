"""A plan made to fit its limits: no reading that an accuracy does not need, none for which there is no time."""

from __future__ import annotations

from dataclasses import replace

from axiscal.numerics.ties import ALIKE, first_best
from axiscal.planning.gains.running_accuracy import RunningAccuracy
from axiscal.planning.gains.running_gains import Scores
from axiscal.planning.plan.exchange import exchange
from axiscal.planning.plan.greedy import Trial, affordable, filled
from axiscal.planning.plan.order import seconds_of
from axiscal.planning.plan.task import Clock, Limits, Task

_SHRINKS = 60
"""Halvings of a time: to a second of any budget after twenty."""


def fitted(task: Task, limits: Limits, times: Clock, trial: Trial) -> Trial:
    """Return the plan without what an accuracy does not need, and within the time as the true way takes it."""
    if limits.accurate:
        trial = _shrunk(task, limits, times, trial)
    if limits.budget is None:
        return trial
    if not trial.met:
        meter = RunningAccuracy.of(task.yardstick, trial.scores.state.factor)
        in_time, spent = replace(limits, rms=None, worst=None), seconds_of(task, trial.scores.places)
        filled(trial.scores, meter, in_time, times, trial.setups, begun=spent)  # what is too much goes again
    while len(trial.scores.places) > 1 and (over := seconds_of(task, trial.scores.places) - limits.budget) > 0:
        for _ in range(min(1 + int(over / times.reading.max()), len(trial.scores.places) - 1)):
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
        if len(trial.scores.places) < 2:
            return trial
        fewer = trial.scores.fork()
        drop(fewer, times)
        exchange(fewer, affordable(times, trial.setups, 0.0), 3)
        if not limits.met(RunningAccuracy.of(task.yardstick, fewer.state.factor).accuracy):
            return trial
        trial = replace(trial, scores=fewer)
    return trial
