"""What is believed of one machine over one volume: all that a table can be made of."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from axiscal.errors.volume import EVERY_WAY, Alignment, Box, Counted, deviation_of
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine
from axiscal_core.normal import Normal

_SILENT = 0.95
Grid = tuple[Array, Array]
"""Positions of X and of Y, m, evenly spaced."""

_FEWEST = 3
"""Columns and rows below which there is no grid to speak of."""
_SHARE = 0.5
"""Share of the grid that was read; a map with more gaps than places is none."""
_ALONG = 0.99
"""Cosine: a bed is probed along z, and no set-up is between."""
_SAME = 1e-6
"""m; a probe does not stand better."""


class Band(NamedTuple):
    """mean, std : (m,) or (m, 3) m or rad, the standard deviation with what no spline follows."""

    mean: Array
    std: Array


class LeftUnknown(NamedTuple):
    """What is not known of the TCP over a volume, less what does not count, m: RMS, U of 95 %, and what U is to be."""

    rms: float = 0.0
    expanded: float = 0.0
    limit: float = math.inf

    def beside(self, left: float) -> float:
        """Return U where files leave some of the deviation as it is estimated: U² + (k left)².  left : RMS, m"""
        factor = self.expanded / self.rms if self.rms > 0 else BAND
        return float(np.hypot(self.expanded, factor * left))


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Estimate:
    """A belief with what it is about.

    belief : over the machine's coefficients first, other unknowns after them
    box : the volume over which tables shall be good, bounds per axis in chain order, m or rad
    rests : posterior mean of the rest of every cell, (cells,), m, of each displacement that has one, by its index
    grid : positions of X and of Y, m, on which the height was read as a map; None where it was not
    sample : (m, q) poses spread over the part, where one is described; alignment : what probing it takes off
    counted : whether deviations along x, y and z of the workpiece frame count
    read : from where to where each axis was read while it moved, in chain order; none where nobody says
    told : (axis, over) where a row of the answer tells how one moves over the other; whole : whether others count, too
    unknown : RMS and U of what is not known over the volume, m, as the answer has them; noughts where nobody said
    open : (size, n) root of what readings alone leave open, without causes of type B; None for all that the belief does
    """

    model: Machine
    belief: Normal
    box: Box
    grid: tuple[Array, Array] | None = None
    rests: Mapping[int, Array] = field(default_factory=dict)
    sample: Array | None = None
    alignment: Alignment | None = None
    counted: Counted = EVERY_WAY
    read: Box = ()
    told: frozenset[tuple[str, str]] = frozenset()
    whole: bool = True
    open: Array | None = None
    unknown: LeftUnknown = field(default_factory=LeftUnknown)

    @property
    def machine(self) -> Machine:
        """The machine."""
        return self.model

    @property
    def mean(self) -> Array:
        """Posterior mean of the machine's coefficients, (size,)."""
        return self.belief.mean[: self.model.size]

    @property
    def factor(self) -> Array:
        """F (size, n) with F Fᵀ the posterior covariance of the machine's coefficients."""
        return self.belief.factor[: self.model.size]

    @property
    def half_read(self) -> list[tuple[Axis, tuple[float, float]]]:
        """The axes of which half of a wanted volume or more was not read, and from where to where it was, m or rad."""
        found = zip(self.machine.axes, self.box, self.read, strict=True) if self.whole else ()
        stretches = ((axis, box, (max(box[0], read[0]), min(box[1], read[1]))) for axis, box, read in found)
        return [(axis, part) for axis, box, part in stretches if 2 * (part[1] - part[0]) <= box[1] - box[0]]

    def curve(self, name: str, positions: Array) -> Band:
        """Return an error at positions of its axis, m or rad."""
        function = self.model.by_name[name]
        rows = function.spline.rows(positions)
        variances = np.sum((rows @ self.factor[function.columns]) ** 2, axis=1) + function.rest**2
        return Band(rows @ self.mean[function.columns], np.sqrt(variances))

    def sees(self, rows: Array) -> bool:
        """Return whether the readings say anything of the shape of a deviation, its mean taken off.  rows : (m, size)

        They do where its RMS standard deviation is less than beforehand by more than a twentieth.
        """
        shape = rows - rows.mean(axis=0)
        counts = np.any(shape, axis=0)
        shape = shape[:, counts]
        before, after = (np.linalg.norm(shape @ factor[counts]) for factor in (self.model.root(), self.factor))
        return bool(after < _SILENT * before)

    def deviation(self, poses: Array, approaches: Array) -> Array:
        """Return the TCP deviation that is expected by the exact chain, (m, 3), m, workpiece frame.

        poses, approaches : (m, q)
        """
        return self._expected(poses, approaches, angular=False)

    def rotation(self, poses: Array, approaches: Array) -> Array:
        """Return the rotation of the tool that is expected by the exact chain, (m, 3), rad; arguments as above."""
        return self._expected(poses, approaches, angular=True)

    def _expected(self, poses: Array, approaches: Array, *, angular: bool) -> Array:
        expected: Array = deviation_of(self.model, self.mean, poses, approaches)[angular]
        if self.rests:
            levers = self.model.levers(poses, angular)
            for index in self.rests:
                at = self.model.terms[index].at(poses)
                expected = expected + self.rest_at(index, *at)[:, None] * levers[index]
        return expected

    def counting(self, poses: Array, deviations: Array) -> Array:
        """Return what counts of deviations (m, 3): less what probing the part takes off and one shift, (m, d)."""
        left = deviations if self.alignment is None else self.alignment.left(poses, deviations)
        counted: Array = (left - left.mean(axis=0))[:, list(self.counted)]
        return counted

    def rest_at(self, index: int, *at: Array) -> Array:
        """Return what the readings say of the rest of a term at positions of its axes, (m,): nothing in cells not read.

        index : of the term
        """
        return self.rests[index][self.model.terms[index].cells(*at)] if index in self.rests else np.zeros(len(at[0]))


