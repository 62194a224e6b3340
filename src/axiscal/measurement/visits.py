"""Which unknowns come with readings: the rests of cells that they are the first to lie in, and how zeros wander."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from axiscal.measurement.cells import Cell, RestEffects, rest_effects
from axiscal.measurement.drift import Course
from axiscal.measurement.instrument import values_of
from axiscal.measurement.observation import Observation, Zero
from axiscal.measurement.place import Places
from axiscal.numerics import Array

_ROUNDING = 1e-12
"""A lever of this size is rounding: m/rad, 1, or rad/rad."""


def visited(
    observation: Observation, places: Places, times: Array | None = None, among: Collection[Cell] | None = None
) -> Observation:
    """Return the map with columns for the cells of places that had none, and for how far zeros may have wandered.

    times : (m,) of the readings, s, NaN where nobody looked at a clock; among : cells that may have one, None for all
    Columns come in the order of the places; of each its zeros first, then the cells in the order of the functions.
    """
    fresh, cells, courses = _fresh_cells(observation, places, among), dict(observation.cells), dict(observation.courses)
    size = observation.size
    for i, setup in enumerate(places.setups.tolist()):
        if times is not None and observation.setups[setup].drift > 0 and not np.isnan(times[i]):
            size = _let_wander(observation, courses, setup, float(times[i]), size)
        size = _let_in(cells, fresh.get(i, ()), size)
    if size == observation.size:
        return observation
    return replace(observation, cells=MappingProxyType(cells), courses=MappingProxyType(courses))


def with_cells(observation: Observation, visited: Iterable[Cell]) -> Observation:
    """Return the map with columns for those of some cells that had none, in their order."""
    cells = dict(observation.cells)
    if _let_in(cells, visited, observation.size) == observation.size:
        return observation
    return replace(observation, cells=MappingProxyType(cells))


def _let_in(cells: dict[Cell, int], visited: Iterable[Cell], size: int) -> int:
    """Give cells that have none a column, in place, and return how many columns there are then."""
    for cell in visited:
        if cell not in cells:
            cells[cell], size = size, size + 1
    return size


def cells_shown(observation: Observation, setup: int, poses: Array) -> RestEffects:
    """Return in which cells readings of a set-up are, and what a unit of their rests does to a number at most.

    poses : (m, q)
    """
    levers = np.max(np.abs(observation.levers(setup, poses)), axis=0)
    mounted, sides = observation.setups[setup], np.ones_like(poses)
    found = rest_effects(observation.errors, mounted, levers, poses, sides, observation.with_rest)
    reach = np.abs(found.reach)
    return found._replace(reach=np.where(reach > _ROUNDING, reach, 0.0))


def _fresh_cells(observation: Observation, places: Places, among: Collection[Cell] | None) -> dict[int, list[Cell]]:
    """Return the cells without a column whose rest shows at each place, by its index; none for most places."""
    fresh = defaultdict[int, list[Cell]](list)
    for setup, mine in places.by_setup() if observation.with_rest else ():
        shown = cells_shown(observation, setup, places.poses[mine])
        where, which = np.nonzero(((observation.cell_columns.at(shown) < 0) & (shown.reach > 0)).T)
        cells = zip(shown.functions[which].tolist(), shown.cells[which, where].tolist(), strict=True)
        for place, cell in zip(mine[where].tolist(), cells, strict=True):
            if among is None or cell in among:
                fresh[place].append(cell)
    return fresh


def _let_wander(observation: Observation, courses: dict[Zero, Course], setup: int, time: float, size: int) -> int:
    """Follow the drift of a set-up's zeros to a time, s, in place, and return how many columns there are then."""
    mounted = observation.setups[setup]
    for number in range(values_of(mounted)):
        before = courses.get((setup, number))
        if before is None:
            courses[setup, number] = Course.begun(mounted.drift, time, size)
            size += 1
        elif before.needs_node(time):
            courses[setup, number] = before.with_node(time, size)
            size += 2
    return size
