"""The tool point against a ball, in three directions: the nest of an R-test, or a sphere that is touched.

y = δp + R_t tool − (s + ω × d + κ d + e) in the workpiece frame. `tool` is the offset in the spindle from the stated
place, and turns with the tool. The bracket is the ball against its stated place (see `artefact`). An R-test without an
artefact has the place of the nest as zero. A sphere touched at its pole and two sides n_i, not opposite ones, adds
− r Σ n_i. There r is by how much sphere and stylus are larger than stated.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from axiscal.measurement.instruments.kind import (
    TOOL,
    TOOL_READS,
    Actual,
    LinearModel,
    Nominal,
    Reads,
    along,
    ball_effect,
    ball_moved,
    displaced,
    tool_part,
)
from axiscal.measurement.setup import Setup
from axiscal.measurement.touched import touch_frames
from axiscal.numerics import Array

RADIUS = "radius"
_ZEROS = ("zero_x", "zero_y", "zero_z")


class Nest(LinearModel):
    """Three lengths along x, y, z of the workpiece frame."""

    reads: Reads = "length"
    values = 3
    directed = False
    unknown_reads: Mapping[str, Reads] = MappingProxyType({**dict.fromkeys((*_ZEROS, RADIUS), "length"), **TOOL_READS})

    def unknown_effect(self, setup: Setup, unknown: str, direction: Array, nominal: Nominal) -> Array:
        """Return the part of an unknown along d, (m,)."""
        if unknown in TOOL:
            return tool_part(unknown, along(direction, nominal.count), nominal)
        if unknown in _ZEROS:
            return np.full(nominal.count, direction[_ZEROS.index(unknown)])
        if unknown == RADIUS:
            larger: Array = -touch_frames(nominal.machine, nominal.poses).sum(axis=1) @ direction
            return larger
        part: Array = ball_effect(setup, unknown, nominal) @ direction
        return part

    def shown(
        self, setup: Setup, direction: Array, nominal: Nominal, actual: Actual, unknowns: Mapping[str, float]
    ) -> Array:
        """Return dᵀ(δp + R tool + zero − where the ball is − r Σ n_i), (m,)."""
        zero = np.array([unknowns.get(name, 0.0) for name in _ZEROS])
        shown: Array = (displaced(nominal, actual, unknowns) + zero + ball_moved(setup, unknowns, nominal)) @ direction
        if unknowns.get(RADIUS):
            shown = shown + unknowns[RADIUS] * self.unknown_effect(setup, RADIUS, direction, nominal)
        return shown
