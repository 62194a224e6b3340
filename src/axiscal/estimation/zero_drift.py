"""How zeros have wandered that may."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.estimation.estimation import Estimation
from axiscal.measurement.drift import wandering
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
