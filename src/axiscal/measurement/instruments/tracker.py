"""The laser tracker: it reads where the TCP is, in all directions, from a station of unknown place and orientation.

Its place of the TCP, less the nominal one: y = R(turn)(p + δp + R_t tool − station) + station + zero − p.
A tracker set down by eye is turned by milliradians, so it is linear only about the turn θ₀ that is found (`found`).
There y = R(θ₀)(δp + R_t tool) + zero + J turn + c, J the derivative of R(θ)(p − station), c the reading without these.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from axiscal.machine.description import Machine
from axiscal.measurement.instruments.kind import (
    TOOL,
    TOOL_READS,
    Actual,
    Nominal,
    Reads,
    along,
    displaced,
    need_station,
    tool_part,
)
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array, rigid

_ZEROS = ("zero_x", "zero_y", "zero_z")
TURNS = ("turn_x", "turn_y", "turn_z")
_UNKNOWNS: dict[str, Reads] = {**dict.fromkeys(_ZEROS, "length"), **dict.fromkeys(TURNS, "angle"), **TOOL_READS}
_STEP = 1e-3
"""rad; the derivative of a rotation from differences of four places is then right to 1e-13."""


class Tracker:
    """Three lengths along x, y, z of the workpiece frame."""

    reads: Reads = "length"
    values = 3
    directed = False
    unknown_reads: Mapping[str, Reads] = MappingProxyType(_UNKNOWNS)

    def direction_of(self, setup: Setup, direction: Array, nominal: Nominal) -> Array:
        """Return d as it lies in the workpiece frame, R(θ₀)ᵀ d, for every reading, (m, 3)."""
        return along(direction @ _rotation(_found(setup)), nominal.count)

    def unknown_effect(self, setup: Setup, unknown: str, direction: Array, nominal: Nominal) -> Array:
        """Return the part of a zero or of the tool along d, or of the turn of the frame about the station, (m,)."""
        if unknown in TOOL:
            return tool_part(unknown, self.direction_of(setup, direction, nominal), nominal)
        if unknown in _ZEROS:
            return np.full(nominal.count, direction[_ZEROS.index(unknown)])
        line = nominal.tcp - _station(setup)
        turned: Array = line @ _derivative(_found(setup), TURNS.index(unknown)).T @ direction
        return turned

    def shown(
        self, setup: Setup, direction: Array, nominal: Nominal, actual: Actual, unknowns: Mapping[str, float]
    ) -> Array:
        """Return dᵀ( R(turn)(p + δp + R tool − station) + station + zero − p ), (m,)."""
        turn = rigid.rotation(np.array([[unknowns.get(name, 0.0) for name in TURNS]]))[0]
        zero = np.array([unknowns.get(name, 0.0) for name in _ZEROS])
        seen = (nominal.tcp + displaced(nominal, actual, unknowns) - _station(setup)) @ turn.T + _station(setup) + zero
        shown: Array = (seen - nominal.tcp) @ direction
        return shown

    def nonlinear_part(self, setup: Setup, direction: Array, nominal: Nominal) -> Array:
        """Return dᵀ( R(θ₀) − 1 − Σ θ₀ᵢ ∂R/∂θᵢ )(p − station), (m,)."""
        turn = _found(setup)
        linear = sum(turn[i] * _derivative(turn, i) for i in range(3))
        beyond: Array = (nominal.tcp - _station(setup)) @ (_rotation(turn) - np.eye(3) - linear).T @ direction
        return beyond

    def check(self, setup: Setup, machine: Machine) -> None:
        """Raise DescriptionError without a station."""
        need_station(setup, "the tracker")


def _station(setup: Setup) -> Array:
    return np.zeros(3) if setup.station is None else np.array(setup.station)


def _found(setup: Setup) -> Array:
    return np.array(setup.found or (0.0, 0.0, 0.0))


def _rotation(turn: Array) -> Array:
    rotation: Array = rigid.rotation(turn[None])[0]
    return rotation


def _derivative(turn: Array, index: int) -> Array:
    """Return how R(θ) changes with one part of θ, (3, 3)."""
    step = _STEP * np.eye(3)[index]
    near, far = (_rotation(turn + k * step) - _rotation(turn - k * step) for k in (1, 2))
    derivative: Array = (8 * near - far) / (12 * _STEP)
    return derivative
