"""What a promise rests on that somebody stated as noise and that might as well be the machine: nothing is read twice.

Where no two readings of a set-up share a place, a rest of the machine (what no spline follows, from place to place)
and the noise σ do the same to them: K is the same with σ² of either. A rest that is to be learnt is then what is left
beside a noise that was only stated. Were all of the noise the machine's, the estimate would be the same, and the truth

    truth² = promise² + L σ²/g²,   g² the mean square of what a unit of the rest adds to a reading,   L its mean square
                                   over the volume at the tool point

of which error of those that can hold it does least. The promise is κ times too good below √(L/(κ² − 1)) σ/g, and is
not vouched for there. Readings at a place that was read before tell noise from machine: n of them know the logarithm of
a noise to 1/√(2 n), which from three on is less than what is left open about one that was stated (`SPREADS`).
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.accuracy.damage import KAPPA
from axiscal.accuracy.yardstick import Yardstick
from axiscal.estimation.case import Case
from axiscal.inference.reading_set import ErrorPart, ReadingSet
from axiscal.machine.description import Machine
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading

ENOUGH = 3
"""Readings at places that were read before from which they tell more of a noise than what was stated of it does."""


@dataclass(frozen=True, slots=True)
class Scatter:
    """Noise that readings do not tell from a rest of the machine.

    setup : its index; std : as it counts, m or rad; lacking : how many readings once more would tell
    effect : m, RMS over the volume if all of it were the machine's
    """

    setup: int
    std: float
    lacking: int
    effect: float

    @property
    def bearable(self) -> float:
        """The least promise that bears it, m."""
        return self.effect / math.sqrt(KAPPA**2 - 1)


def scattered(
    observation: Observation,
    readings: Sequence[Reading],
    numbers: ReadingSet,
    yardstick: Yardstick,
    open_rests: Collection[str],
) -> Scatter | None:
    """Return the noise that would do most if it were the machine's; None where readings tell, or no rest is learnt.

    readings : all that there are; numbers : of these, or of some drawn from them
    open_rests : names of errors whose rest is to be learnt
    """
    parts = [part for part in numbers.parts() if part.term.name in open_rests]
    found = list(_each(observation, readings, numbers, (parts, yardstick))) if parts else []
    return max(found, key=lambda each: each.effect, default=None)


def open_rests(case: Case, stated: Machine) -> set[str]:
    """Return the errors whose rest is to be learnt.  stated : the machine before scales were learnt"""
    every = case.description.scales_estimated
    curves = {each.name for each in stated.errors if every or each.rest_estimated}
    return curves | {each.name for each in stated.planes if every or each.rest_estimated}


def _each(
    observation: Observation,
    readings: Sequence[Reading],
    numbers: ReadingSet,
    within: tuple[list[ErrorPart], Yardstick],
) -> Iterator[Scatter]:
    parts, yardstick = within
    shown = _places(numbers.reading, parts)
    for index, setup in enumerate(observation.setups):
        own = numbers.setups == index
        if not own.any():
            continue
        mine = np.unique(numbers.reading[own])
        places = [reading.place for reading in readings if reading.setup == setup.name]
        again = max(len(mine) - len(np.unique(shown[mine], axis=0)), len(places) - len(set(places)))
        variance = float(np.mean(numbers.noise[own]))
        most = [variance * each for part in parts if (each := _reach(part, own, yardstick)) > 0]
        if most and again < ENOUGH:
            yield Scatter(index, math.sqrt(variance), ENOUGH - again, math.sqrt(min(most)))


def _places(reading: NDArray[np.intp], parts: Sequence[ErrorPart]) -> NDArray[np.bool_]:
    """Return in which cells each reading is, (n, cells)."""
    cells = np.hstack([part.shared != 0 for part in parts])
    result = np.zeros((int(reading.max()) + 1, cells.shape[1]), dtype=bool)
    np.logical_or.at(result, reading, cells)
    return result


def _reach(part: ErrorPart, own: NDArray[np.bool_], yardstick: Yardstick) -> float:
    """Return L/g² of an error for the numbers of a set-up, 0 where its rest does not show in them."""
    felt = float(np.mean(np.sum(part.shared[own] ** 2, axis=1)))
    return yardstick.moments.levers[part.term.name] / felt if felt > 0 else 0.0
