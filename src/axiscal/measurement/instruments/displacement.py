"""Instruments that read the displacement of the TCP along a direction: interferometer, indicator, probe, straightedge.

y = dᵀδp + zero + (slope + growth) · s, s the travel of the moving axis from its middle. The growth is what the material
is longer by than at 20 °C; what is known of it is taken off, what is not is an unknown.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from axiscal.measurement.instruments.model import Actual, Place, Reads, along
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array


class Displacement:
    """One length along the set-up's direction."""

    reads: Reads = "length"
    values = 1
    directed = True
    unknown_reads: Mapping[str, Reads] = MappingProxyType({"zero": "length", "slope": "angle", "growth": "angle"})

    def towards(self, setup: Setup, direction: Array, place: Place) -> Array:
        """Return d for every reading, (m, 3)."""
        return along(direction, place.count)

    def own(self, setup: Setup, unknown: str, direction: Array, place: Place) -> Array:
        """Return 1 for the zero, the travel for slope and growth, (m,)."""
        return np.ones(place.count) if unknown == "zero" else place.travelled

    def shown(self, setup: Setup, direction: Array, place: Place, actual: Actual, own: Mapping[str, float]) -> Array:
        """Return dᵀδp + zero + (tan(slope) + growth) s, (m,)."""
        tilted = (np.tan(own.get("slope", 0.0)) + own.get("growth", 0.0) + setup.growth) * place.travelled
        shown: Array = actual.displacement @ direction + own.get("zero", 0.0) + tilted
        return shown

    def beyond(self, setup: Setup, place: Place) -> Array:
        """Return the growth that is known, (m,)."""
        return setup.growth * place.travelled

    def check(self, setup: Setup) -> None:
        """Everything makes sense."""
