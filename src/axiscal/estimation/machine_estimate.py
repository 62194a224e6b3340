"""What is believed of one machine over one volume: all that a table can be made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from axiscal.accuracy.alignment import Alignment
from axiscal.belief import Belief
from axiscal.error_model.actual import deviation_of
from axiscal.error_model.model import ErrorModel
from axiscal.error_model.volume import EVERY_WAY, Box, Counted
from axiscal.machine.description import Machine
from axiscal.numerics import Array

_SILENT = 0.95


class Band(NamedTuple):
    """mean, std : (m,) or (m, 3) m or rad, the standard deviation with what no spline follows."""

    mean: Array
    std: Array


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Estimate:
    """A belief with what it is about.

    belief : over the machine's coefficients first, other unknowns after them
    box : the volume over which tables shall be good, bounds per axis in chain order, m or rad
    rests : posterior mean of the rest of every cell, (cells,), m, of each displacement that has one, by its index
    grid : positions of X and of Y, m, on which the height was read as a map; None where it was not
    sample : (m, q) poses spread over the part, where one is described; alignment : what probing it takes off
    counted : whether deviations along x, y and z of the workpiece frame count
    """

    model: ErrorModel
    belief: Belief
    box: Box
    grid: tuple[Array, Array] | None = None
    rests: Mapping[int, Array] = field(default_factory=lambda: MappingProxyType({}))
    sample: Array | None = None
    alignment: Alignment | None = None
    counted: Counted = EVERY_WAY

    @property
    def machine(self) -> Machine:
        """The machine."""
        return self.model.machine

    @property
    def mean(self) -> Array:
        """Posterior mean of the machine's coefficients, (size,)."""
        return self.belief.mean[: self.model.size]

    @property
    def factor(self) -> Array:
        """F (size, n) with F Fᵀ the posterior covariance of the machine's coefficients."""
        return self.belief.factor[: self.model.size]

    def curve(self, name: str, positions: Array) -> Band:
        """Return an error at positions of its axis, m or rad."""
        function = self.model.names[name]
        rows = function.basis.rows(positions)
        variances = np.sum((rows @ self.factor[function.columns]) ** 2, axis=1) + function.rest**2
        return Band(rows @ self.mean[function.columns], np.sqrt(variances))

    def sees(self, rows: Array) -> bool:
        """Return whether the readings say anything of the shape of a deviation, its mean taken off.  rows : (m, size)

        They do where its RMS standard deviation is less than beforehand by more than a twentieth.
        """
        shape = rows - rows.mean(axis=0)
        counts = np.any(shape, axis=0)
        shape = shape[:, counts]
        before, after = (np.linalg.norm(shape @ factor[counts]) for factor in (self.model.prior_root(), self.factor))
        return bool(after < _SILENT * before)

    def deviation(self, poses: Array, approaches: Array) -> Array:
        """Return the TCP deviation that is expected by the exact chain, (m, 3), m, workpiece frame.

        poses, approaches : (m, q)
        """
        expected = deviation_of(self.model, self.mean, poses, approaches).displacement
        if self.rests:
            levers = self.model.levers(poses)
            for index in self.rests:
                at = self.model.terms[index].coordinates(poses)
                expected = expected + self.rest_at(index, at)[:, None] * levers[index]
        return expected

    def rest_at(self, function: int, positions: Array) -> Array:
        """Return what the readings say of the rest of an error, (m,): nothing in cells not read.

        positions : of its axis, or pairs of both where it is one of two axes
        """
        if function not in self.rests:
            return np.zeros(len(positions))
        at_positions: Array = self.rests[function][self.model.terms[function].cells(positions)]
        return at_positions


def rest_means(errors: ErrorModel, cells: Mapping[tuple[int, int], float]) -> Mapping[int, Array]:
    """Return the mean of the rest in every cell, of displacements by the index of their error.

    cells : means of the rests of visited cells by (term, cell), m or rad
    """
    terms, found = errors.terms, dict[int, Array]()
    for (index, cell), mean in cells.items():
        if terms[index].kind == "motion" and not terms[index].angular:
            found.setdefault(index, np.zeros(terms[index].cell_count))[cell] = mean
    return MappingProxyType(found)
