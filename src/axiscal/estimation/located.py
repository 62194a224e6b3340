"""Fourth stage: where the stations stand that distances are read to, and about which machine readings are linear."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from axiscal.estimation.absorbed import Absorbed, absorbed
from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.stations import GAUSSIAN, indices
from axiscal.measurement.reading import Reading, drawn
from axiscal.measurement.reading_rows import linear_values, places_of, seen
from axiscal.numerics import Array
from axiscal.numerics.threads import one_thread

_ROUNDS = 12
_LINEAR = 1e-2
"""RMS over all directions, in σ, of what the exact machine would change: less is not worth a second round."""


def located(case: Case, readings: Sequence[Reading], left_out: Collection[int] = ()) -> Absorbed:
    """Return what readings make known, linearised about the machine and the stations that they show until these stay.

    A distance is linear about the assumed place of its station, so a better place makes a better estimate. Large errors
    of the machine also separate the exact chain from its rows. A round that asks for more than the one before goes half
    as far, and so do those after it: else the rounds would swing.
    case : with the sizes as learnt; left_out : indices of readings that do not count
    """
    return _followed(absorbed(case, readings, left_out), readings, turned=False)


def bent(known: Absorbed, readings: Sequence[Reading]) -> Absorbed:
    """Return what is known with rows taken at the machine as it is believed, where those of the nominal one mislead."""
    about = known.case.about
    if about is None or float(np.max(indices(known.knowledge, readings), initial=0.0)) <= GAUSSIAN:
        return known
    return _followed(known, readings, turned=True)


def _followed(known: Absorbed, readings: Sequence[Reading], *, turned: bool) -> Absorbed:
    """Return what is known once readings are linearised about what they show.  turned : rows are taken there, too"""
    share, last = 1.0, np.inf
    for _ in range(_ROUNDS):
        mean, about = known.knowledge.belief.mean, known.case.about
        asked = moved_by(known, readings, known.case.linear_about(mean, turned))
        share, last = (share / 2 if asked > last else share), asked
        there = about is not None and about.bent == turned
        if asked < (SETTLED if there else 0.0 if turned else _LINEAR):
            better = None if turned else known.case.located(mean)
        else:
            better = known.case.linear_about(_towards(known.case, mean, share), turned)
        if better is None:
            break
        known = absorbed(better, readings, known.left_out)
    return known


def _towards(case: Case, mean: Array, share: float) -> Array:
    """Return a mean that is a share of the way from where readings are linearised now.  mean : (size,)"""
    count = case.errors.size + len(case.observation.unknowns)
    start = np.zeros(count) if case.about is None else case.about.point
    result = mean.copy()
    result[:count] = start + share * (mean[:count] - start)
    return result


def moved_by(known: Absorbed, readings: Sequence[Reading], better: Case) -> float:
    """Return by how much the mean moves when readings are linearised elsewhere, in σ, RMS over all directions.

    known : after readings as they are linearised now
    With S Sᵀ the covariance it is ‖Sᵀ Hᵀ R⁻¹ Δe‖/√N, and never more than ‖Δe/σ‖/√N.
    """
    if not readings:
        return 0.0
    observation, belief = known.knowledge.observation, known.knowledge.belief
    numbers, there = seen(observation, readings), replace(observation, about=better.about)
    change = numbers.values - linear_values(there, places_of(observation.setups, readings), readings)
    trust = known.precisions(numbers)
    if float(np.sqrt(np.sum(trust * change**2) / belief.size)) < SETTLED:
        return 0.0
    pulled = belief.factor.T @ (numbers.rows.T @ (trust * change))
    return float(np.sqrt(np.mean(pulled**2)))


SETTLED = 1e-3
"""RMS of the change over all directions, in σ, at which rounds end."""


_MOST = 200
"""Readings whose index is looked for: of time; drawn, they are the worst one or are like it."""
_ROUNDING = 1e-9
"""Of the noise: what is less is rounding."""


class Linearity(NamedTuple):
    """largest : the largest ν of a reading; reading : its number, None where nothing was read"""

    largest: float
    reading: int | None

    @property
    def gaussian(self) -> bool:
        """Whether the belief is the posterior to the digits printed."""
        return self.largest <= GAUSSIAN


@one_thread()
def linearity(estimation: Estimation) -> Linearity:
    """Return how linear the readings are, of many those of some."""
    some = drawn(estimation.readings, _MOST)
    if not some:
        return Linearity(0.0, None)
    found = indices(estimation.absorbed.knowledge, some)
    worst, largest = some[int(np.argmax(found))], float(found.max())
    return Linearity(largest if largest > _ROUNDING else 0.0, worst.numbered(estimation.readings.index(worst)))
