"""Many readings, of set-ups mixed as they come: all numbers of all of them, one after another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Place, Places, Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal_core.model import Numbers


def seen(observation: Observation, readings: Sequence[Reading]) -> tuple[Numbers, Array]:
    """Return what readings tell, and the values of all numbers, what is not linear in the unknowns taken off, (m,)."""
    places = places_of(observation.setups, readings)
    found = observation.numbers(places)
    usual = np.array([setup.noise**2 for setup in observation.setups])[places.setups]
    own = np.array([0.0 if r.std is None else r.std**2 - noise for r, noise in zip(readings, usual, strict=True)])
    found = found._replace(noise=np.sqrt(found.noise**2 + own[found.place]))
    return found, linear_values(observation, places, readings)


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


def places_of(setups: Sequence[Setup], readings: Sequence[Place]) -> Places:
    """Return where readings were taken, or are to be."""
    names = {setup.name: index for index, setup in enumerate(setups)}
    axes = len(setups[0].park) if setups else 0
    poses = np.array([reading.pose for reading in readings], dtype=float).reshape(-1, axes)
    approaches = np.array([reading.approach for reading in readings], dtype=float).reshape(-1, axes)
    return Places(np.array([names[reading.setup] for reading in readings], dtype=np.intp), poses, approaches)


def blank_readings(setups: Sequence[Setup], places: Sequence[Place]) -> list[Reading]:
    """Return readings of zero at places, for results that do not depend on their values."""
    more = {setup.name: len(setup.names) - 1 for setup in setups}
    return [Reading(p.setup, p.pose, p.approach, others=(0.0,) * more[p.setup], check=p.check) for p in places]


def times_of(readings: Sequence[Reading]) -> Array:
    """Return when readings were taken, (m,) s; NaN where nobody looked at a clock."""
    return np.array([np.nan if reading.time is None else reading.time for reading in readings])
