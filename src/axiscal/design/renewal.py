"""The rest of a plan, renewed while measuring: from the readings that are still open, by what exchanges still help.

Readings of linear instruments sharpen a belief by where they are taken, not by what they say: as long as each is taken
where it was planned and is believed, the rest of a plan is still the plan. Otherwise it is begun with here, so that
the renewed plan is no worse than the old one, and little has to be looked at.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from axiscal.design.allocation import Setups, Trial, affordable
from axiscal.design.exchange import exchange, polish
from axiscal.design.fitting import drop, fitted
from axiscal.design.meter import Meter
from axiscal.design.order import arriving, in_order
from axiscal.design.plan import Patience
from axiscal.design.pool import Pool
from axiscal.design.problem import Clock, Limits, Problem, clock
from axiscal.design.scoring import Scores
from axiscal.design.state import Point

_SWEEPS = 3
_WORTH = 0.01
"""An exchange must bring a hundredth more than the reading it replaces: less is not worth another way."""
_ROUNDS = 2
_MORE = 12
"""So many readings at once are added to a plan that has come to fall short."""


def renewed(problem: Problem, limits: Limits, left: list[Point], patience: float = 0.0) -> list[Point]:
    """Return the readings to come in their order, from those that are left of a plan and within its set-ups.

    limits : what is left of them; patience : seconds for climbing off the lattice
    """
    times, setups = clock(problem), _setups(problem, left)
    pool = Pool(problem.observation, problem.lattice.within(np.isin(problem.lattice.setups, setups)), problem.memory)
    trial = _filled(problem, limits, times, _begun(problem, limits, times, pool, setups, left))
    exchange(trial.scores, affordable(times, setups, 0.0 if limits.timed else np.inf), _SWEEPS, _WORTH)
    polish(trial.scores, affordable(times, setups, 0.0), _ROUNDS, Patience(patience))
    points = in_order(problem, fitted(problem, limits, times, trial).scores.points)
    before = [problem.here, *points[:-1]]
    return [p._replace(approach=arriving(problem, b, p)) for b, p in zip(before, points, strict=True)]


def _setups(problem: Problem, left: list[Point]) -> Setups:
    mounted = [] if problem.here is None else [problem.here.setup]
    return tuple(sorted({*mounted, *(point.setup for point in left)}))


def _begun(
    problem: Problem, limits: Limits, times: Clock, pool: Pool, setups: Setups, left: list[Point]
) -> Trial:
    """Return the plan that is left, of no more readings than there may be."""
    scores = Scores(pool, problem.state)
    for point in left:
        scores.enter(point)
    while limits.readings is not None and len(scores.members) > limits.readings:
        drop(scores, times)
    return Trial(scores, setups, 0.0, met=False)


def _filled(problem: Problem, limits: Limits, times: Clock, trial: Trial) -> Trial:
    """Return the plan with a few readings more where it falls short of what is asked for; a budget is filled later."""
    scores, cost = trial.scores, times.reading[trial.scores.pool.lattice.setups]
    meter = Meter.of(problem.yardstick, scores.state.factor)
    for _ in range(_MORE):
        full = limits.readings is not None and len(scores.members) >= limits.readings
        if full or limits.met(meter.accuracy) or (limits.budget is not None and not limits.accurate):
            break
        scores.enter(int((scores.gains / (cost if limits.timed else 1.0)).argmax()))
        meter = meter.after(scores.last)
    return replace(trial, met=limits.met(meter.accuracy))
