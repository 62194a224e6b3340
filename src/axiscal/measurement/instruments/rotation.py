"""Instruments that read the rotation of the tool about one direction: electronic level, autocollimator.

y = dᵀε + zero.
"""

from __future__ import annotations

from collections.abc import Mapping

from axiscal.machine.description import Machine
from axiscal.measurement.instruments.kind import Actual, Angle, Nominal
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array


class Rotation(Angle):
    """One angle about the set-up's direction."""

    def shown(
        self, setup: Setup, direction: Array, nominal: Nominal, actual: Actual, unknowns: Mapping[str, float]
    ) -> Array:
        """Return dᵀε + zero, (m,)."""
        shown: Array = actual.rotation @ direction + unknowns.get("zero", 0.0)
        return shown

    def check(self, setup: Setup, machine: Machine) -> None:
        """Everything makes sense."""
