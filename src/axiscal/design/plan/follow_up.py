"""Readings more, after others that are taken already: those that lower most what all of them cannot vouch for.

What was read, and when, stands; a drift is seen by what is read now and was read before. So the readings that are taken
enter first, each at its time, and those to come at the end of the time.
"""

from __future__ import annotations

import numpy as np

from axiscal.design.gains.candidate_rows import Pool
from axiscal.design.plan.defended import DefendedScores
from axiscal.design.plan.order import in_order, seconds_each
from axiscal.design.plan.task import Task, clock
from axiscal.design.plan.watch import at_share, watch
from axiscal.measurement.place import Places
from axiscal.numerics import Array
from axiscal.numerics.ties import ALIKE, first_best

_SQUARINGS = 4
"""p of the objective is 16: nearly the largest of promise and damages counts."""


def follow_up(task: Task, taken: Places, ends: Array, count: int, budget: float | None = None) -> Places:
    """Return so many readings more in their order, fewer where the time is short.

    task : with what was known before the first reading; taken : readings so far, in their order
    ends : (m,) when each of them ended, s; budget : time that is left, s
    """
    times = clock(task)
    last = float(ends[-1]) + count * float(times.reading.max())
    later = at_share(watch(task.observation, task.yardstick, task.lattice, taken, ends, "detail"), 1.0)
    scores = DefendedScores(
        Pool(task.observation, task.lattice, task.memory), task.state, later, task.yardstick, _SQUARINGS
    )
    for index, share in enumerate(_shares(taken, ends, last)):
        scores.watched = at_share(later, share)
        scores.enter(taken.at(index))
    scores.watched = later
    cost = (times.reading + times.mounting / count)[task.lattice.setups]
    for _ in range(count):
        scores.enter(first_best(scores.gains / cost, ALIKE))
    order = in_order(task, scores.places.within(np.arange(len(taken), len(taken) + count)))
    spent = np.cumsum(seconds_each(task, order))
    return order if budget is None else order.within(np.flatnonzero(spent <= budget))


def _shares(taken: Places, ends: Array, last: float) -> list[float]:
    """Return at what share of the time of its set-up each reading was taken.  last : when the last one to come ends"""
    begun = {setup: float(ends[mine].min()) for setup, mine in taken.by_setup()}
    first = np.array([begun[setup] for setup in taken.setups.tolist()])
    shares: list[float] = ((ends - first) / (last - first)).tolist()
    return shares
