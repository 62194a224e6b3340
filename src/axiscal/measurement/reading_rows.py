"""The rows of many readings, of set-ups mixed as they come: all numbers of all of them, one after another."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.cells import Cell
from axiscal.measurement.observation import Observation, directions_of
from axiscal.measurement.place import Place, Places
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.measurement.visits import visited
from axiscal.numerics import Array


class PlaceRows(NamedTuple):
    """All numbers of readings at places.

    rows : (m, size) over all unknowns; variances : (m,) noise and the rests of cells not visited yet, m² or rad²
    place : (m,) index of the place that each number belongs to, ascending
    """

    rows: Array
    variances: Array
    place: NDArray[np.intp]


class Seen(NamedTuple):
    """All numbers of readings.

    rows : (m, size); variances : (m,); values : (m,), what is not linear taken off
    reading : (m,) index of the reading that each number belongs to, ascending
    """

    rows: Array
    variances: Array
    values: Array
    reading: NDArray[np.intp]


def rows_at(observation: Observation, places: Places, times: Array | None = None) -> PlaceRows:
    """Return what readings at places would tell, cells without columns as noise.

    times : (m,) of the readings, s; without them, or where one is NaN, the last time that was met
    """
    each = numbers_of_setups(observation.setups)[places.setups]
    first, count = np.cumsum(each) - each, int(each.sum())
    rows, variances = np.zeros((count, observation.size)), np.zeros(count)
    for setup, mine in places.by_setup():
        poses, approaches = places.poses[mine], places.approaches[mine]
        when = None if times is None else times[mine]
        for number, part in enumerate(observation.rows_each(setup, poses, approaches, when)):
            rows[first[mine] + number], variances[first[mine] + number] = part
    return PlaceRows(rows, variances, np.repeat(np.arange(len(places)), each))


def seen(observation: Observation, readings: Sequence[Reading]) -> Seen:
    """Return what readings tell, of cells that are visited or not."""
    places = places_of(observation.setups, readings)
    found = rows_at(observation, places, times_of(readings))
    usual = np.array([setup.noise**2 for setup in observation.setups])[places.setups]
    own = np.array([0.0 if r.std is None else r.std**2 - noise for r, noise in zip(readings, usual, strict=True)])
    values = linear_values(observation, places, readings)
    return Seen(found.rows, found.variances + own[found.place], values, found.place)


def linear_values(observation: Observation, places: Places, readings: Sequence[Reading]) -> Array:
    """Return the values of all numbers of readings, what is not linear in the unknowns taken off, (m,)."""
    beside = [np.zeros(0)] * len(places)
    for setup, mine in places.by_setup():
        parts = observation.nonlinear_part(setup, places.poses[mine], places.approaches[mine])
        for index, part in zip(np.arange(len(places))[mine], parts, strict=True):
            beside[index] = part
    return np.concatenate(
        [np.array(r.values) - part for r, part in zip(readings, beside, strict=True)] or [np.zeros(0)]
    )


def shown_values(observation: Observation, readings: Sequence[Reading], point: Array) -> Array:
    """Return what readings show by the exact chain without noise, (m,).  point : (k,) errors, then unknowns"""
    shown: Array = shown_by_each(observation, readings, point[None])[0]
    return shown


def shown_by_each(observation: Observation, readings: Sequence[Reading], points: Array) -> Array:
    """Return the same for each of many machines and set-ups, (n, m).  points : (n, k) errors, then unknowns"""
    places = places_of(observation.setups, readings)
    each = numbers_of_setups(observation.setups)[places.setups]
    first, result = np.cumsum(each) - each, np.zeros((len(points), int(each.sum())))
    for setup, mine in places.by_setup():
        shown = observation.shown_by_each(setup, places.poses[mine], places.approaches[mine], points)
        for values, one in zip(result, shown, strict=True):
            for number in range(one.shape[1]):
                values[first[mine] + number] = one[:, number]
    return result


def visited_by(
    observation: Observation, readings: Sequence[Reading], among: Collection[Cell] | None = None
) -> Observation:
    """Return the map with columns for what comes with readings: cells, and how far zeros have wandered.

    among : cells that may have a column, None for all
    """
    return visited(observation, places_of(observation.setups, readings), times_of(readings), among)


def places_of(setups: Sequence[Setup], readings: Sequence[Reading]) -> Places:
    """Return where readings were taken."""
    names = {setup.name: index for index, setup in enumerate(setups)}
    axes = len(setups[0].park) if setups else 0
    poses = np.array([reading.pose for reading in readings], dtype=float).reshape(-1, axes)
    approaches = np.array([reading.approach for reading in readings], dtype=float).reshape(-1, axes)
    return Places(np.array([names[reading.setup] for reading in readings], dtype=np.intp), poses, approaches)


def blank_readings(setups: Sequence[Setup], places: Sequence[Place]) -> list[Reading]:
    """Return readings of zero at places, for results that do not depend on their values."""
    more = {setup.name: len(directions_of(setup)) - 1 for setup in setups}
    return [Reading(p.setup, p.pose, p.approach, 0.0, others=(0.0,) * more[p.setup]) for p in places]


def times_of(readings: Sequence[Reading]) -> Array:
    """Return when readings were taken, (m,) s; NaN where nobody looked at a clock."""
    return np.array([np.nan if reading.time is None else reading.time for reading in readings])


def numbers_of_setups(setups: Sequence[Setup]) -> NDArray[np.intp]:
    """Return how many numbers a reading of each set-up has, (setups,)."""
    return np.array([len(directions_of(setup)) for setup in setups], dtype=np.intp)
