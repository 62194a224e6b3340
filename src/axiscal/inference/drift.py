"""Drift while measuring, seen in readings that were repeated at one place: by how much a reading moves per reading."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup


def drift(readings: Sequence[Reading], setup: Setup) -> tuple[float, float]:
    """Return the drift per reading in a set-up and its standard deviation, m or rad; zeros without repeats.

    Each place that was read several times gives its own line over the number of the reading; all share the slope.
    """
    groups: dict[tuple[tuple[float, ...], tuple[int, ...]], list[tuple[float, float]]] = {}
    for number, reading in enumerate(readings):
        if reading.setup == setup.name:
            groups.setdefault((reading.pose, reading.approach), []).append((float(number), reading.value))
    repeated = [np.array(group) for group in groups.values() if len(group) > 1]
    if not repeated:
        return 0.0, 0.0
    centred = np.concatenate([group - group.mean(axis=0) for group in repeated])
    spread = float(centred[:, 0] @ centred[:, 0])
    rate = float(centred[:, 0] @ centred[:, 1]) / spread
    left = centred[:, 1] - rate * centred[:, 0]
    degrees = len(left) - len(repeated) - 1
    scatter = float(left @ left) / degrees if degrees > 3 else 0.0
    return rate, float(np.sqrt(max(scatter, setup.noise**2) / spread))
