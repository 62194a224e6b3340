"""Which readings are neighbours: what one curve shows them, the same curve shows the other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array

_AS_NEAR = 1.5
"""Neighbours to the left and to the right count alike where places are spaced about evenly."""


class Neighbours:
    """Readings of one set-up within a correlation length of each other, or a knot interval where none is stated."""

    def __init__(self, observation: Observation, readings: Sequence[Reading]) -> None:
        self._poses = np.array([reading.pose for reading in readings])
        self._owners = np.array([reading.setup for reading in readings])
        lengths = np.zeros(len(observation.errors.machine.axes))
        entries = {entry.name: entry for entry in observation.errors.machine.errors}
        for function in observation.errors.functions:
            if function.basis.size > 1 and not function.stated_shape:
                interval = float(np.ptp(function.basis.knots)) / (len(function.basis.knots) - 1)
                length = entries[function.name].length or interval
                lengths[function.axis] = max(lengths[function.axis], length)
        self._lengths = lengths

    def agreeing(self, sides: Mapping[int, float]) -> frozenset[int]:
        """Return those of some readings that have one of them, off to the same side, as their nearest neighbour.

        sides : index of each reading, and how far it is off, signed
        """
        return frozenset(i for first in sides for i in self._pair(first, sides))

    def _pair(self, first: int, sides: Mapping[int, float]) -> tuple[int, ...]:
        """Return a reading with its agreeing neighbours; nothing where a believed one is nearer, or none is near."""
        apart = self._apart(first)
        reach = min(_AS_NEAR * float(apart.min()), 1.0)
        alike = [j for j in sides if apart[j] <= reach and sides[first] * sides[j] > 0]
        return (first, *alike) if alike else ()

    def _apart(self, first: int) -> Array:
        """Return how far all readings are from one, in correlation lengths, infinite for itself and other set-ups."""
        with np.errstate(divide="ignore", invalid="ignore"):
            scaled = np.nan_to_num(np.abs(self._poses - self._poses[first]) / self._lengths, nan=0.0, posinf=np.inf)
        apart: Array = np.where(self._owners == self._owners[first], np.max(scaled, axis=1), np.inf)
        apart[first] = np.inf
        return apart
