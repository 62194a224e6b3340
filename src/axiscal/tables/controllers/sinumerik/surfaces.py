"""Errors of two axes together, as sums of products of CEC tables (`$AN_CEC_MULT_BY_TABLE`).

A surface is U S Vᵀ, and each term one product F(a) G(b). Do the factors act by themselves as well? Siemens' function
manual (6FC5397-1BP40-3BA1) says both: its text (p. 249) adds the product to the tables. Its example of a sagging
foundation (p. 252) has the product alone. So every product is there twice, F G and (−F)(−G), at half its size: then F,
−F, G and −G cancel on either reading.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from typing import NamedTuple

import numpy as np

from axiscal.errors.plane import PlaneError
from axiscal.estimation.machine_estimate import Estimate
from axiscal.machine.description import Machine
from axiscal.numerics import Array
from axiscal.numerics.gaussian import settled
from axiscal.tables.effect import Control
from axiscal.tables.export_options import ExportOptions
from axiscal.tables.hats import Hats
from axiscal.tables.loaded import Lookup
from axiscal.tables.sampling import points

PER_METRE = 1e3
"""The control multiplies numbers in mm."""
_TERMS, _LEFT = 4, 0.02
"""Products of one surface at most, and the share of its largest height below which no more are needed."""
_NOTHING = 5e-8
"""m: a surface that is nowhere higher is left out."""


class Product(NamedTuple):
    """One table times another: `sign` times the product of their numbers in mm is added to the axis of the first."""

    first: Lookup
    second: Lookup
    sign: float = -2.0

    def at(self, one: Array, other: Array) -> Array:
        """Return what is added at positions (m,) of both axes that are looked up, m."""
        sides = np.zeros_like(one)
        return self.sign * PER_METRE * self.first.at(one, sides) * self.second.at(other, sides)


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
    """Return the control that adds the products alone."""

    def control(poses: Array, approaches: Array) -> Array:
        added = np.zeros_like(poses)
        for each in found:
            over = [machine.index(lookup.over) for lookup in (each.first, each.second)]
            added[:, machine.index(each.first.axis)] += each.at(poses[:, over[0]], poses[:, over[1]])
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
        one = Lookup(mover, names[0], sides[0].points, balance * first)
        other = Lookup(mover, names[1], sides[1].points, second / (2 * PER_METRE * balance))
        found.append(Product(one, other))
        left = left - np.outer(first, second)
    return found


def _directions(surface: Array) -> Array:
    """Return the left singular vectors, the largest singular value first: (k, n)."""
    first, sizes, _ = np.linalg.svd(surface, full_matrices=False)
    return settled(sizes**2, first).T
