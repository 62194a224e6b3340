"""What an instrument sees of the machine: rows over all unknowns, A of the machine and b of the set-ups.

y = g(t)ᵀ A + f(t)ᵀ b + v  (B&H eq. 29-30, and b). The columns are the machine's error coefficients, then the unknowns
of every set-up, then the rests of the cells that have been visited: readings in one cell share its rest, so repeating
there does not average it away.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from axiscal.error_model.model import ErrorModel
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.instruments.model import Place
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array

Cell = tuple[int, int]
"""Index of an error function with a rest, and the number of the cell along its axis."""

_NOT_FELT = 1e-12
"""A lever of this size is rounding: m/rad, 1, or rad/rad."""
_COINCIDE = 1e-12
"""Knots and edges of cells so close together, in lengths of travel, are one: they differ by rounding."""


class Rows(NamedTuple):
    """rows : (m, size) over all unknowns; variances : (m,) noise and the rests of cells not visited yet, m² or rad²."""

    rows: Array
    variances: Array


class Seen(NamedTuple):
    """The numbers of one reading.  rows : (k, size); variances : (k,); values : (k,), what is not linear taken off."""

    rows: Array
    variances: Array
    values: Array


@dataclass(frozen=True, eq=False)
class Observation:
    """The linear map from all unknowns to readings.

    errors : the machine's error model; setups : in the order of the campaign
    cells : column of the rest of each visited cell
    """

    errors: ErrorModel
    setups: tuple[Setup, ...]
    cells: Mapping[Cell, int] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.errors.size + sum(len(s.unknowns) for s in self.setups) + len(self.cells)

    def prior_covariance(self) -> Array:
        """Return the covariance of all unknowns before the first reading, (size, size)."""
        result = np.zeros((self.size, self.size))
        result[: self.errors.size, : self.errors.size] = self.errors.prior_covariance()
        own = [u.std**2 for s in self.setups for u in s.unknowns]
        rests = [self.errors.functions[function].rest ** 2 for function, _ in self.cells]
        tail = np.arange(self.errors.size, self.size)
        result[tail, tail] = own + rests
        return result

    def unknowns_of(self, setup: int) -> slice:
        """Return the columns of one set-up's own unknowns."""
        start = self.errors.size + sum(len(s.unknowns) for s in self.setups[:setup])
        return slice(start, start + len(self.setups[setup].unknowns))

    def rows(self, setup: int, poses: Array, approaches: Array, direction: Array | None = None) -> Rows:
        """Return what readings of a set-up would tell (B&H eq. 29-30).

        poses, approaches : (m, q); direction : (3,) of one number of a reading that has three; None for the set-up's
        """
        mounted = self.setups[setup]
        levers = self._levers(mounted, poses, direction)
        result = np.zeros((len(poses), self.size))
        result[:, : self.errors.size] = self.errors.along(levers, poses, approaches)
        model, place = INSTRUMENTS[mounted.instrument].model, self._place(mounted, poses)
        at = np.array(mounted.direction) if direction is None else direction
        for column, unknown in zip(_indices(self.unknowns_of(setup)), mounted.unknowns, strict=True):
            result[:, column] = model.own(mounted, unknown.name, at, place)
        variances = mounted.noise**2 + self._untold_sides(mounted, levers, poses, approaches)
        effects = self.errors.effects(levers, approaches) if self._with_rest else levers
        for index in self._with_rest:
            self._add_rest(index, effects[index], poses, result, variances)
        return Rows(result, variances)

    def reading(self, reading: Reading) -> Seen:
        """Return rows, variances and values of all numbers of a reading, of cells that are visited or not."""
        setup = next(i for i, mounted in enumerate(self.setups) if mounted.name == reading.setup)
        mounted, poses = self.setups[setup], np.array([reading.pose])
        approaches = np.array([reading.approach], dtype=float)
        parts = [self.rows(setup, poses, approaches, direction) for direction in directions_of(mounted)]
        rows, variances = np.concatenate([p.rows for p in parts]), np.concatenate([p.variances for p in parts])
        if reading.std is not None:
            variances = variances + (reading.std**2 - mounted.noise**2)
        return Seen(rows, variances, np.array(reading.values) - self.beyond(setup, poses)[0])

    def _untold_sides(self, mounted: Setup, levers: Array, poses: Array, approaches: Array) -> Array:
        """Return what it adds to the variance that nobody said from which side a moving axis came, (m,) m² or rad².

        A reversal then enters with +½ or −½ of its value, as likely one as the other.
        """
        added = np.zeros(len(poses))
        if np.all(approaches[:, list(mounted.moves)] != 0):
            return added
        for index, function in enumerate(self.errors.functions):
            if function.kind == "reversal" and function.axis in mounted.moves:
                rows = function.basis.rows(poses[:, function.axis])
                spread = np.einsum("mi,ij,mj->m", rows, function.covariance, rows) + function.rest**2
                added += np.where(approaches[:, function.axis] == 0, (levers[index] / 2) ** 2 * spread, 0.0)
        return added

    def beyond(self, setup: int, poses: Array) -> Array:
        """Return what readings show beyond rows times unknowns, where an instrument is not linear, (m,)."""
        mounted = self.setups[setup]
        return INSTRUMENTS[mounted.instrument].model.beyond(mounted, self._place(mounted, poses))

    def effects(self, setup: int, poses: Array, approaches: Array, direction: Array | None = None) -> Array:
        """Return what a unit of each error adds to readings, (functions, m); arguments as for `rows`."""
        return self.errors.effects(self._levers(self.setups[setup], poses, direction), approaches)

    def visited(self, pose: Array, setup: int | None = None) -> Observation:
        """Return the map with columns for the cells of a pose that had none, in the order of the functions.

        pose : (q,); setup : cells whose rest this set-up does not feel at the pose are left out
        """
        felt = self._with_rest if setup is None else self._felt(setup, pose)
        functions = self.errors.functions
        found = [(i, int(functions[i].cells(pose[functions[i].axis, None])[0])) for i in felt]
        fresh = [cell for cell in found if cell not in self.cells]
        added = {cell: self.size + position for position, cell in enumerate(fresh)}
        return replace(self, cells=MappingProxyType({**self.cells, **added}))

    def _felt(self, setup: int, pose: Array) -> tuple[int, ...]:
        mounted = self.setups[setup]
        each = [np.abs(self._levers(mounted, pose[None], d)[:, 0]) for d in directions_of(mounted)]
        levers = np.max(each, axis=0)
        return tuple(i for i in self._with_rest if levers[i] > _NOT_FELT)

    def rest_variances(self, after: Observation) -> Array:
        """Return the prior variances of the columns that `after` has beyond this map."""
        fresh = [cell for cell in after.cells if cell not in self.cells]
        return np.array([self.errors.functions[function].rest ** 2 for function, _ in fresh])

    def breaks(self, axis: int) -> Array:
        """Return the coordinates between which rows are smooth along an axis: knots, and edges of visited cells."""
        edges = [np.array(self.errors.machine.axes[axis].travel)]
        edges += [f.basis.knots for f in self.errors.functions if f.axis == axis]
        for index, cell in self.cells:
            function = self.errors.functions[index]
            if function.axis == axis:
                edges.append(function.basis.knots[0] + function.cell * np.array([cell, cell + 1]))
        low, high = edges[0]
        everywhere, shortest = np.unique(np.concatenate(edges)), _COINCIDE * (high - low)
        inside = everywhere[(everywhere > low + shortest) & (everywhere < high - shortest)]
        apart = np.diff(inside, prepend=low) > shortest
        return np.concatenate([[low], inside[apart], [high]])

    def smoothness(self, axis: int) -> tuple[int, float]:
        """Return polynomial degree and phase (rad) of the gain's forms on one interval of an axis.

        Rows are cubic; a lever arm adds one degree along a linear axis, and sine and cosine along a rotary one. Forms
        are squares.
        """
        if not self.errors.machine.axes[axis].rotary:
            angular = any(f.angular for f in self.errors.functions)
            return (8 if angular else 6), 0.0
        return 6, 2 * float(np.max(np.diff(self.breaks(axis))))

    @cached_property
    def _with_rest(self) -> tuple[int, ...]:
        return tuple(i for i, function in enumerate(self.errors.functions) if function.rest > 0)

    def _levers(self, mounted: Setup, poses: Array, direction: Array | None = None) -> Array:
        model, place = INSTRUMENTS[mounted.instrument].model, self._place(mounted, poses)
        towards = model.towards(mounted, np.array(mounted.direction) if direction is None else direction, place)
        levers = self.errors.levers(poses) if model.reads == "length" else self.errors.angular_levers(poses)
        along: Array = np.einsum("fmc,mc->fm", levers, towards)
        return along

    def _place(self, mounted: Setup, poses: Array) -> Place:
        return Place(self.errors.machine, poses, mounted.moves)

    def _add_rest(self, index: int, lever: Array, poses: Array, result: Array, variances: Array) -> None:
        function = self.errors.functions[index]
        cells = function.cells(poses[:, function.axis])
        known = np.zeros(len(poses), dtype=bool)
        for (owner, cell), column in self.cells.items():
            if owner == index:
                here = cells == cell
                result[here, column] = lever[here]
                known |= here
        variances[~known] += (lever[~known] * function.rest) ** 2


def directions_of(setup: Setup) -> list[Array | None]:
    """Return the directions of the numbers of one reading: the set-up's own, or x, y and z."""
    return list(np.eye(3)) if INSTRUMENTS[setup.instrument].values > 1 else [None]


def _indices(columns: slice) -> range:
    return range(columns.start, columns.stop)
