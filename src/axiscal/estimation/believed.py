"""The readings of an estimation that are believed, and those of them that can speak of a drift."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Estimation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array

_OF_NOTE = 0.1
"""Standard deviations of the noise of a reading: less, in a hundred readings at once, is one of their mean."""


def trusted(estimation: Estimation) -> list[Reading]:
    """Return the readings that are believed."""
    return [reading for index, reading in enumerate(estimation.readings) if index not in estimation.left_out]


def with_sides(estimation: Estimation) -> list[Reading]:
    """Return those of them to which a side that nobody told does nothing of note: a reversal is no drift."""
    return sides_told(trusted(estimation), estimation.stated)


def sides_told(readings: Sequence[Reading], case: Case) -> list[Reading]:
    """Return the readings which unknown sides leave as they are, but for a tenth of their noise.

    The effect of a reversal on the reading counts. An axis that stands while a bar goes round has no side. An axis that
    turns there, or that both sides of a probe even out, shows none.
    """
    told = np.ones(len(readings), dtype=bool)
    for index, setup in enumerate(case.description.setups):
        mine = [at for at, reading in enumerate(readings) if reading.setup == setup.name]
        if mine:
            poses: Array = np.array([readings[at].pose for at in mine], dtype=np.float64)
            sides: Array = np.array([readings[at].approach for at in mine], dtype=np.float64)
            added = case.observation.unknown_sides(index, poses, sides).max(axis=0)
            noise = np.array([setup.noise if (std := readings[at].std) is None else std for at in mine])
            told[mine] = added <= (_OF_NOTE * noise) ** 2
    return [reading for reading, known in zip(readings, told.tolist(), strict=True) if known]
