"""Whether readings fit better if they were written in another unit: evidence for y, 1000 y and y/1000.

    p(y | f) = f^m p(f y),    averaged over sizes that nobody knows better than roughly

so that a machine that is three times as good, or an instrument five times as noisy, as stated is no other unit. Inches
are not looked for: a machine or a bed 25 times as good as stated exists, and fits no worse.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading, drawn
from axiscal.promise.draws import draws, mode, weighed
from axiscal.promise.problem import Problem, problem
from axiscal.promise.usual import Learnable, sizes_of
from axiscal.promise.which_space import space_of

FACTORS = (1000.0, 1 / 1000.0)
"""By definition: mm for um, and back."""
_CERTAIN = 6.0
_FEWEST, _MOST = 4, 60
"""Readings below which no unit can be told, and above which more only take time."""
_LEAST_FIT = 0.05
"""Readings whose mean square is less of what is expected than this are no readings."""


class OtherUnit(NamedTuple):
    """Readings of a set-up that fit when multiplied by a factor; odds : powers of ten."""

    setup: str
    factor: float
    odds: float


def other_unit(observation: Observation, readings: Sequence[Reading]) -> OtherUnit | None:
    """Return the set-up whose readings are written in another unit by odds of a million; None for none."""
    for setup in observation.setups:
        mine = drawn([reading for reading in readings if reading.setup == setup.name], _MOST)
        if len(mine) < _FEWEST or any(reading.std is not None for reading in mine):
            continue
        sizes = sizes_of(observation.machine, observation.setups, Learnable("roughly", usual=True, inherited=False))
        posed = problem(observation, mine, sizes)
        if _LEAST_FIT < _square(posed) < 1 / _LEAST_FIT:
            continue  # too good a noise, or a file that was copied, is no other unit
        stated = _log_evidence(posed)
        odds = {factor: (_multiplied(posed, factor) - stated) / np.log(10.0) for factor in FACTORS}
        best = max(odds, key=lambda factor: odds[factor])
        if odds[best] > _CERTAIN:
            return OtherUnit(setup.name, best, float(odds[best]))
    return None


def _multiplied(posed: Problem, factor: float) -> float:
    """Return log p of the readings if f times their values are right; minus infinity if these would be nothing."""
    other = replace(posed, values=factor * posed.values)
    if _square(other) < _LEAST_FIT:
        return -np.inf
    return _log_evidence(other) + len(other.values) * float(np.log(factor))


def _square(posed: Problem) -> float:
    """Return the mean square of readings over what is expected of them with sizes as stated."""
    stated = space_of(posed).given(np.zeros(len(posed.sizes)))
    if stated is None:
        return np.inf
    return float(posed.values @ stated.precision(posed.values[:, None])[:, 0]) / len(posed.values)


def _log_evidence(posed: Problem) -> float:
    """Return log p(y), the sizes averaged over."""
    space = space_of(posed)
    return weighed(space, draws(space, mode(space))).log_evidence
