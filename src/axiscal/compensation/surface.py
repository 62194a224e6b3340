"""Height over the plane: the mean deviation along z at a place (x, y), as a mesh of points with planes between."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from axiscal.compensation.effect import Control
from axiscal.compensation.hats import Hats
from axiscal.error_model.model import ErrorModel
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.numerics import Array
from axiscal.numerics.quadrature import gauss

_GAUSS = 6
"""Points of Gauss: exact for degree 11, and the products of hats, cubics and levers have fewer."""
_FEWEST, _FINEST = 5, 50
"""Points a side where the options say none: fewer show no bend, more take a printer's probe too long."""
_SAMPLE = 5
"""Places a side at which is looked whether a surface is worth a mesh: it bends a few times at most."""


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


def with_height(estimate: Estimate) -> Estimate:
    """Return the estimate of a machine that has Z as well, without errors, where it has X and Y only.

    A plane whose height was read needs no Z in its description, and a mesh moves one.
    """
    machine = estimate.machine
    if sorted(axis.name for axis in machine.axes) != ["X", "Y"]:
        return estimate
    upright = Axis.named("Z", False, (0.0, 1e-3))
    taller = replace(machine, axes=(*machine.axes, upright), chain=f"{machine.chain.removesuffix('-t')}-Z-t")
    return Estimate(ErrorModel(taller), estimate.belief, (*estimate.box, (0.0, 0.0)), estimate.grid)


def height_seen(estimate: Estimate) -> bool:
    """Return whether the readings say anything of the height over the plane."""
    x, y, _ = plane_axes(estimate.machine)
    places = [np.linspace(*estimate.box[axis], _SAMPLE) for axis in (x, y)]
    poses = np.tile(np.mean(estimate.box, axis=1), (_SAMPLE**2, 1))
    poses[:, x], poses[:, y] = (grid.ravel() for grid in np.meshgrid(*places))
    rows = estimate.model.along(estimate.model.levers(poses)[:, :, 2], poses, np.zeros_like(poses))
    return estimate.sees(rows)


def mesh_of(estimate: Estimate, count: int | None = None) -> Mesh:
    """Return the mesh that is nearest to minus the mean deviation along z, over the volume.

    count : of points along each side, over the travel; None takes the map that was read, or as many as the curves have
    The height is zero at the machine's zero, x and y at 0 or at the end of travel nearest to it.
    """
    x, y, z = plane_axes(estimate.machine)
    sides = [_hats(estimate, axis, at) for axis, at in zip((x, y), _places(estimate, (x, y), count), strict=True)]
    deviation = np.zeros((len(sides[1].nodes), len(sides[0].nodes)))
    for height, weight in zip(*_heights(estimate.box[z]), strict=True):
        deviation += weight * _deviation(estimate, (x, y, z), sides, height)
    found = sides[0].best(sides[1].best(deviation).T).T
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


def held_words(height: bool, skew: Mapping[str, float]) -> str:
    """Return what files for a printer hold, in words.  skew : tangents by plane."""
    words = ["height over the plane as a bed mesh"] if height else []
    return " and ".join([*words, *([f"the skew of {', '.join(skew)}"] if skew else [])])


def sum_of(*controls: Control) -> Control:
    """Return the control that does what all of them do."""
    return lambda poses, approaches: np.sum([control(poses, approaches) for control in controls], axis=0)


def _places(estimate: Estimate, axes: tuple[int, int], count: int | None) -> tuple[Array, Array]:
    """Return where the points lie along both sides, m."""
    if count is None and estimate.grid is not None:
        return estimate.grid
    x, y = (np.linspace(*estimate.machine.axes[axis].travel, count or _fineness(estimate, axis)) for axis in axes)
    return x, y


def _fineness(estimate: Estimate, axis: int) -> int:
    knots = max((len(each) for each in _knots(estimate, axis)), default=0)
    return min(max(knots, _FEWEST), _FINEST)


def _knots(estimate: Estimate, axis: int) -> list[Array]:
    """Return the knots of all errors along an axis."""
    own = [f.basis.knots for f in estimate.model.functions if f.axis == axis]
    return own + [knots for plane in estimate.model.planes for knots in plane.knots_along(axis)]


def _hats(estimate: Estimate, axis: int, at: Array) -> Hats:
    knots = _knots(estimate, axis)
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