def rest_means(errors: Machine, cells: Mapping[tuple[int, int], float]) -> Mapping[int, Array]:
    """Return the mean of the rest in every cell, of displacements by the index of their error.

    cells : means of the rests of visited cells by (term, cell), m or rad
    """
    terms, found = errors.terms, dict[int, Array]()
    for (index, cell), mean in cells.items():
        if terms[index].kind == "motion" and not terms[index].angular:
            found.setdefault(index, np.zeros(terms[index].cell_count))[cell] = mean
    return MappingProxyType(found)


def where_read(machine: Machine, read: Iterable[tuple[Sequence[int], Sequence[float]]]) -> Box:
    """Return from where to where each axis was read while it moved: all its travel where that is no stretch of it.

    An axis that goes round and round is read all around.  read : which axes moved, and the pose, of each reading
    """
    moved, found = [*read], list[tuple[float, float]]()
    for k, axis in enumerate(machine.axes):
        at = [pose[k] for moves, pose in moved if k in moves] or [0.0]
        found.append(axis.travel if axis.cyclic or max(at) - min(at) <= _SAME else (min(at), max(at)))
    return tuple(found)


def map_grid(machine: Machine, setups: Sequence[Setup], readings: Sequence[Reading]) -> Grid | None:
    """Return the grid of the readings along z while X and Y move; None where they lie on none.

    At least half of its nodes are read: a round bed has none in the corners.
    """
    names = [axis.name for axis in machine.axes]
    if not {"X", "Y"} <= set(names):
        return None
    sides = names.index("X"), names.index("Y")
    reading = {s.name for s in setups if set(sides) <= set(s.moves) and abs(s.direction[2]) > _ALONG}
    poses = np.array([r.pose for r in readings if r.setup in reading]).reshape(-1, len(names))
    x, y = (_levels(poses[:, side]) for side in sides)
    places = {tuple(place) for place in np.round(poses[:, sides] / _SAME).astype(int).tolist()}
    if min(len(x), len(y)) < _FEWEST or not (_even(x) and _even(y)):
        return None
    return (x, y) if len(places) >= _SHARE * len(x) * len(y) else None


def _levels(values: Array) -> Array:
    """Return the different values, increasing; those a micrometre apart are one."""
    ordered = np.sort(values)
    first = np.r_[True, np.diff(ordered) > _SAME][: len(ordered)]
    levels: Array = ordered[first]
    return levels


def _even(levels: Array) -> bool:
    steps = np.diff(levels)
    return bool(np.ptp(steps) < 1e-3 * np.mean(steps))
