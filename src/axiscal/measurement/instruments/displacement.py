"""Instruments that read the displacement of the TCP along a direction: interferometer, indicator, probeedge.

y = dᵀδp + zero + slope · s + growth · dᵀe s + lag · a sign(dᵀe).
Here s is the travel of the moving axis from its middle, e its way in the workpiece frame, a = ±1 the side it came from.
A leg of a square that is turned by ω has the slope ω · (e × d): the two legs have it with opposite signs. The
growth is by how much the material is longer than at 20 °C. Its known part is taken off; the rest is an unknown. The lag
is what a stylus or spindle with play shows of the way it was moved last.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from axiscal.machine.kinematics import frames
from axiscal.measurement.instruments.kind import Actual, LinearModel, Nominal, Reads
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array

SQUARE = ("square_x", "square_y", "square_z")
"""By how much the square is turned that a leg belongs to."""
_LEAST_ALONG = 0.5
"""Of a way along the direction that is read, from which its side of approach is the side of the play."""
_READS: dict[str, Reads] = {
    "zero": "length",
    "slope": "angle",
    "growth": "angle",
    "lag": "length",
    **dict.fromkeys(SQUARE, "angle"),
}


class Displacement(LinearModel):
    """One length along the set-up's direction."""

    reads: Reads = "length"
    values = 1
    directed = True
    unknown_reads: Mapping[str, Reads] = MappingProxyType(_READS)

    def unknown_effect(self, setup: Setup, unknown: str, direction: Array, nominal: Nominal) -> Array:
        """Return 1 for the zero, the travel for the slope, the travel along the direction for the growth, (m,)."""
        if unknown == "zero":
            return np.ones(nominal.count)
        if unknown in SQUARE:
            return _turned(direction, nominal)[:, SQUARE.index(unknown)]
        if unknown == "lag":
            return _came(direction, nominal)
        return nominal.travelled if unknown == "slope" else _travelled_along(direction, nominal)

    def shown(
        self, setup: Setup, direction: Array, nominal: Nominal, actual: Actual, unknowns: Mapping[str, float]
    ) -> Array:
        """Return dᵀδp + zero + tan(slope) s + growth dᵀe s, (m,)."""
        tilted = np.tan(unknowns.get("slope", 0.0)) * nominal.travelled
        turned = _turned(direction, nominal) @ np.array([unknowns.get(name, 0.0) for name in SQUARE])
        grown = _grown(unknowns.get("growth", 0.0) + setup.growth, direction, nominal)
        late = unknowns["lag"] * _came(direction, nominal) if "lag" in unknowns else 0.0
        shown: Array = actual.displacement @ direction + unknowns.get("zero", 0.0) + tilted + turned + grown + late
        return shown

    def nonlinear_part(self, setup: Setup, direction: Array, nominal: Nominal) -> Array:
        """Return the growth that is known, (m,)."""
        return _grown(setup.growth, direction, nominal)


def _grown(strain: float, direction: Array, nominal: Nominal) -> Array:
    """Return by what a strain of the material lengthens the readings, (m,), m."""
    return strain * _travelled_along(direction, nominal) if strain else np.zeros(nominal.count)


def _travelled_along(direction: Array, nominal: Nominal) -> Array:
    """Return the travel from the middle, as far as it goes along the direction, (m,), m; negative against it."""
    along_it: Array = nominal.travelled * (_ways(nominal) @ direction)
    return along_it


def _turned(direction: Array, nominal: Nominal) -> Array:
    """Return what unit turns about x, y, z of what is read do along the direction, (m, 3), m."""
    turned: Array = nominal.travelled[:, None] * np.cross(_ways(nominal), direction)
    return turned


def _came(direction: Array, nominal: Nominal) -> Array:
    """Return the side from which the linear axis that moves came, along the direction: 1, −1, 0 if unknown, (m,)."""
    axis = next((k for k in nominal.moves if not nominal.machine.axes[k].rotary), None)
    if axis is None or nominal.approaches is None:
        return np.zeros(nominal.count)
    along = _ways(nominal) @ direction
    came: Array = nominal.approaches[:, axis] * np.where(np.abs(along) >= _LEAST_ALONG, np.sign(along), 0.0)
    return came


def _ways(nominal: Nominal) -> Array:
    """Return the way that the linear axis which moves goes in the workpiece frame, (m, 3); zero where none moves."""
    axes = nominal.machine.axes
    axis = next((k for k in nominal.moves if not axes[k].rotary), None)
    if axis is None:
        return np.zeros((nominal.count, 3))
    ways: Array = frames(nominal.machine, nominal.poses).rotations[axis] @ np.array(axes[axis].direction)
    return ways
