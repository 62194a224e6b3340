"""Instruments that read the displacement of the TCP along a direction: interferometer, indicator, probe, straightedge.

y = dᵀδp + zero + slope · s + growth · dᵀe s, s the travel of the moving axis from its middle, e the way it goes in the
workpiece frame. The growth is what the material is longer by than at 20 °C; what is known of it is taken off, what is
not is an unknown.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from axiscal.machine.description import Machine
from axiscal.machine.kinematics import frames
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
        """Return 1 for the zero, the travel for the slope, the travel along the direction for the growth, (m,)."""
        if unknown == "zero":
            return np.ones(place.count)
        return place.travelled if unknown == "slope" else _travelled_along(direction, place)

    def shown(self, setup: Setup, direction: Array, place: Place, actual: Actual, own: Mapping[str, float]) -> Array:
        """Return dᵀδp + zero + tan(slope) s + growth dᵀe s, (m,)."""
        tilted = np.tan(own.get("slope", 0.0)) * place.travelled
        grown = _grown(own.get("growth", 0.0) + setup.growth, direction, place)
        shown: Array = actual.displacement @ direction + own.get("zero", 0.0) + tilted + grown
        return shown

    def beyond(self, setup: Setup, place: Place) -> Array:
        """Return the growth that is known, (m,)."""
        return _grown(setup.growth, np.array(setup.direction), place)

    def check(self, setup: Setup, machine: Machine) -> None:
        """Everything makes sense."""


def _grown(strain: float, direction: Array, place: Place) -> Array:
    """Return by what a strain of the material lengthens the readings, (m,), m."""
    return strain * _travelled_along(direction, place) if strain else np.zeros(place.count)


def _travelled_along(direction: Array, place: Place) -> Array:
    """Return the travel from the middle, as far as it goes along the direction, (m,), m; negative against it."""
    axes = place.machine.axes
    axis = next((k for k in place.moves if not axes[k].rotary), None)
    if axis is None:
        return np.zeros(place.count)
    ways = frames(place.machine, place.poses).rotations[axis] @ np.array(axes[axis].direction)
    along_it: Array = place.travelled * (ways @ direction)
    return along_it
