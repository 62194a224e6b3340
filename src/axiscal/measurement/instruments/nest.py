"""The R-test: a nest of three probes reads where a ball is that is held in the spindle, in all three directions.

y = δp + R_t tool + zero, zero the place of the nest in the workpiece frame, tool by how much the ball in the spindle is
elsewhere than stated, which turns with the tool.
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
    tool_part,
)
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array

_ZEROS = ("zero_x", "zero_y", "zero_z")


class Nest:
    """Three lengths along x, y, z of the workpiece frame."""

    reads: Reads = "length"
    values = 3
    directed = False
    unknown_reads: Mapping[str, Reads] = MappingProxyType({**dict.fromkeys(_ZEROS, "length"), **TOOL_READS})

    def direction_of(self, setup: Setup, direction: Array, nominal: Nominal) -> Array:
        """Return d for every reading, (m, 3)."""
        return along(direction, nominal.count)

    def unknown_effect(self, setup: Setup, unknown: str, direction: Array, nominal: Nominal) -> Array:
        """Return the part of the zero or of the tool along d, (m,)."""
        if unknown in TOOL:
            return tool_part(unknown, along(direction, nominal.count), nominal)
        return np.full(nominal.count, direction[_ZEROS.index(unknown)])

    def shown(
        self, setup: Setup, direction: Array, nominal: Nominal, actual: Actual, unknowns: Mapping[str, float]
    ) -> Array:
        """Return dᵀ(δp + R tool + zero), (m,)."""
        zero = np.array([unknowns.get(name, 0.0) for name in _ZEROS])
        shown: Array = (displaced(nominal, actual, unknowns) + zero) @ direction
        return shown

    def nonlinear_part(self, setup: Setup, nominal: Nominal) -> Array:
        """Return nothing: it is linear, (m,)."""
        return np.zeros(nominal.count)

    def check(self, setup: Setup, machine: Machine) -> None:
        """Everything makes sense: it reads all directions."""
