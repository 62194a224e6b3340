"""What two axes do together, as sums of products of CEC tables (`$AN_CEC_MULT_BY_TABLE`).

A surface is U S Vᵀ, and each term one product F(a) G(b). Siemens' function manual (6FC5397-1BP40-3BA1) does not agree
with itself whether the factors act by themselves as well: its text (p. 249) adds the product to what the tables do, its
example of a sagging foundation (p. 252) has the product alone. So every product is there twice, F G and (−F)(−G), at
half its size: then F, −F, G and −G cancel on either reading.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np

from axiscal.compensation.effect import Control
from axiscal.compensation.export_options import ExportOptions
from axiscal.compensation.hats import Hats
from axiscal.compensation.sampling import points
from axiscal.error_model.plane import PlaneError
from axiscal.estimation.machine_estimate import Estimate
from axiscal.machine.description import Machine
from axiscal.numerics import Array
from axiscal.numerics.gaussian import settled

PER_METRE = 1e3
"""The control multiplies numbers in mm."""
_TERMS, _LEFT = 4, 0.02
"""Products of one surface at most, and the share of its largest height below which no more are needed."""
_NOTHING = 5e-8
"""m: a surface that is nowhere higher is left out."""


@dataclass(frozen=True, eq=False, slots=True)
class Factor:
    """A table of numbers that are multiplied: over an axis, at positions (n,), values (n,), m."""

    over: str
    positions: Array
    values: Array

    def at(self, position: Array) -> Array:
        """Return it at positions (m,): linear between points, constant outside."""
        return np.interp(position, self.positions, self.values)


@dataclass(frozen=True, eq=False, slots=True)
class Product:
    """Twice `first` times `second`, both in mm: a deviation of an axis along its own positive direction."""

    axis: str
    first: Factor
    second: Factor


def products(estimate: Estimate, options: ExportOptions, most: int, step: float) -> tuple[Product, ...]:
    """Return the products of all displacements by two linear axes that one axis can take away.

    None where a rotary axis turns what they act on.  most : points of a table; step : their grid, m
    """
    model = estimate.model
    if any(axis.rotary for axis in model.machine.axes):
        return ()
    levers = model.levers(np.array([model.machine.zero]))[:, 0]
    found: list[Product] = []
    for plane, lever in zip(model.planes, levers[len(model.functions) :], strict=True):
        mover = next((k for k, a in enumerate(model.machine.axes) if _along(lever, np.array(a.direction))), None)
        if plane.angular or mover is None:
            continue
        share = float(lever @ np.array(model.machine.axes[mover].direction))
        found += _of_plane(estimate, plane, model.machine.axes[mover].name, share, options, most, step)
    return tuple(found)


def product_control(machine: Machine, found: Sequence[Product]) -> Control:
    """Return the control that takes the products away."""

    def control(poses: Array, approaches: Array) -> Array:
        added = np.zeros_like(poses)
        for each in found:
            first, second = (factor.at(poses[:, machine.index(factor.over)]) for factor in (each.first, each.second))
            added[:, machine.index(each.axis)] -= 2 * PER_METRE * first * second
        return added

    return control


def _along(lever: Array, direction: Array) -> bool:
    return bool(np.allclose(np.abs(lever @ direction), np.linalg.norm(lever), atol=1e-9) and np.any(lever))


def _of_plane(
    estimate: Estimate, plane: PlaneError, mover: str, share: float, options: ExportOptions, most: int, step: float
) -> list[Product]:
    axes, sides = estimate.machine.axes, []
    for axis in plane.axes:
        at = points(estimate.model, axis, options.spacing, most, step)
        sides.append(Hats.on(at, plane.knots_along(axis)[0], estimate.box[axis]))
    nodes = np.meshgrid(sides[0].nodes, sides[1].nodes, indexing="ij")
    rows = plane.rows(np.stack([each.ravel() for each in nodes], axis=1))
    heights = (rows @ estimate.mean[plane.columns]).reshape(nodes[0].shape)
    for axis, side in enumerate(sides):  # tables over one axis hold the mean over the other already
        heights = heights - np.average(heights, axis=axis, weights=side.weights, keepdims=True)
    surface = share * sides[1].best(sides[0].best(heights).T).T
    most_high, found = float(np.max(np.abs(surface))), list[Product]()
    if most_high < _NOTHING:
        return []
    left, names = surface, [axes[axis].name for axis in plane.axes]
    for first in islice(_directions(surface), _TERMS):
        if np.max(np.abs(left)) < _LEFT * most_high:
            continue
        second = first @ surface
        balance = np.sqrt(np.max(np.abs(second)) / np.max(np.abs(first)) / (2 * PER_METRE))
        one = Factor(names[0], sides[0].points, balance * first)
        other = Factor(names[1], sides[1].points, second / (2 * PER_METRE * balance))
        found.append(Product(mover, one, other))
        left = left - np.outer(first, second)
    return found


def _directions(surface: Array) -> Array:
    """Return the left singular vectors, the largest singular value first: (k, n)."""
    first, sizes, _ = np.linalg.svd(surface, full_matrices=False)
    return settled(sizes**2, first).T
