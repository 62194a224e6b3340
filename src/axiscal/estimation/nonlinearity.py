"""Whether readings are linear enough: what a better place to linearise about changes, and the index of each reading.

With J the rows in use and z standard normal the second order of reading i is

    r_i = f_i(m + F z) − f_i(m) − J_i F z,    ν_i = √(E r_i²)/σ_i

m, F Fᵀ mean and covariance of the belief. Where no ν_i is above 0.3 the belief is the posterior to the digits printed
(by importance sampling on seven cases: mean shift below 0.05 σ up to ν = 0.26).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from axiscal.estimation.absorbed import Absorbed
from axiscal.estimation.case import Case
from axiscal.measurement.about import About
from axiscal.measurement.observation import Observation
from axiscal.measurement.place import Places
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import linear_values, places_of, seen, shown_by_each
from axiscal.numerics import Array
from axiscal.numerics.remembered import remembered

GAUSSIAN = 0.3
"""Below, the Gaussian is the posterior to the digits printed."""
_DRAWS, _SEED = 64, 20260101
"""Draws tell a root mean square within a tenth; the seed is any."""


def moved_by(known: Absorbed, readings: Sequence[Reading], weights: Array, better: Case) -> float:
    """Return by how much the mean moves when readings are linearised elsewhere, in σ, RMS over all directions.

    known : after readings as they are linearised now; weights : (readings,) how much each counts
    With S Sᵀ the covariance it is ‖Sᵀ Hᵀ R⁻¹ Δe‖/√N, and never more than ‖Δe/σ‖/√N.
    """
    observation, belief = known.knowledge.observation, known.knowledge.belief
    places = places_of(observation.setups, readings)
    change = _values(observation, places, readings, known.case.about) - _values(
        observation, places, readings, better.about
    )
    numbers = seen(observation, readings)
    trust = weights[numbers.reading] / numbers.variances
    if float(np.sqrt(np.sum(trust * change**2) / belief.size)) < SETTLED:
        return 0.0
    pulled = belief.factor.T @ (numbers.rows.T @ (trust * change))
    return float(np.sqrt(np.mean(pulled**2)))


SETTLED = 1e-3
"""RMS of the change over all directions, in σ, at which rounds end."""


def _values(observation: Observation, places: Places, readings: Sequence[Reading], about: About | None) -> Array:
    return linear_values(replace(observation, about=about), places, readings)


def indices(known: Absorbed, readings: Sequence[Reading]) -> Array:
    """Return the index ν of each reading, the largest of its numbers, (readings,)."""
    return _indices(known, tuple(readings))


@remembered
def _indices(known: Absorbed, readings: tuple[Reading, ...]) -> Array:
    """Return the same: where rows bend is asked while estimating, and again for the report."""
    observation, belief = known.knowledge.observation, known.knowledge.belief
    if not readings:
        return np.zeros(0)
    numbers = seen(observation, readings)
    errors = observation.errors.size + len(observation.unknowns)
    drawn = belief.factor[:errors] @ np.random.default_rng(_SEED).standard_normal((belief.size, _DRAWS))
    mean = belief.mean[:errors]
    shown = shown_by_each(observation, readings, np.vstack([mean, mean + drawn.T]))
    beyond = shown[1:] - shown[0] - (numbers.rows[:, :errors] @ drawn).T
    index = np.sqrt(np.sum(beyond**2, axis=0) / _DRAWS) / np.sqrt(numbers.variances)
    return np.maximum.reduceat(index, np.searchsorted(numbers.reading, np.arange(len(readings))))
