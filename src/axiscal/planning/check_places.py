"""Check readings of a plan: places, sides and times drawn at random, put where they cost least time.

A fifth of all readings, 3 to 12, are checks; there are none below 12 readings, nor where nothing usually goes wrong.
The search chooses the others. So no place of a check follows from what the model thinks of the machine.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from axiscal.description.campaign import CampaignDescription
from axiscal.estimation.case import Case
from axiscal.measurement.reading import Place, Places, Reading
from axiscal.measurement.travel import way_seconds
from axiscal.planning.other_readings import columns_of, with_rooms
from axiscal.planning.plan.order import arriving, counting, seconds_along
from axiscal.planning.plan.task import Limits, Task

_SHARE, _FEWEST, _MOST, _LEAST = 5, 3, 12, 12
"""One of so many readings is a check, from few that tell s to many; below so many readings all are planned ones."""
_SEED = 2
"""Any: the same machine has the same plan."""
_DIGITS = 9
"""Decimals of m or rad: rounding of a place."""

Planner = Callable[[Limits, tuple[Place, ...]], tuple[Place, ...]]
"""The readings to come within limits, from those that are left of an earlier plan."""


def checks_among(described: CampaignDescription, readings: int) -> int:
    """Return how many of so many readings are checks."""
    if described.target.checks is not None:
        return described.target.checks
    if not described.usual or readings < _LEAST:
        return 0
    return min(max(round(readings / _SHARE), _FEWEST), _MOST)


def checks_beside(described: CampaignDescription, planned: int) -> int:
    """Return how many checks so many planned readings have beside them."""
    count = 0
    while checks_among(described, planned + count) > count:
        count += 1
    return count


def distinct(candidates: Places) -> Places:
    """Return one of the candidates at each place of a set-up, the side drawn at random; in any order."""
    mixed = candidates.within(np.random.default_rng(_SEED).permutation(len(candidates)))
    _, first = np.unique(np.round(np.column_stack([mixed.setups, mixed.poses]), _DIGITS), axis=0, return_index=True)
    return mixed.within(first)


def drawn_places(candidates: Places, among: NDArray[np.intp], count: int, turn: int = 0) -> Places:
    """Return `count` distinct candidates drawn at random, fewer where there are fewer.

    among : (n,) set-ups of readings, by which they are shared; turn : another one draws others
    """
    rng, found = np.random.default_rng([_SEED, turn]), [candidates.within(slice(0, 0))]
    shares = np.sort(among)[(np.arange(count) * len(among) + len(among) // 2) // max(count, 1)]
    for setup in dict.fromkeys(shares.tolist()):
        mine = np.flatnonzero(candidates.setups == setup)
        found.append(candidates.within(rng.permutation(mine)[: int(np.sum(shares == setup))]))
    return Places.joined(found)


def with_checks(
    case: Case, task: Task, limits: Limits, readings: Sequence[Reading], left: Sequence[Place], planner: Planner
) -> tuple[Place, ...]:
    """Return the readings to come with the checks among them, within the limits.  Raises PlanError.

    readings : so far; left : of an earlier plan, with its checks
    """
    described, taken = case.description, sum(reading.check for reading in readings)
    own, drawn = (tuple(place for place in left if place.check is which) for which in (False, True))
    most = len(readings) + (limits.readings or 0)
    count = _MOST if limits.readings is None else min(checks_among(described, most) - taken, limits.readings)
    if limits.readings is not None and count > 0:
        limits = replace(limits, readings=limits.readings - count)
    places = () if limits.readings == 0 else planner(limits, own)
    if len(places) != limits.readings:
        count = min(count, checks_beside(described, len(readings) - taken + len(places)) - taken)
    if count <= 0 or not (places or drawn):
        return places
    found = _inserted(case, task, places, _drawn(case, task, places, drawn, count, len(readings)))
    longer, budget = seconds_along(task, columns_of(case, found)), limits.budget
    if budget is None or longer <= budget:
        return found
    # the search and its order fill all the time that they may
    left_over = budget - (longer - seconds_along(task, columns_of(case, places)))
    places = planner(replace(limits, budget=max(left_over, 0.0)), own)
    every = _drawn(case, task, places, drawn, count, len(readings))
    tried = (_inserted(case, task, places, every.within(slice(kept))) for kept in range(count, 0, -1))
    return next((each for each in tried if seconds_along(task, columns_of(case, each)) <= budget), places)


def _drawn(case: Case, task: Task, places: Sequence[Place], drawn: Sequence[Place], count: int, turn: int) -> Places:
    """Return `count` checks to come: those that are left of an earlier plan first."""
    known = columns_of(case, drawn[:count])
    among = columns_of(case, places or drawn).setups
    return Places.joined([known, drawn_places(distinct(task.lattice), among, count - len(known), turn)])


def _inserted(case: Case, task: Task, places: Sequence[Place], checks: Places) -> tuple[Place, ...]:
    """Return readings with checks where each costs least time, after the first of its set-up.

    A check of a set-up that is neither mounted nor to be mounted is left out.
    """
    order, drawn = columns_of(case, places), np.zeros(len(places), dtype=bool)
    for index in range(len(checks)):
        each = checks.single(index)
        if (at := _cheapest(task, order, each)) is not None:
            order = Places.joined([order.within(slice(at)), each, order.within(slice(at, None))])
            drawn = np.insert(drawn, at, True)
    order = replace(order, approaches=arriving(task, order))
    marked = zip(with_rooms(case, order), drawn.tolist(), strict=True)
    return tuple(replace(place, check=check) for place, check in marked)


def _cheapest(task: Task, order: Places, check: Places) -> int | None:
    """Return before which reading of an order a check costs least time; None where its set-up is not there."""
    index = int(check.setups[0])
    mine = np.flatnonzero(order.setups == index)
    here = task.here is not None and int(task.here.setups[0]) == index
    if not len(mine):
        return 0 if here else None
    machine, setup, run = task.observation.machine, task.observation.setups[index], order.within(mine)
    sides, own = counting(task, run), counting(task, check)
    there = way_seconds(machine, setup, run.poses, check.poses, own, straight=True)
    back = way_seconds(machine, setup, check.poses, run.poses[1:], sides[1:], straight=True)
    saved = way_seconds(machine, setup, run.poses[:-1], run.poses[1:], sides[1:], straight=True)
    costs = there + np.append(back - saved, 0.0)
    return int(mine[np.argmin(costs)]) + 1
