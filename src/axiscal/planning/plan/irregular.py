"""Places of a plan that keep no regular distances: a regular plan would hide errors that repeat with its distances."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from axiscal.measurement.reading import Places
from axiscal.numerics import Array
from axiscal.planning.plan.beginnings import evenly_spaced
from axiscal.planning.plan.minutes import retoured
from axiscal.planning.plan.task import Goal, Limits, Task

_SHAKES, _SHARE, _SEED = 10, 0.02, 1
"""How many, by how much of the travel at most, and any seed: a plan is the same every time."""
_FEWEST = 8
"""Readings of a set-up below which every place counts more than what may repeat."""
_DRAWN, _AS_GOOD = 0.8, 1.15
"""Share of its part in which a place is drawn, and times J: beds of printers are missed by less than from an even grid
(`make trust PART=beds`)."""


def irregular(task: Task, limits: Limits, order: Places, goal: Goal | None = None) -> Places:
    """Return readings at places that keep no regular distances; where seconds count in their order and within limits.

    goal : an accuracy that they reach; it stays reached
    """
    places = spread_if_as_good(task, goal, shaken(task, order))
    if not limits.timed or places.same_as(order):
        return places
    setups = tuple(np.unique(order.setups).tolist())
    return retoured(task, limits, setups, places, 0.0, np.inf, goal)


def shaken(task: Task, places: Places) -> Places:
    """Return the best of ten plans, places shaken by some hundredths of the travel; as they are where none may be.

    The best plan is nearly regular, and hides what repeats. Shaking costs about 4 % of J; without it an error with a
    period near the distance of the places is missed as a whole.
    """
    reach = _reach(task, places)
    if not np.any(reach):
        return places
    rng = np.random.default_rng(_SEED)
    drawn = [places.poses + reach * rng.uniform(-1.0, 1.0, places.poses.shape) for _ in range(_SHAKES)]
    found = [replace(places, poses=_within(task, places, poses)) for poses in drawn]
    return min(found, key=lambda each: task.after(each).value)


def spread_if_as_good(task: Task, goal: Goal | None, places: Places) -> Places:
    """Return a reading in each of equal parts, where set-ups move one axis each and J is not much larger.

    Real errors are rougher than any model of them. Of two plans about as good by J the evener one misses less, and
    places drawn within their parts hide few periods. Two stand at each end if J allows it: a slip alone there would
    pass for a detail. Else the first and the last stand at the ends.
    """
    setups, axes = task.observation.setups, task.observation.machine.axes
    if not np.all(np.any(_reach(task, places), axis=1)) or any(len(setups[s].moves) > 1 for s in places.setups):
        return places
    before = task.after(places).value
    for shares in (_twice_at_ends, _from_end_to_end):
        even = evenly_spaced(task, [(setup, len(mine)) for setup, mine in places.by_setup()])
        for setup, mine in even.by_setup():
            (axis,) = setups[setup].moves
            low, high = setups[setup].span(axes[axis], axis)
            even.poses[mine, axis] = low + (high - low) * shares(len(mine))
        after = task.after(even)
        if after.value <= _AS_GOOD * before and (goal is None or goal.reached(even)):
            return even
    return places


def _twice_at_ends(count: int) -> Array:
    """Return a place in each of count - 2 equal parts of a travel, two in the first and the last, shares of it."""
    parts = np.clip(np.arange(-1, count - 1), 0, count - 3) + 0.5
    return (parts + _drawn(count)) / (count - 2)


def _from_end_to_end(count: int) -> Array:
    """Return places from one end of a travel to the other, each near its place among even ones, shares of it."""
    drawn = _drawn(count)
    drawn[[0, -1]] = 0.0
    return (np.arange(count) + drawn) / (count - 1)


def _drawn(count: int) -> Array:
    """Return how far places lie from the middles of their parts, shares of a part."""
    return _DRAWN * np.random.default_rng(_SEED).uniform(-0.5, 0.5, count)


def _reach(task: Task, places: Places) -> Array:
    """Return how far each coordinate of each place may be shaken, (m, q) m or rad."""
    reach, axes = np.zeros_like(places.poses), task.observation.machine.axes
    for index, mine in places.by_setup():
        setup = task.observation.setups[index]
        if setup.chart is None and setup.artefact is None and len(places.poses[mine]) >= _FEWEST:
            for k in setup.moves:
                reach[mine, k] = _SHARE * axes[k].length if setup.raster[k] == 0 else 0.0
    return reach


def _within(task: Task, places: Places, poses: Array) -> Array:
    """Return poses within the span in which each set-up is read."""
    held, axes = poses.copy(), task.observation.machine.axes
    for index, mine in places.by_setup():
        setup = task.observation.setups[index]
        for k in setup.moves:
            held[mine, k] = np.clip(poses[mine, k], *setup.span(axes[k], k))
    return held
