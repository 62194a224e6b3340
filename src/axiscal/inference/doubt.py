"""Readings that the others do not believe: found by leaving each out, taken as Student-t instead of normal.

Without reading i the others predict it with mean and variance that follow from the inverse of the covariance K of all
readings: t_i = [K⁻¹y]_i / √[K⁻¹]_ii (Rasmussen and Williams 2006, eq. 5.12). A reading that is surprising beside the
scatter of all t, which it may not widen itself, is down-weighted by the Student-t of `FREEDOM` degrees,
w = (ν+1)/(ν+t²); one that stands out is not used at all. One after the other, the worst first, so that a bad reading
does not cast doubt on its neighbours.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.inference.evidence import Evidence
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array

FREEDOM = 5.0
SURPRISING = 3.0
STANDS_OUT = 4.0
"""So many standard deviations, of what the others predict, are taken for a mistake and not for chance."""
NOTHING = 1e-9
FEWEST = 5
_MOST_PART = 0.2
_ALIKE = 0.9
_WIDENED = 1.25
"""By so much a reading may widen the measure that it is held against."""


class Doubt(NamedTuple):
    """A reading that stands out: its index from 0, standard deviations from what the others predict, and its weight.

    implausible : no error of about the stated size could make it; the standard deviations are then those of the prior
    """

    reading: int
    surprise: float
    weight: float
    implausible: bool = False

    @property
    def rejected(self) -> bool:
        """Whether the reading is not used at all."""
        return self.weight <= NOTHING


def doubts(
    observation: Observation, readings: Sequence[Reading], prior: tuple[Array, Array] | None = None
) -> tuple[Doubt, ...]:
    """Return the readings that stand out, the worst first; readings that somebody vouches for are believed.

    prior : mean and covariance of the errors, where it is not the stated one
    """
    if len(readings) < FEWEST:
        return ()
    evidence = Evidence(observation, readings)
    noise, values = evidence.noise(), evidence.values
    covariance = evidence.covariance() if prior is None else evidence.covariance_under(prior[1])
    if prior is not None:
        values = values - evidence.rows[:, : len(prior[0])] @ prior[0]
    free = np.array([not reading.accepted for reading in readings])
    weights, found = np.ones(len(readings)), list[Doubt]()
    while len(found) < _MOST_PART * len(readings):
        distance = _left_out(covariance, noise, weights[evidence.reading], values)
        surprise = np.zeros(len(readings))
        np.maximum.at(surprise, evidence.reading, np.abs(distance))
        surprise[~free | (weights < 1.0)] = 0.0
        worst = int(np.argmax(surprise))
        without = _WIDENED * _usual_without(worst, evidence.reading, covariance, noise, weights, values)
        surprise /= max(1.0, min(1.4826 * float(np.median(np.abs(distance))), without))
        size = float(surprise[worst])
        if size < SURPRISING or _has_twin(surprise, worst):
            break
        weight = (FREEDOM + 1.0) / (FREEDOM + size**2)
        weights[worst] = NOTHING if size > STANDS_OUT else weight
        found.append(Doubt(worst, size, float(weights[worst])))
    return tuple(found)


def _left_out(covariance: Array, noise: Array, weights: Array, values: Array) -> Array:
    """Return how far each reading is from what the others predict, in standard deviations, (m,), signed."""
    whole = covariance + np.diag(noise * (1.0 / weights - 1.0))
    inverse = np.linalg.inv(whole)
    distance: Array = (inverse @ values) / np.sqrt(np.diag(inverse))
    return distance


def _usual_without(
    worst: int, owners: NDArray[np.intp], covariance: Array, noise: Array, weights: Array, values: Array
) -> float:
    """Return the usual such distance where a reading is not used: the worst one must not widen its own measure."""
    less = weights.copy()
    less[worst] = NOTHING
    distance = np.abs(_left_out(covariance, noise, less[owners], values))
    return 1.4826 * float(np.median(distance[owners != worst]))


def _has_twin(sizes: Array, worst: int) -> bool:
    """Whether another reading stands out as far, so that nobody can say which of the two is wrong."""
    others = np.delete(sizes, worst)
    return bool(len(others)) and float(others.max()) > max(_ALIKE * float(sizes[worst]), SURPRISING)
