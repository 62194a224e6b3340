"""Instruments that read the rotation of the tool about one direction: electronic level, autocollimator.

y = dᵀε + zero.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from axiscal.machine.description import Machine
from axiscal.measurement.instruments.model import Actual, Place, Reads, along
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array


class Rotation:
    """One angle about the set-up's direction."""

    reads: Reads = "angle"
    values = 1
    directed = True
    unknown_reads: Mapping[str, Reads] = MappingProxyType({"zero": "angle"})

    def towards(self, setup: Setup, direction: Array, place: Place) -> Array:
        """Return d for every reading, (m, 3)."""
        return along(direction, place.count)

    def own(self, setup: Setup, unknown: str, direction: Array, place: Place) -> Array:
        """Return 1 for the zero, (m,)."""
        return np.ones(place.count)

    def shown(self, setup: Setup, direction: Array, place: Place, actual: Actual, own: Mapping[str, float]) -> Array:
        """Return dᵀε + zero, (m,)."""
        shown: Array = actual.rotation @ direction + own.get("zero", 0.0)
        return shown

    def beyond(self, setup: Setup, place: Place) -> Array:
        """Return nothing: it is linear, (m,)."""
        return np.zeros(place.count)

    def check(self, setup: Setup, machine: Machine) -> None:
        """Everything makes sense."""
