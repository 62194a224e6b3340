"""How zeros have wandered: those that state a drift, and those whose readings move that were repeated at one place.

Only readings that are believed, and of which the side is known, can speak of a drift.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Estimation
from axiscal.measurement.drift import wandering
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array


@dataclass(frozen=True, eq=False, slots=True)
class Path:
    """The way of one zero: at times (k,) s its distance from where it stood at the first reading, m or rad.

    mean, std : (k,) after the readings; prior : (k,) the standard deviation before them
    """

    times: Array
    mean: Array
    std: Array
    prior: Array


def paths(estimation: Estimation, setup: Setup) -> list[Path]:
    """Return the way of each zero of a set-up at the times of its readings; none where no drift is stated."""
    observation, belief = estimation.knowledge.observation, estimation.knowledge.belief
    times = np.array(sorted({r.time for r in estimation.readings if r.setup == setup.name and r.time is not None}))
    found = []
    for (index, _), course in observation.courses.items():
        if observation.setups[index].name == setup.name:
            columns, rows = list(course.columns), course.rows(times)
            std = np.sqrt(np.sum((rows @ belief.factor[columns]) ** 2, axis=1))
            prior = np.sqrt(np.diag(wandering(course.rate, times - times[0])))
            found.append(Path(times, rows @ belief.mean[columns], std, prior))
    return found


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


_FEWEST = 3
"""Readings at one place below which no rate can be told from scatter."""
_MANY = 3
"""Degrees of freedom below which scatter is not told from none."""


class Trend(NamedTuple):
    """How fast repeated readings move, m/s or rad/s, its standard deviation, and over how many seconds; else zeros."""

    rate: float
    std: float
    seconds: float


def trend(readings: Sequence[Reading], setup: Setup) -> Trend:
    """Return how fast the readings of a set-up move that were repeated in one place; two alone do not tell.

    Each place that was read several times gives its own line over time; all share the slope.
    """
    groups: dict[tuple[tuple[float, ...], tuple[int, ...]], list[tuple[float, float]]] = {}
    for reading in readings:
        if reading.setup == setup.name and reading.time is not None:
            groups.setdefault((reading.pose, reading.approach), []).append((reading.time, reading.value))
    repeated = [np.array(group) for group in groups.values() if len(group) > 1]
    if sum(len(group) - 1 for group in repeated) < _FEWEST - 1:
        return Trend(0.0, 0.0, 0.0)
    times = np.concatenate([group[:, 0] for group in repeated])
    centred = np.concatenate([group - group.mean(axis=0) for group in repeated])
    spread = float(centred[:, 0] @ centred[:, 0])
    if spread == 0.0:
        return Trend(0.0, 0.0, 0.0)
    rate = float(centred[:, 0] @ centred[:, 1]) / spread
    left = centred[:, 1] - rate * centred[:, 0]
    degrees = len(left) - len(repeated) - 1
    scatter = float(left @ left) / degrees if degrees > _MANY else 0.0
    return Trend(rate, float(np.sqrt(max(scatter, setup.noise**2) / spread)), float(np.ptp(times)))
