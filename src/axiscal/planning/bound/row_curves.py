"""The rows of a set-up as a sum of polynomial curves, one per axis, where they are one: no lever arms, no turning.

The errors of such a machine simply add up. Between knots a row is then a polynomial of one axis plus one of the next
(B&H eq. 28-30). Poses all over the travels test whether it is one.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from axiscal.exceptions import PlanError
from axiscal.language.spoken import listed, said
from axiscal.measurement.breaks import breaks_along
from axiscal.measurement.observation import Observation, directions_of
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.numerics.bernstein import BezierCurve, along, bernstein
from axiscal.numerics.chebyshev import nodes
from axiscal.numerics.spread import even_points
from axiscal.planning.step.ground import sides

_DEGREES = (3, 4)
"""A row is a cubic, with a slope of the set-up's own of degree 4: both are tried."""
_LOOKS = 64
"""Poses at which the curves are compared with the rows themselves; a wrong one shows at almost every pose."""
_EXACT = 1e-10
"""Rounding of a sum over the axes, with room; a term that is missing is millions of times larger."""


class Sum(NamedTuple):
    """Rows of one number: that at the park pose (n,), and what each moving axis adds to it."""

    parked: Array
    curves: list[BezierCurve]

    def at(self, places: Array) -> Array:
        """Return the rows at coordinates (m, q) of the moving axes, (m, n)."""
        return self.parked + sum(along(c, at) for c, at in zip(self.curves, places.T, strict=True))

    def seen(self, reach: Array) -> Sum:
        """Return the same of rows times reach (n, w)."""
        return Sum(self.parked @ reach, [BezierCurve(c.left, c.right, c.control @ reach) for c in self.curves])


def refuse_unless_polynomial(observation: Observation, setup: int) -> None:
    """Raise PlanError for a set-up whose rows are no sum of polynomials, one per axis."""
    _degree(observation, setup)


def row_sums(observation: Observation, setup: int, side: Array) -> list[Sum]:
    """Return the rows of each number of a reading from one side (q,); raises PlanError where they are no such sum."""
    degree = _degree(observation, setup)
    return [_sum(observation, setup, side, way, degree) for way in directions_of(observation.setups[setup])]


def joined(sums: list[Sum]) -> Sum:
    """Return the numbers of a reading as one vector, for the length of which all of them count."""
    curves = [
        BezierCurve(first.left, first.right, np.concatenate([c.control for c in (first, *others)], axis=2))
        for first, *others in zip(*(each.curves for each in sums), strict=True)
    ]
    return Sum(np.concatenate([each.parked for each in sums]), curves)


def _degree(observation: Observation, setup: int) -> int:
    """Return the degree of the polynomials."""
    for degree in _DEGREES:
        if all(_holds(observation, setup, side, degree) for side in sides(observation, setup)):
            return degree
    mounted = observation.setups[setup]
    what = 'no proof for readings anywhere: with "{setup}" errors do not simply add up axis by axis ({why})'
    remedy = "Leave --prove out, then the bound holds for the candidates; or let it move one linear axis only"
    raise PlanError(what, remedy, setup=mounted.name, why=_why(observation, mounted))


def _why(observation: Observation, mounted: Setup) -> str:
    machine = observation.machine
    turning = [machine.axes[k].name for k in mounted.moves if machine.axes[k].rotary]
    if turning:
        return said("{axes} turns" if len(turning) == 1 else "{axes} turn", axes=listed(said(" and "), turning))
    if mounted.standing:
        return said("a {instrument} looks another way at every place", instrument=mounted.instrument)
    together = [plane.name for plane in observation.errors.planes if set(plane.axes) <= set(mounted.moves)]
    if together and not any(term.angular for term in observation.errors.terms):
        return said("two of its axes act together, {errors}", errors=listed(said(" and "), together))
    return said("rotations act through lever arms")


def _holds(observation: Observation, setup: int, side: Array, degree: int) -> bool:
    """Return whether the sums are the rows, in poses all over the travels."""
    mounted, axes = observation.setups[setup], observation.machine.axes
    poses = np.tile(np.array(mounted.park), (_LOOKS, 1))
    for axis, share in zip(mounted.moves, even_points(_LOOKS, len(mounted.moves)).T, strict=True):
        low, high = mounted.span(axes[axis], axis)
        poses[:, axis] = low + (high - low) * share
    for way in directions_of(mounted):
        found = _sum(observation, setup, side, way, degree)
        true = observation.rows(setup, poses, np.tile(side, (_LOOKS, 1)), way).rows
        summed = found.at(poses[:, mounted.moves])
        if np.any(np.abs(summed - true) > _EXACT * np.abs(true).max(axis=0)):
            return False
    return True


def _sum(observation: Observation, setup: int, side: Array, way: Array | None, degree: int) -> Sum:
    mounted = observation.setups[setup]
    park = np.array(mounted.park)
    parked = observation.rows(setup, park[None], np.zeros((1, len(park))), way).rows[0]
    inner = (1 + nodes(degree + 1)) / 2
    to_control = np.linalg.inv(bernstein(degree, inner))
    curves = []
    for axis in mounted.moves:
        breaks = breaks_along(observation, axis, setup)
        left, right = breaks[:-1], breaks[1:]
        positions = (left[:, None] + np.diff(breaks)[:, None] * inner).ravel()
        poses, approaches = np.tile(park, (len(positions), 1)), np.zeros((len(positions), len(park)))
        poses[:, axis], approaches[:, axis] = positions, side[axis]
        added = observation.rows(setup, poses, approaches, way).rows - parked
        control = np.einsum("ij,bjn->bin", to_control, added.reshape(len(left), degree + 1, -1))
        curves.append(BezierCurve(left, right, control))
    return Sum(parked, curves)
