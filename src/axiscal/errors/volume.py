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
from numpy.typing import NDArray

from axiscal.machine.kinematics import Deviation, actual_deviation, small_motions
from axiscal.numerics import Array, even_subset
from axiscal.numerics.remembered import remembered
from axiscal_core import rigid
from axiscal_core.criterion import root_of_gram
from axiscal_core.machine import Machine
from axiscal_core.points import even_points

_BLOCK = 1000
"""Rows at once: of memory, not of the result."""
_INNER_POINTS = 400
"""Poses of a volume at which it is looked at."""
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
    """

    mean: Array
    gram: Array
    squares: Array


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


def reversals_of(model: Machine) -> list[list[int]]:
    """Return the columns of the reversals of each axis: the side of one axis says nothing of another's."""
    found = dict[int, list[int]]()
    for term in model.curves:
        if term.kind == "reversal":
            found.setdefault(term.axis, []).extend(range(term.columns.start, term.columns.stop))
    return [*found.values()]


@dataclass(frozen=True, eq=False)
class Volume:
    """What of a volume does not depend on how large errors are.

    sample : (m, q) poses spread evenly over it, over which the part is aligned; counted : the directions that count
    alignment : what probing the part takes off; ends : (e, q) where it may be worst besides
    """

    errors: Machine
    sample: Array
    counted: Counted = EVERY_WAY
    alignment: Alignment | None = None
    ends: Array | None = None

    @cached_property
    def moments(self) -> VolumeMoments:
        """The means over it, from both directions evenly; what an alignment takes off is taken off."""
        errors, ways, sides = self.errors, list(self.counted), reversals_of(self.errors)
        mean, gram, squares = np.zeros((3, errors.size)), np.zeros((errors.size,) * 2), np.zeros(len(errors.terms))
        for at in range(0, len(self.sample), _BLOCK):
            part = self.sample[at : at + _BLOCK]
            levers = errors.levers(part).transpose(2, 0, 1)
            middle, above = (errors.along(levers, part, np.full_like(part, side)) for side in (0.0, 1.0))
            left = middle if self.alignment is None else middle - self.alignment.taken_off(part).swapaxes(0, 1)
            rows = left[ways].reshape(-1, errors.size)
            mean += left.sum(axis=1)
            gram += rows.T @ rows
            squares += np.sum(levers[ways] ** 2, axis=(0, 2))
            for columns in sides:
                own = (above[:, :, columns] - middle[:, :, columns])[ways].reshape(-1, len(columns))
                gram[np.ix_(columns, columns)] += own.T @ own
        if self.alignment is not None:
            mean[:] = 0.0
        count = len(self.sample)
        return VolumeMoments(mean / count, gram / count, squares / count)

    @remembered
    def root(self, zeroed: Counted) -> Array:
        """Return V (r, size), VᵀV = E[HᵀH], less E[H]ᵀE[H] in directions where a constant shift does not count."""
        shifts = self.moments.mean[np.logical_and(zeroed, self.counted)]
        return root_of_gram(self.moments.gram - shifts.T @ shifts)

    @cached_property
    def inside(self) -> Array:
        """The poses at which it is looked at that are spread evenly: any of them stands for as much of it, (n, q)."""
        whole = self.ends is not None  # a box, of which the first so many are as even as all
        return self.sample[:_INNER_POINTS] if whole else self.sample[even_subset(self.sample, _INNER_POINTS)]

    @cached_property
    def places(self) -> Array:
        """All of these poses, once each, (m, q)."""
        return self.inside if self.ends is None else np.concatenate([self.ends, self.inside])

    @cached_property
    def poses(self) -> tuple[Array, Array]:
        """The same and the sides from which their axes come, (m, q) each."""
        poses = self.places
        if not self.errors.reversing:
            return poses, np.ones_like(poses)
        return np.concatenate([poses, poses]), np.concatenate([np.ones_like(poses), -np.ones_like(poses)])

    @cached_property
    def evenly(self) -> NDArray[np.bool_]:
        """Which of them are spread evenly: all but its ends, (m,)."""
        places = np.arange(len(self.places)) >= len(self.places) - len(self.inside)
        return np.tile(places, len(self.poses[0]) // len(places))

    @cached_property
    def rows(self) -> Array:
        """H at each of them, (m, 3, size)."""
        rows: Array = self.errors.rows_at(*self.poses)
        return rows if self.alignment is None else rows - self.alignment.taken_off(self.poses[0])

    @cached_property
    def levers(self) -> Array:
        """What a unit of each rest does there, (m, 3, terms)."""
        return self.errors.levers(self.poses[0]).transpose(1, 2, 0)
