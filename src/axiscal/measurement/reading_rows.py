"""Many readings, of set-ups mixed as they come: all numbers of all of them, one after another.

With readings come unknowns: the rests of cells that they are the first to lie in.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.observation import Cell, Observation, RestEffects
from axiscal.measurement.reading import Place, Places, Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array

_ROUNDING = 1e-12
"""A lever of this size is rounding: m/rad, 1, or rad/rad."""


def visited(observation: Observation, places: Places) -> Observation:
    """Return the map with columns for the cells of places that had none.

    Columns come in the order of the places; of each in the order of the functions.
    """
    fresh = _fresh_cells(observation, places)
    return with_cells(observation, [cell for place in sorted(fresh) for cell in fresh[place]])


def with_cells(observation: Observation, visited: Iterable[Cell]) -> Observation:
    """Return the map with columns for those of some cells that had none, in their order."""
    fresh = dict.fromkeys(cell for cell in visited if cell not in observation.cells)
    columns = {cell: column for column, cell in enumerate(fresh, start=observation.size)}
    return replace(observation, cells={**observation.cells, **columns}) if fresh else observation


def cells_shown(observation: Observation, setup: int, poses: Array) -> RestEffects:
    """Return in which cells readings of a set-up are, and what a unit of their rests does to a number at most.

    poses : (m, q)
    """
    found = observation.rest_effects(setup, poses)
    reach = np.abs(found.reach)
    return found._replace(reach=np.where(reach > _ROUNDING, reach, 0.0))


def _fresh_cells(observation: Observation, places: Places) -> dict[int, list[Cell]]:
    """Return the cells without a column whose rest shows at each place, by its index; none for most places."""
    fresh = defaultdict[int, list[Cell]](list)
    for setup, mine in places.by_setup() if observation.with_rest else ():
        shown = cells_shown(observation, setup, places.poses[mine])
        without = observation.columns_of(shown.functions[:, None], shown.cells) < 0
        where, which = np.nonzero((without & (shown.reach > 0)).T)
        cells = zip(shown.functions[which].tolist(), shown.cells[which, where].tolist(), strict=True)
        for place, cell in zip(mine[where].tolist(), cells, strict=True):
            fresh[place].append(cell)
    return fresh


class PlaceRows(NamedTuple):
    """All numbers of readings at places.

    rows : (m, size) over all unknowns; variances : (m,) noise and the rests of cells not visited yet, m² or rad²
    place : (m,) index of the place that each number belongs to, ascending
    """

    rows: Array
    variances: Array
    place: NDArray[np.intp]


def rows_at(observation: Observation, places: Places) -> PlaceRows:
    """Return what readings at places would tell, cells without columns as noise."""
    found = observation.numbers(places)
    return PlaceRows(found.rows, observation.variances(found), found.place)


class Seen(NamedTuple):
    """All numbers of readings.

    rows : (m, size); variances : (m,); values : (m,), what is not linear taken off
    reading : (m,) index of the reading that each number belongs to, ascending
    """

    rows: Array
    variances: Array
    values: Array
    reading: NDArray[np.intp]


def seen(observation: Observation, readings: Sequence[Reading]) -> Seen:
    """Return what readings tell, of cells that are visited or not."""
    places = places_of(observation.setups, readings)
    found = rows_at(observation, places)
    usual = np.array([setup.noise**2 for setup in observation.setups])[places.setups]
    own = np.array([0.0 if r.std is None else r.std**2 - noise for r, noise in zip(readings, usual, strict=True)])
    values = linear_values(observation, places, readings)
    return Seen(found.rows, found.variances + own[found.place], values, found.place)


def linear_values(observation: Observation, places: Places, readings: Sequence[Reading]) -> Array:
    """Return the values of all numbers of readings, what is not linear in the unknowns taken off, (m,)."""
    each = observation.counts[places.setups]
    values, first = scaled_values(observation.setups, readings), np.cumsum(each) - each
    for setup, mine in places.by_setup():
        to = first[mine][:, None] + np.arange(observation.counts[setup])
        values[to] -= observation.nonlinear_part(setup, places.poses[mine], places.approaches[mine])
    return values


def scaled_values(setups: Sequence[Setup], readings: Sequence[Reading]) -> Array:
    """Return the values of all numbers of readings as rows have them, (m,)."""
    scales = {setup.name: setup.scales for setup in setups}
    return np.concatenate([np.array(r.values) * scales[r.setup] for r in readings] or [np.zeros(0)])


def shown_by_each(observation: Observation, readings: Sequence[Reading], points: Array) -> Array:
    """Return what readings show by the exact chain without noise, of each of many machines and set-ups, (n, m).

    points : (n, k) errors, then unknowns
    """
    places = places_of(observation.setups, readings)
    each = observation.counts[places.setups]
    first, result = np.cumsum(each) - each, np.zeros((len(points), int(each.sum())))
    for setup, mine in places.by_setup():
        to = first[mine][:, None] + np.arange(observation.counts[setup])
        shown = observation.shown_by_each(setup, places.poses[mine], places.approaches[mine], points)
        for values, one in zip(result, shown, strict=True):
            values[to] = one
    return result


def places_of(setups: Sequence[Setup], readings: Sequence[Reading | Place]) -> Places:
    """Return where readings were taken, or are to be."""
    names = {setup.name: index for index, setup in enumerate(setups)}
    axes = len(setups[0].park) if setups else 0
    poses = np.array([reading.pose for reading in readings], dtype=float).reshape(-1, axes)
    approaches = np.array([reading.approach for reading in readings], dtype=float).reshape(-1, axes)
    return Places(np.array([names[reading.setup] for reading in readings], dtype=np.intp), poses, approaches)


def blank_readings(setups: Sequence[Setup], places: Sequence[Place]) -> list[Reading]:
    """Return readings of zero at places, for results that do not depend on their values."""
    more = {setup.name: len(setup.names) - 1 for setup in setups}
    return [Reading(p.setup, p.pose, p.approach, 0.0, others=(0.0,) * more[p.setup], check=p.check) for p in places]


def times_of(readings: Sequence[Reading]) -> Array:
    """Return when readings were taken, (m,) s; NaN where nobody looked at a clock."""
    return np.array([np.nan if reading.time is None else reading.time for reading in readings])
