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
from axiscal.measurement.instruments.kind import Actual, Nominal, Reads, along
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array


class Displacement:
    """One length along the set-up's direction."""

    reads: Reads = "length"
    values = 1
    directed = True
    unknown_reads: Mapping[str, Reads] = MappingProxyType({"zero": "length", "slope": "angle", "growth": "angle"})

    def direction_of(self, setup: Setup, direction: Array, nominal: Nominal) -> Array:
        """Return d for every reading, (m, 3)."""
        return along(direction, nominal.count)

    def unknown_effect(self, setup: Setup, unknown: str, direction: Array, nominal: Nominal) -> Array:
        """Return 1 for the zero, the travel for the slope, the travel along the direction for the growth, (m,)."""
        if unknown == "zero":
            return np.ones(nominal.count)
        return nominal.travelled if unknown == "slope" else _travelled_along(direction, nominal)

    def shown(
        self, setup: Setup, direction: Array, nominal: Nominal, actual: Actual, unknowns: Mapping[str, float]
    ) -> Array:
        """Return dᵀδp + zero + tan(slope) s + growth dᵀe s, (m,)."""
        tilted = np.tan(unknowns.get("slope", 0.0)) * nominal.travelled
        grown = _grown(unknowns.get("growth", 0.0) + setup.growth, direction, nominal)
        shown: Array = actual.displacement @ direction + unknowns.get("zero", 0.0) + tilted + grown
        return shown

    def nonlinear_part(self, setup: Setup, direction: Array, nominal: Nominal) -> Array:
        """Return the growth that is known, (m,)."""
        return _grown(setup.growth, direction, nominal)

    def check(self, setup: Setup, machine: Machine) -> None:
        """Everything makes sense."""


def _grown(strain: float, direction: Array, nominal: Nominal) -> Array:
    """Return by what a strain of the material lengthens the readings, (m,), m."""
    return strain * _travelled_along(direction, nominal) if strain else np.zeros(nominal.count)


def _travelled_along(direction: Array, nominal: Nominal) -> Array:
    """Return the travel from the middle, as far as it goes along the direction, (m,), m; negative against it."""
    axes = nominal.machine.axes
    axis = next((k for k in nominal.moves if not axes[k].rotary), None)
    if axis is None:
        return np.zeros(nominal.count)
    ways = frames(nominal.machine, nominal.poses).rotations[axis] @ np.array(axes[axis].direction)
    along_it: Array = nominal.travelled * (ways @ direction)
    return along_it
