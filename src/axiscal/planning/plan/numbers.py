"""What readings at places would tell, as numbers of the core."""

from __future__ import annotations

import numpy as np

from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.measurement.reading_rows import rows_at
from axiscal.numerics import Array
from axiscal_core.model import Numbers


def numbers_at(observation: Observation, places: Places) -> Numbers:
    """Return all numbers of readings; rests of cells that have a column already stand in their rows.

    Of a reading on several feet each error has as many columns of rests, one block behind the other.
    """
    rows, variances, place = rows_at(observation, places)
    part, rested = np.arange(len(place)) - np.searchsorted(place, place), list(observation.with_rest)
    effects = [(mine, observation.rest_effects(setup, *_at(places, mine))) for setup, mine in places.by_setup()]
    feet = max((np.count_nonzero(seen.functions == f) for _, seen in effects for f in seen.functions[:1]), default=1)
    reach, cell = np.zeros((len(rows), feet * len(rested))), np.zeros((len(rows), feet * len(rested)), dtype=np.intp)
    for mine, seen in effects if rested else ():
        standing = np.count_nonzero(seen.functions == seen.functions[0]) if len(seen.functions) else 1
        column = np.searchsorted(rested, seen.functions) + len(rested) * (np.arange(len(seen.functions)) % standing)
        fresh = (observation.cell_columns.visited(seen) < 0).T
        for number, each in enumerate(seen.reach):
            at = np.ix_(np.searchsorted(place, mine) + number, column)
            reach[at], cell[at] = each.T * fresh, seen.cells.T
    variances = variances - np.sum((reach * np.tile(rests_of(observation), feet)) ** 2, axis=1)
    setup = places.setups[place]
    noise, nought = np.sqrt(np.maximum(variances, 0.0)), np.zeros((len(rows), 1))
    return Numbers(rows, nought[:, 0], reach, cell, noise, place, setup, part, nought[:, :0])


def rests_of(observation: Observation) -> Array:
    """Return the standard deviations of the rests of errors that have one, (e,)."""
    return np.array([observation.errors.terms[i].rest for i in observation.with_rest])


def _at(places: Places, mine: np.ndarray) -> tuple[Array, Array]:
    return places.poses[mine], places.approaches[mine]
