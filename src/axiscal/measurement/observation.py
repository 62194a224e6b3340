"""What an instrument sees of the machine: rows over all unknowns, A of the machine and b of the set-ups.

y = g(t)ᵀ A + f(t)ᵀ b + v  (B&H eq. 29-30, and b). The columns are the machine's error coefficients, then the unknowns
of every set-up, then, as they come, the rests of the cells that have been visited and the drifts of zeros that wander:
readings in one cell share its rest, so repeating there does not average it away.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.error_model.model import ErrorModel
from axiscal.measurement.drift import Course
from axiscal.measurement.instrument import INSTRUMENTS, model_of
from axiscal.measurement.instruments.kind import Nominal
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.measurement.way import Way, feet
from axiscal.numerics import Array

Cell = tuple[int, int]
"""Index of an error function with a rest, and the number of the cell along its axis."""

Zero = tuple[int, int]
"""Index of a set-up, and the number of its zero: 0, or 0 to 2 where it reads along x, y and z."""

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


class JointRows(NamedTuple):
    """All numbers of readings of a set-up.  rows : (m, k, size); covariances : (m, k, k) of noise and fresh rests."""

    rows: Array
    covariances: Array


class RestEffect(NamedTuple):
    """How readings feel the rest of one error function.

    reach : (m,) what a unit of it adds; cells : (m,) the number of the cell that they are in
    """

    function: int
    reach: Array
    cells: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Observation:
    """The linear map from all unknowns to readings.

    errors : the machine's error model; setups : in the order of the campaign
    cells : column of the rest of each visited cell; courses : how each zero has wandered that may
    """

    errors: ErrorModel
    setups: tuple[Setup, ...]
    cells: Mapping[Cell, int] = field(default_factory=lambda: MappingProxyType({}))
    courses: Mapping[Zero, Course] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def size(self) -> int:
        """Number of unknowns."""
        wandering = sum(len(course.columns) for course in self.courses.values())
        return self.errors.size + sum(len(s.unknowns) for s in self.setups) + len(self.cells) + wandering

    def prior_covariance(self) -> Array:
        """Return the covariance of all unknowns before the first reading, (size, size)."""
        result = np.zeros((self.size, self.size))
        result[: self.errors.size, : self.errors.size] = self.errors.prior_covariance()
        own = [u.std**2 for s in self.setups for u in s.unknowns]
        tail = np.arange(self.errors.size, self.size)
        bare = replace(self, cells=MappingProxyType({}), courses=MappingProxyType({}))
        result[tail, tail] = [*own, *bare.rest_variances(self)]
        return result

    def unknowns_of(self, setup: int) -> slice:
        """Return the columns of one set-up's own unknowns."""
        start = self.errors.size + sum(len(s.unknowns) for s in self.setups[:setup])
        return slice(start, start + len(self.setups[setup].unknowns))

    def rows(
        self,
        setup: int,
        poses: Array,
        approaches: Array,
        direction: Array | None = None,
        time: float | None = None,
    ) -> Rows:
        """Return what readings of a set-up would tell (B&H eq. 29-30).

        poses, approaches : (m, q); direction : (3,) of one number of a reading that has three; None for the set-up's
        time : of the reading, s; None is the last time that was met
        """
        levers = self._levers(self.setups[setup], poses, direction)
        return self._told(setup, poses, approaches, direction, levers, time)

    def _told(
        self,
        setup: int,
        poses: Array,
        approaches: Array,
        direction: Array | None,
        levers: Array,
        time: float | None = None,
    ) -> Rows:
        mounted, result = self.setups[setup], np.zeros((len(poses), self.size))
        result[:, : self.errors.size] = self._error_rows(mounted, levers, poses, approaches)
        model, place = model_of(mounted), self._place(mounted, poses)
        at = np.array(mounted.direction) if direction is None else direction
        for column, unknown in zip(_indices(self.unknowns_of(setup)), mounted.unknowns, strict=True):
            result[:, column] = model.own(mounted, unknown.name, at, place)
        for course, share in self.wandering(setup, at):
            result[:, list(course.columns)] = share * course.row(time)
        variances = mounted.noise**2 + self._untold_sides(mounted, levers, poses, approaches)
        for felt in self._felt(mounted, levers, poses, approaches):
            self._add_rest(felt, result, variances)
        return Rows(result, variances)

    def _error_rows(self, mounted: Setup, levers: Array, poses: Array, approaches: Array) -> Array:
        if mounted.base is None:
            return self.errors.along(levers, poses, approaches)
        return Way(self.errors, mounted, mounted.base).rows(poses)

    def numbers(self, setup: int, poses: Array, approaches: Array) -> JointRows:
        """Return what readings of a set-up would tell with all their numbers; arguments as for `rows`.

        The rest of a cell not visited yet shows in all numbers of a reading at once.
        """
        mounted, directions = self.setups[setup], directions_of(self.setups[setup])
        if len(directions) == 1:
            alone = self.rows(setup, poses, approaches)
            return JointRows(alone.rows[:, None], alone.variances[:, None, None])
        field = self._field(mounted, poses)
        levers = [self._towards(mounted, poses, direction, field) for direction in directions]
        parts = [self._told(setup, poses, approaches, d, along) for d, along in zip(directions, levers, strict=True)]
        covariances = np.zeros((len(poses), len(parts), len(parts)))
        each = [self._felt(mounted, along, poses, approaches) for along in levers]
        for felt in zip(*each, strict=True):
            fresh = self.cell_columns(felt[0].function)[felt[0].cells] < 0
            reach = np.stack([f.reach for f in felt], axis=1) * self.errors.functions[felt[0].function].rest
            covariances += np.where(fresh, 1.0, 0.0)[:, None, None] * reach[:, :, None] * reach[:, None, :]
        every = np.arange(len(parts))
        covariances[:, every, every] = np.stack([part.variances for part in parts], axis=1)
        return JointRows(np.stack([part.rows for part in parts], axis=1), covariances)

    def reading(self, reading: Reading) -> Seen:
        """Return rows, variances and values of all numbers of a reading, of cells that are visited or not."""
        setup = next(i for i, mounted in enumerate(self.setups) if mounted.name == reading.setup)
        mounted, poses = self.setups[setup], np.array([reading.pose])
        approaches = np.array([reading.approach], dtype=float)
        parts = [self.rows(setup, poses, approaches, d, reading.time) for d in directions_of(mounted)]
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
        return model_of(mounted).beyond(mounted, self._place(mounted, poses))

    def effects(self, setup: int, poses: Array, approaches: Array, direction: Array | None = None) -> Array:
        """Return what a unit of each error adds to readings, (functions, m); arguments as for `rows`.

        Where two feet stand on a way: of two units, one at each of them and independent.
        """
        mounted = self.setups[setup]
        effects = self.errors.effects(self._levers(mounted, poses, direction), approaches)
        if mounted.base:
            straight = [f.kind == "motion" for f in self.errors.functions]
            effects[straight] *= float(np.sqrt(2.0)) / mounted.base
        return effects

    def felt(self, setup: int, poses: Array, approaches: Array, direction: Array | None = None) -> list[RestEffect]:
        """Return how readings feel the rests, of cells that were visited or not; arguments as for `rows`."""
        mounted = self.setups[setup]
        return self._felt(mounted, self._levers(mounted, poses, direction), poses, approaches)

    def felt_by_all(
        self, setup: int, poses: Array, approaches: Array, direction: Array | None = None
    ) -> list[RestEffect]:
        """Return how readings would feel the rests if every error had one."""
        mounted, everyone = self.setups[setup], range(len(self.errors.functions))
        return self._felt(mounted, self._levers(mounted, poses, direction), poses, approaches, everyone)

    def _felt(
        self, mounted: Setup, levers: Array, poses: Array, approaches: Array, among: Sequence[int] | None = None
    ) -> list[RestEffect]:
        functions, found = self.errors.functions, list[RestEffect]()
        wanted = self._with_rest if among is None else among
        effects = self.errors.effects(levers, approaches) if wanted else levers
        for i in wanted:
            at = poses[:, functions[i].axis]
            if mounted.base is None:
                found.append(RestEffect(i, effects[i], functions[i].cells(at)))
            elif mounted.base and np.any(effects[i]):  # a base without length is refused where its way has a rest
                stands = feet(mounted.base)
                found += [
                    RestEffect(i, foot.weight * effects[i], functions[i].cells(at + foot.shift)) for foot in stands
                ]
        return found

    def visited(self, pose: Array, setup: int | None = None, time: float | None = None) -> Observation:
        """Return the map with columns for the cells of a pose that had none, in the order of the functions.

        pose : (q,); setup : cells whose rest this set-up does not feel at the pose are left out
        time : of the reading, s, up to which the zeros of the set-up may have wandered
        """
        if setup is not None and time is not None and self.setups[setup].drift > 0:
            return self._wandered(setup, time).visited(pose, setup)
        fresh = [cell for cell in self._cells_at(pose, setup) if cell not in self.cells]
        added = {cell: self.size + position for position, cell in enumerate(fresh)}
        return replace(self, cells=MappingProxyType({**self.cells, **added}))

    def _cells_at(self, pose: Array, setup: int | None) -> Iterable[Cell]:
        """Return the cells that a pose lies in, of those rests that the set-up feels there."""
        functions = self.errors.functions
        if setup is None:
            return [(i, int(functions[i].cells(pose[functions[i].axis, None])[0])) for i in self._with_rest]
        mounted, poses = self.setups[setup], pose[None]
        levers = [self._levers(mounted, poses, direction) for direction in directions_of(mounted)]
        felt = self._felt(mounted, np.max(np.abs(levers), axis=0), poses, np.ones_like(poses))
        return dict.fromkeys((f.function, int(f.cells[0])) for f in felt if abs(f.reach[0]) > _NOT_FELT)

    def _wandered(self, setup: int, time: float) -> Observation:
        """Return the map with columns for what a set-up's zeros may have drifted until a time, s."""
        mounted, courses, size = self.setups[setup], dict(self.courses), self.size
        for number in range(INSTRUMENTS[mounted.instrument].values):
            before = courses.get((setup, number))
            if before is None:
                courses[setup, number] = Course.begun(mounted.drift, time, size)
                size += 1
            elif before.needs_node(time):
                courses[setup, number] = before.with_node(time, size)
                size += 2
        return replace(self, courses=MappingProxyType(courses))

    def wandering(self, setup: int, direction: Array) -> Iterator[tuple[Course, float]]:
        """Yield the drifts that a reading along a direction shows, each with its share."""
        three = INSTRUMENTS[self.setups[setup].instrument].values > 1
        for (owner, number), course in self.courses.items():
            if owner == setup:
                yield course, float(direction[number]) if three else 1.0

    def rest_variances(self, after: Observation) -> Array:
        """Return the prior variances of the columns that `after` has beyond this map: rests, and drifts of 1."""
        result = np.ones(after.size - self.size)
        for cell, column in after.cells.items():
            if cell not in self.cells:
                result[column - self.size] = self.errors.functions[cell[0]].rest ** 2
        return result

    def breaks(self, axis: int, setup: int) -> Array:
        """Return the coordinates between which a set-up's rows are smooth along an axis: knots, edges of visited cells.

        Where it has feet they stand on these, aside of its position.
        """
        edges = [f.basis.knots for f in self.errors.functions if f.axis == axis]
        for index, cell in self.cells:
            function = self.errors.functions[index]
            if function.axis == axis:
                edges.append(function.basis.knots[0] + function.cell * np.array([cell, cell + 1]))
        return self._between(axis, setup, edges)

    def knots(self, axis: int, setup: int) -> Array:
        """Return the same without the edges of cells."""
        return self._between(axis, setup, [f.basis.knots for f in self.errors.functions if f.axis == axis])

    def _between(self, axis: int, setup: int, edges: list[Array]) -> Array:
        """Return the edges as they meet a set-up's feet, sorted, within where it can be read, with the ends of that."""
        mounted, shifts = self.setups[setup], np.zeros(1)
        low, high = mounted.span(self.errors.machine.axes[axis], axis)
        if mounted.base and axis in mounted.moves:
            shifts = np.array([foot.shift for foot in feet(mounted.base)])
        everywhere = np.unique(np.concatenate([np.zeros(0), *edges])[:, None] - shifts)
        shortest = _COINCIDE * (high - low)
        inside = everywhere[(everywhere > low + shortest) & (everywhere < high - shortest)]
        apart = np.diff(inside, prepend=low) > shortest
        return np.concatenate([[low], inside[apart], [high]])

    def smoothness(self, axis: int, setup: int) -> tuple[int, float]:
        """Return polynomial degree and phase (rad) of the gain's forms on one interval of an axis.

        Rows are cubic; a lever arm adds one degree along a linear axis, and sine and cosine along a rotary one. Forms
        are squares, and products of as many as a reading has numbers.
        """
        times = INSTRUMENTS[self.setups[setup].instrument].values
        if not self.errors.machine.axes[axis].rotary:
            angular = any(f.angular for f in self.errors.functions)
            return times * (8 if angular else 6), 0.0
        return 6 * times, 2 * times * float(np.max(np.diff(self.breaks(axis, setup))))

    @cached_property
    def _with_rest(self) -> tuple[int, ...]:
        return tuple(i for i, function in enumerate(self.errors.functions) if function.rest > 0)

    def _levers(self, mounted: Setup, poses: Array, direction: Array | None = None) -> Array:
        if mounted.base is not None:
            return Way(self.errors, mounted, mounted.base).levers(poses)
        return self._towards(mounted, poses, direction, self._field(mounted, poses))

    def _field(self, mounted: Setup, poses: Array) -> Array:
        """Return what a unit of each error does in all directions, (functions, m, 3)."""
        reads = model_of(mounted).reads
        return self.errors.levers(poses) if reads == "length" else self.errors.angular_levers(poses)

    def _towards(self, mounted: Setup, poses: Array, direction: Array | None, field: Array) -> Array:
        at = np.array(mounted.direction) if direction is None else direction
        towards = model_of(mounted).towards(mounted, at, self._place(mounted, poses))
        along: Array = np.einsum("fmc,mc->fm", field, towards)
        return along

    def _place(self, mounted: Setup, poses: Array) -> Nominal:
        return Nominal(self.errors.machine, poses, mounted.moves)

    def cell_columns(self, function: int) -> NDArray[np.intp]:
        """Return the column of the rest of every cell of a function, -1 where there is none."""
        return self._columns_of_cells[function]

    @cached_property
    def _columns_of_cells(self) -> dict[int, NDArray[np.intp]]:
        functions, columns = self.errors.functions, dict[int, NDArray[np.intp]]()
        for i in self._with_rest:
            columns[i] = np.full(functions[i].cell_count, -1)
        for (owner, cell), column in self.cells.items():
            columns[owner][cell] = column
        return columns

    def _add_rest(self, felt: RestEffect, result: Array, variances: Array) -> None:
        columns = self.cell_columns(felt.function)[felt.cells]
        known = np.flatnonzero(columns >= 0)
        result[known, columns[known]] += felt.reach[known]
        rest = self.errors.functions[felt.function].rest
        variances += np.where(columns >= 0, 0.0, (felt.reach * rest) ** 2)


def directions_of(setup: Setup) -> list[Array | None]:
    """Return the directions of the numbers of one reading: the set-up's own, or x, y and z."""
    return list(np.eye(3)) if INSTRUMENTS[setup.instrument].values > 1 else [None]


def _indices(columns: slice) -> range:
    return range(columns.start, columns.stop)
