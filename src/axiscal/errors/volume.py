"""Means over the working volume, E[H] and E[HᵀH], over poses spread evenly in it.

A rigid motion of the part is not an error: the part is aligned by probing before it is machined. Alignment with
T(p) = [I, −(p − p̄)×] (3 × 6) leaves H − T E[TᵀT]⁻¹ E[TᵀH] of H, and of the mean variance

    W = E[HᵀH] − E[TᵀH]ᵀ E[TᵀT]⁻¹ E[TᵀH].

Deviations of the machine as it is, not to first order, follow from the exact chain.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from axiscal.machine.kinematics import Deviation, actual_deviation, small_motions
from axiscal.numerics import Array
from axiscal_core import rigid
from axiscal_core.machine import Machine
from axiscal_core.points import even_points

_BLOCK = 1000
"""Rows at once: of memory, not of the result."""
_NO_MOTION = 1e-12
"""Share of the largest motion from which on one is none: of a part that is a point, or a line."""


def deviation_of(model: Machine, coefficients: Array, poses: Array, approaches: Array) -> Deviation:
    """Return how the tool deviates by the exact chain.  coefficients : (size,); poses, approaches : (m, q)."""
    return actual_deviation(model, poses, small_motions(model, coefficients, poses, approaches))


Box = tuple[tuple[float, float], ...]
Counted = tuple[bool, bool, bool]
"""Whether deviations along x, y and z of the workpiece frame count."""
EVERY_WAY: Counted = (True, True, True)


@dataclass(frozen=True, eq=False, slots=True)
class VolumeMoments:
    """Means over the volume; with H the rows of the directions that count, P H.

    mean : (3, size) E[H], of every direction; gram : (size, size) E[HᵀPH]
    squares : (terms,) E|P h|², h what a unit of a term does to the TCP, no alignment taken off: what is as fine as a
        rest, a step or a twist is none of the part's rigid motion
    counted : the directions that count
    """

    mean: Array
    gram: Array
    squares: Array
    counted: Counted = EVERY_WAY


def whole_travel(model: Machine) -> Box:
    """Return the box of all travels, bounds per axis in chain order, m or rad."""
    return tuple(axis.travel for axis in model.axes)


def even_poses(box: Box, count: int) -> Array:
    """Return so many poses spread evenly in a box, (count, q)."""
    low, high = np.array(box).T
    return np.asarray(low + (high - low) * even_points(count, len(low)))


@dataclass(frozen=True, eq=False)
class Alignment:
    """What probing the part takes off.

    poses : (m, q) over which it is aligned, spread evenly; counted : the directions in which it is, x, y and z
    """

    errors: Machine
    poses: Array
    counted: Counted = EVERY_WAY

    @cached_property
    def _counts(self) -> Array:
        return np.array(self.counted, dtype=float)[:, None]

    @cached_property
    def _middle(self) -> Array:
        return np.asarray(self.errors.frames(self.poses).tcp.mean(axis=0), dtype=np.float64)

    def motions(self, poses: Array) -> Array:
        """Return T at poses, (m, 3, 6): what shifts and turns of the part do to the tool point."""
        away = self.errors.frames(poses).tcp - self._middle
        shifts = np.broadcast_to(np.eye(3), (len(poses), 3, 3))
        return np.concatenate([shifts, -rigid.skew(away)], axis=2)

    @cached_property
    def _found(self) -> Array:
        """The rigid motion of the part in each error, (6, size)."""
        motion = (self.motions(self.poses) * self._counts).reshape(-1, 6)
        crossed = np.zeros((6, self.errors.size))
        for at in range(0, len(self.poses), _BLOCK):
            part = self.poses[at : at + _BLOCK]
            rows = self.errors.rows_at(part, np.zeros_like(part)).reshape(-1, self.errors.size)
            crossed += motion[3 * at : 3 * (at + _BLOCK)].T @ rows
        return np.asarray(np.linalg.lstsq(motion.T @ motion, crossed, rcond=_NO_MOTION)[0], dtype=np.float64)

    def taken_off(self, poses: Array) -> Array:
        """Return what is taken off the rows at poses, (m, 3, size)."""
        return self.motions(poses) @ self._found

    def left(self, poses: Array, deviations: Array) -> Array:
        """Return deviations (m, 3) without their own rigid motion, found at the same poses, m."""
        motion = self.motions(poses)
        seen = (motion * self._counts).reshape(-1, 6)
        moved = np.linalg.lstsq(seen, (deviations * self._counts[:, 0]).ravel(), rcond=None)[0]
        return deviations - motion @ moved


def volume_moments(
    errors: Machine, poses: Array, alignment: Alignment | None = None, counted: Counted = EVERY_WAY
) -> VolumeMoments:
    """Return the means over poses, from both directions evenly; what an alignment takes off is taken off.

    poses : (m, q), spread evenly over the volume, those over which the part is aligned
    """
    mean, gram, squares = np.zeros((3, errors.size)), np.zeros((errors.size,) * 2), np.zeros(len(errors.terms))
    ways, sides = list(counted), reversals_of(errors)
    for at in range(0, len(poses), _BLOCK):
        part = poses[at : at + _BLOCK]
        levers = errors.levers(part).transpose(2, 0, 1)
        middle, above = (errors.along(levers, part, np.full_like(part, side)) for side in (0.0, 1.0))
        left = middle if alignment is None else middle - alignment.taken_off(part).swapaxes(0, 1)
        rows = left[ways].reshape(-1, errors.size)
        mean += left.sum(axis=1)
        gram += rows.T @ rows
        squares += np.sum(levers[ways] ** 2, axis=(0, 2))
        for columns in sides:
            own = (above[:, :, columns] - middle[:, :, columns])[ways].reshape(-1, len(columns))
            gram[np.ix_(columns, columns)] += own.T @ own
    if alignment is not None:
        mean[:] = 0.0
    count = len(poses)
    return VolumeMoments(mean / count, gram / count, squares / count, counted)


def reversals_of(model: Machine) -> list[list[int]]:
    """Return the columns of the reversals of each axis: the side of one axis says nothing of another's."""
    found = dict[int, list[int]]()
    for term in model.curves:
        if term.kind == "reversal":
            found.setdefault(term.axis, []).extend(range(term.columns.start, term.columns.stop))
    return [*found.values()]
