"""Places of a plan that keep no regular distances: a regular plan would hide errors that repeat with its distances."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from axiscal.measurement.reading import Places
from axiscal.numerics import Array
from axiscal.planning.gains.covariance import left_by
from axiscal.planning.plan.task import Task

_SHAKES, _SHARE, _SEED = 10, 0.02, 1
"""How many, by how much of the travel at most, and any seed: a plan is the same every time."""
_FEWEST = 8
"""Readings of a set-up below which every place counts more than what may repeat."""


def shaken(task: Task, places: Places) -> Places:
    """Return the best of ten plans, places shaken by some hundredths of the travel; as they are where none may be.

    The best plan is nearly regular, and hides what repeats. Shaking costs about 4 % of J; without it an error with a
    period near the distance of the places is missed as a whole.
    """
    reach, states = _reach(task, places), task.states
    if not np.any(reach):
        return places
    rng = np.random.default_rng(_SEED)
    drawn = [places.poses + reach * rng.uniform(-1.0, 1.0, places.poses.shape) for _ in range(_SHAKES)]
    found = [replace(places, poses=_within(task, places, poses)) for poses in drawn]
    return min(found, key=lambda each: left_by(states, each))


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
