"""Which unknowns come with readings: the rests of cells that they are the first to lie in, and how zeros wander."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from axiscal.measurement.cells import Cell, rest_effects
from axiscal.measurement.drift import Course
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.observation import Observation, Zero
from axiscal.measurement.place import Places
from axiscal.numerics import Array

_ROUNDING = 1e-12
"""A lever of this size is rounding: m/rad, 1, or rad/rad."""


def visited(observation: Observation, places: Places, times: Array | None = None) -> Observation:
    """Return the map with columns for the cells of places that had none, and for how far zeros may have wandered.

    times : (m,) of the readings, s, NaN where nobody looked at a clock
    Columns come in the order of the places; of each its zeros first, then the cells in the order of the functions.
    """
    fresh, cells, courses = _fresh_cells(observation, places), dict(observation.cells), dict(observation.courses)
    size = observation.size
    for i, setup in enumerate(places.setups.tolist()):
        if times is not None and observation.setups[setup].drift > 0 and not np.isnan(times[i]):
            size = _let_wander(observation, courses, setup, float(times[i]), size)
        for cell in fresh.get(i, ()):
            if cell not in cells:
                cells[cell], size = size, size + 1
    if size == observation.size:
        return observation
    return replace(observation, cells=MappingProxyType(cells), courses=MappingProxyType(courses))


def _fresh_cells(observation: Observation, places: Places) -> dict[int, list[Cell]]:
    """Return the cells without a column whose rest shows at each place, by its index; none for most places."""
    fresh = defaultdict[int, list[Cell]](list)
    for setup, mine in places.by_setup() if observation.with_rest else ():
        mounted, poses = observation.setups[setup], places.poses[mine]
        levers = np.max(np.abs(observation.levers(setup, poses)), axis=0)
        sides = np.ones_like(poses)
        for effect in rest_effects(observation.errors, mounted, levers, poses, sides, observation.with_rest):
            open_ones = observation.cell_columns(effect.function)[effect.cells] < 0
            for k in np.flatnonzero(open_ones & (np.abs(effect.reach) > _ROUNDING)):
                fresh[int(mine[k])].append((effect.function, int(effect.cells[k])))
    return fresh


def _let_wander(observation: Observation, courses: dict[Zero, Course], setup: int, time: float, size: int) -> int:
    """Follow the drift of a set-up's zeros to a time, s, in place, and return how many columns there are then."""
    mounted = observation.setups[setup]
    for number in range(INSTRUMENTS[mounted.instrument].values):
        before = courses.get((setup, number))
        if before is None:
            courses[setup, number] = Course.begun(mounted.drift, time, size)
            size += 1
        elif before.needs_node(time):
            courses[setup, number] = before.with_node(time, size)
            size += 2
    return size
