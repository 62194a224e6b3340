"""The laser tracker: it reads where the TCP is, in all directions, from a station of unknown place and orientation.

What it shows in its own frame, less the nominal place: y = R(turn)(p + δp + R_t tool − station) + station + zero − p,
to first order δp + R_t tool + zero + turn × (p − station).
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
_TURNS = ("turn_x", "turn_y", "turn_z")
_UNKNOWNS: dict[str, Reads] = {**dict.fromkeys(_ZEROS, "length"), **dict.fromkeys(_TURNS, "angle"), **TOOL_READS}


class Tracker:
    """Three lengths along x, y, z of the workpiece frame."""

    reads: Reads = "length"
    values = 3
    directed = False
    unknown_reads: Mapping[str, Reads] = MappingProxyType(_UNKNOWNS)

    def direction_of(self, setup: Setup, direction: Array, nominal: Nominal) -> Array:
        """Return d for every reading, (m, 3)."""
        return along(direction, nominal.count)

    def unknown_effect(self, setup: Setup, unknown: str, direction: Array, nominal: Nominal) -> Array:
        """Return the part of a zero or of the tool along d, or of the turn of the frame about the station, (m,)."""
        if unknown in TOOL:
            return tool_part(unknown, along(direction, nominal.count), nominal)
        if unknown in _ZEROS:
            return np.full(nominal.count, direction[_ZEROS.index(unknown)])
        about = np.eye(3)[_TURNS.index(unknown)]
        turned: Array = np.cross(about, nominal.tcp - _station(setup)) @ direction
        return turned

    def shown(
        self, setup: Setup, direction: Array, nominal: Nominal, actual: Actual, unknowns: Mapping[str, float]
    ) -> Array:
        """Return dᵀ( R(turn)(p + δp + R tool − station) + station + zero − p ), (m,)."""
        turn = rigid.rotation(np.array([[unknowns.get(name, 0.0) for name in _TURNS]]))[0]
        zero = np.array([unknowns.get(name, 0.0) for name in _ZEROS])
        seen = (nominal.tcp + displaced(nominal, actual, unknowns) - _station(setup)) @ turn.T + _station(setup) + zero
        shown: Array = (seen - nominal.tcp) @ direction
        return shown

    def nonlinear_part(self, setup: Setup, nominal: Nominal) -> Array:
        """Return nothing: it is linear, (m,)."""
        return np.zeros(nominal.count)

    def check(self, setup: Setup, machine: Machine) -> None:
        """Raise DescriptionError without a station."""
        need_station(setup, "the tracker")


def _station(setup: Setup) -> Array:
    return np.zeros(3) if setup.station is None else np.array(setup.station)
