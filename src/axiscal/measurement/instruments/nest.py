"""The tool point against a ball, in three directions: the nest of an R-test, or a sphere that is touched.

y = δp + R_t tool − (s + ω × d + κ d + e) in the workpiece frame: tool by how much what touches sits elsewhere in the
spindle than stated, which turns with the tool; less where the ball is against its stated place (see `artefact`). Of an
R-test without an artefact zero is the place of the nest. A sphere that is touched at its pole and two sides, n_i, and
not opposite them, shows by how much sphere and stylus are larger than stated, too: − r Σ n_i.
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
    ball_effect,
    ball_moved,
    displaced,
    straight,
    tool_part,
)
from axiscal.measurement.setup import Setup
from axiscal.measurement.touch_sides import touch_frames
from axiscal.numerics import Array

RADIUS = "radius"
_ZEROS = ("zero_x", "zero_y", "zero_z")


class Nest:
    """Three lengths along x, y, z of the workpiece frame."""

    reads: Reads = "length"
    values = 3
    directed = False
    unknown_reads: Mapping[str, Reads] = MappingProxyType({**dict.fromkeys((*_ZEROS, RADIUS), "length"), **TOOL_READS})

    def direction_of(self, setup: Setup, direction: Array, nominal: Nominal) -> Array:
        """Return d for every reading, (m, 3)."""
        return along(direction, nominal.count)

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

    def nonlinear_part(self, setup: Setup, direction: Array, nominal: Nominal) -> Array:
        """Return nothing: it is linear, (m,)."""
        return np.zeros(nominal.count)

    def curvature(self, setup: Setup, direction: Array, nominal: Nominal) -> Array:
        """Return nothing: it is linear in its unknowns, (m, k, k)."""
        return straight(setup, nominal)

    def check(self, setup: Setup, machine: Machine) -> None:
        """Everything makes sense: it reads all directions."""
