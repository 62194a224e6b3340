"""What searches from other starts find: how good a plan is where no proof is near.

Each begins at readings drawn at random, and does what the search for the plan does from there on.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.measurement.reading import Places
from axiscal.planning.plan.exchange import ROUNDS, exchange, polish
from axiscal.planning.plan.greedy import scores_among
from axiscal.planning.plan.irregular import irregular
from axiscal.planning.plan.minutes import from_elsewhere
from axiscal.planning.plan.order import seconds_along
from axiscal.planning.plan.task import PATIENCE, Limits, Patience, Task

_MOST, _SEED = 20, 2
"""Searches at most: what a few do not find hardly any finds; any seed: they are the same every time."""
_WORK = 5e9
"""Operations after which no search is begun: seconds, by work and not by the clock."""
_ALIKE = 1e-3
"""Share of J by which a plan must be better to be called so."""


@dataclass(frozen=True, slots=True)
class Searches:
    """Searches from other starts.

    count : of them; better : those whose J is smaller by more than a thousandth; alike : those within it
    share : the least J of all, of that of the plan
    """

    count: int
    better: int
    alike: int
    share: float


def searched(task: Task, limits: Limits, places: Places, usual: bool) -> Searches:
    """Return what searches from other starts find for as many readings, or for the time that they take.

    places : of a plan in their order, at least one, without checks; usual : as of `make_plan`
    """
    value, work, found = task.state.after_readings(places).value, Patience(_WORK), list[float]()
    while len(found) < _MOST and not work.spent:
        search = _in_minutes if limits.timed else _so_many
        found.append(task.state.after_readings(search(task, limits, places, usual, len(found), work)).value)
    shares = np.array(found) / value
    better, alike = shares < 1 - _ALIKE, np.abs(shares - 1) <= _ALIKE
    return Searches(len(found), int(better.sum()), int(alike.sum()), float(shares.min()))


def _in_minutes(task: Task, limits: Limits, places: Places, usual: bool, number: int, work: Patience) -> Places:
    """Return readings of the same set-ups for the time of a plan."""
    within = Limits(limits.readings, budget=seconds_along(task, places))
    setups = tuple(np.unique(places.setups).tolist())
    order, done = from_elsewhere(task, within, setups, number, PATIENCE)
    work.take(done)
    return irregular(task, within, order) if usual else order


def _so_many(task: Task, limits: Limits, places: Places, usual: bool, number: int, work: Patience) -> Places:
    """Return as many readings of each set-up as a plan has."""
    rng, counts = np.random.default_rng([_SEED, number]), dict[int, int]()
    for setup, mine in places.by_setup():
        counts[setup] = len(places.within(mine))
    scores = scores_among(task, tuple(counts))
    lattice = scores.pool.lattice
    drawn = [rng.choice(np.flatnonzero(lattice.setups == s), count) for s, count in counts.items()]
    scores.enter_all(lattice.within(np.concatenate(drawn)))
    work.take(exchange(scores))
    climbs = Patience(PATIENCE)
    polish(scores, ROUNDS, climbs)
    work.take(PATIENCE - climbs.left)
    return irregular(task, limits, scores.places) if usual else scores.places
