"""Skew of the axes as printers know it: x' = x - y xy - z (xz - xy yz), y' = y - z yz."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.compensation.effect import Control
from axiscal.compensation.sampling import cross_tables
from axiscal.compensation.surface import plane_axes
from axiscal.estimation.machine_estimate import Estimate
from axiscal.machine.description import Machine
from axiscal.numerics import Array


@dataclass(frozen=True, slots=True)
class Skew:
    """Tangents by which Y leans towards X, Z towards X, and Z towards Y; None where no reading has seen the plane."""

    xy: float | None = None
    xz: float | None = None
    yz: float | None = None

    @property
    def seen(self) -> dict[str, float]:
        """The tangents by plane, "XY", "XZ", "YZ", of the planes that were seen."""
        planes = {"XY": self.xy, "XZ": self.xz, "YZ": self.yz}
        return {plane: tangent for plane, tangent in planes.items() if tangent is not None}


def skew_of(estimate: Estimate) -> Skew:
    """Return the slopes that are nearest to the mean deviation along x over y and z, and along y over z.

    A plane that no reading has seen has none: a zero would take away what the control holds already.
    """
    tables = {(table.axis, table.over): table for table in cross_tables(estimate)}

    def slope(axis: str, over: str) -> float | None:
        table = tables.get((axis, over))
        if table is None:
            return None
        low, high = estimate.box[estimate.machine.index(over)]
        at = np.linspace(low, high, 1001)
        values = (table.deviation(at, 1) + table.deviation(at, -1)) / 2
        return float(np.polynomial.polynomial.polyfit(at - at.mean(), values, 1)[1])

    return Skew(slope("X", "Y"), slope("X", "Z"), slope("Y", "Z"))


def skew_control(machine: Machine, skew: Skew) -> Control:
    """Return the control that takes the skew away."""
    x, y, z = plane_axes(machine)
    xy, xz, yz = (tangent or 0.0 for tangent in (skew.xy, skew.xz, skew.yz))

    def control(poses: Array, approaches: Array) -> Array:
        added = np.zeros_like(poses)
        added[:, x] = -poses[:, y] * xy - poses[:, z] * (xz - xy * yz)
        added[:, y] = -poses[:, z] * yz
        return added

    return control
