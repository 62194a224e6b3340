"""Places shaken by a few hundredths of the travel: the best plan is nearly regular, and hides what repeats.

Of ten shakes the one with the least J is taken. It costs about 4 % of J; without it an error with a period near the
distance of the places is missed as a whole.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from axiscal.design.gains.candidate_rows import Pool
from axiscal.design.gains.running_gains import Scores
from axiscal.design.plan.task import Task
from axiscal.measurement.place import Places
from axiscal.numerics import Array

_SHAKES, _SHARE, _SEED = 10, 0.02, 1
"""How many, by how much of the travel at most, and any seed: a plan is the same every time."""
_FEWEST = 8
"""Readings of a set-up below which every place counts more than what may repeat."""


def shaken(task: Task, pool: Pool, places: Places) -> Scores | None:
    """Return the best of ten shaken plans; None where no reading may be shaken."""
    reach = _reach(task, places)
    if not np.any(reach):
        return None
    rng, best = np.random.default_rng(_SEED), None
    for _ in range(_SHAKES):
        poses = places.poses + reach * rng.uniform(-1.0, 1.0, places.poses.shape)
        scores = Scores(pool, task.state)
        scores.enter_all(replace(places, poses=_within(task, places, poses)))
        if best is None or scores.state.value < best.state.value:
            best = scores
    return best


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
