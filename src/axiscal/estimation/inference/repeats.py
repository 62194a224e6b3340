"""Drift that nobody stated, seen in readings that were repeated at one place: how fast they move."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup

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
