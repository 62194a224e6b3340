"""Height over the plane: the mean deviation along z at a place (x, y), as a mesh of points with planes between."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from axiscal.compensation.effect import Control
from axiscal.compensation.hats import Hats
from axiscal.estimate.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.description import Machine
from axiscal.numerics import Array
from axiscal.numerics.quadrature import gauss

_GAUSS = 6


@dataclass(frozen=True, eq=False, slots=True)
class Mesh:
    """Heights added to z, m.  x : (n,), y : (k,) m, increasing; added : (k, n), rows along y."""

    x: Array
    y: Array
    added: Array

    def at(self, x: Array, y: Array) -> Array:
        """Return what is added at places (m,): bilinear between the points, constant outside."""
        columns, rows = (
            np.clip(np.searchsorted(grid, place, side="right") - 1, 0, len(grid) - 2)
            for grid, place in ((self.x, x), (self.y, y))
        )
        u = np.clip((x - self.x[columns]) / (self.x[columns + 1] - self.x[columns]), 0, 1)
        v = np.clip((y - self.y[rows]) / (self.y[rows + 1] - self.y[rows]), 0, 1)
        low = (1 - u) * self.added[rows, columns] + u * self.added[rows, columns + 1]
        high = (1 - u) * self.added[rows + 1, columns] + u * self.added[rows + 1, columns + 1]
        height: Array = (1 - v) * low + v * high
        return height


def plane_axes(machine: Machine) -> tuple[int, int, int]:
    """Return where X, Y and Z stand in a pose; raises TableError for a machine that is more, or less, than these."""
    names = sorted(axis.name for axis in machine.axes)
    if names != ["X", "Y", "Z"]:
        raise TableError(f"the machine has axes {', '.join(names)}", "this control is for X, Y and Z")
    x, y, z = (machine.index(name) for name in "XYZ")
    return x, y, z


def mesh_of(estimate: Estimate, count: int) -> Mesh:
    """Return the mesh of count x count points that is nearest to minus the mean deviation along z, over the volume.

    The height is zero at the machine's zero, x and y at 0 or at the end of travel nearest to it.
    """
    x, y, z = plane_axes(estimate.machine)
    sides = [_hats(estimate, axis, count) for axis in (x, y)]
    deviation = np.zeros((len(sides[1].nodes), len(sides[0].nodes)))
    for height, weight in zip(*_heights(estimate.box[z]), strict=True):
        deviation += weight * _deviation(estimate, (x, y, z), sides, height)
    found = sides[1].best() @ deviation @ sides[0].best().T
    free = Mesh(sides[0].points, sides[1].points, -found)
    return replace(free, added=free.added - free.at(np.zeros(1), np.zeros(1)))


def mesh_control(machine: Machine, mesh: Mesh) -> Control:
    """Return the control that adds the heights to Z."""
    x, y, z = plane_axes(machine)

    def control(poses: Array, approaches: Array) -> Array:
        added = np.zeros_like(poses)
        added[:, z] = mesh.at(poses[:, x], poses[:, y])
        return added

    return control


def sum_of(*controls: Control) -> Control:
    """Return the control that does what all of them do."""
    return lambda poses, approaches: np.sum([control(poses, approaches) for control in controls], axis=0)


def _hats(estimate: Estimate, axis: int, count: int) -> Hats:
    start, stop = estimate.machine.axes[axis].travel
    knots = [f.basis.knots for f in estimate.model.functions if f.axis == axis]
    at = np.linspace(start, stop, count)
    return Hats.on(at, np.concatenate(knots) if knots else at, estimate.box[axis])


def _heights(bounds: tuple[float, float]) -> tuple[Array, Array]:
    if bounds[0] == bounds[1]:
        return np.array(bounds[:1]), np.ones(1)
    nodes, weights = gauss(np.array(bounds), _GAUSS)
    return nodes.ravel(), weights.ravel() / (bounds[1] - bounds[0])


def _deviation(estimate: Estimate, axes: tuple[int, int, int], sides: list[Hats], height: float) -> Array:
    """Return the deviation along z at the nodes, (y nodes, x nodes), one row of them at a time."""
    x, y, z = axes
    result = np.empty((len(sides[1].nodes), len(sides[0].nodes)))
    for row, place in zip(result, sides[1].nodes, strict=True):
        poses = np.empty((len(row), 3))
        poses[:, x], poses[:, y], poses[:, z] = sides[0].nodes, place, height
        levers = estimate.model.levers(poses)[:, :, 2]
        row[:] = estimate.model.along(levers, poses, np.zeros_like(poses)) @ estimate.mean
    return result
