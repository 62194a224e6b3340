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

from axiscal.description.usual import Learnable, sizes_of
from axiscal.estimation.promise.draws import Weighed, draws, mode, weighed
from axiscal.estimation.promise.problem import Problem, problem
from axiscal.estimation.promise.unknowns import space_of
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading, drawn

FACTORS = (1000.0, 1 / 1000.0)
"""By definition: mm for um, and back."""
_CERTAIN = 6.0
_FEWEST, _MOST = 4, 60
"""Readings below which no unit can be told, and above which more only take time."""
_LEAST_FIT = 0.05
"""Readings that scatter by less of what is expected than this, multiplied, are no readings."""
_FARTHEST = float(np.log(1000.0)) / 2
"""Logarithm of what errors or noise may be beside what is stated, multiplied: what is nearer to it as written stays."""


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
        stated = _weighed(posed).log_evidence
        odds = {factor: (_multiplied(posed, factor) - stated) / np.log(10.0) for factor in FACTORS}
        best = max(odds, key=lambda factor: odds[factor])
        if odds[best] > _CERTAIN:
            return OtherUnit(setup.name, best, float(odds[best]))
    return None


def _multiplied(posed: Problem, factor: float) -> float:
    """Return log p of the readings if f times their values are right; minus infinity if these would be nothing."""
    other = replace(posed, values=factor * posed.values)
    stated = space_of(other).given(np.zeros(len(posed.sizes)))
    if stated is not None and stated.square < _LEAST_FIT * len(other.values):
        return -np.inf
    found = _weighed(other)
    told = [index for index, size in enumerate(posed.sizes.of) if size.kind in ("std", "reversal", "noise")]
    if np.max(np.abs(found.weights @ found.thetas)[told]) > _FARTHEST:
        return -np.inf
    return found.log_evidence + len(posed.values) * float(np.log(factor))


def _weighed(posed: Problem) -> Weighed:
    """Return draws of the sizes with their evidence, log p(y)."""
    space = space_of(posed)
    return weighed(space, draws(space, mode(space)))
