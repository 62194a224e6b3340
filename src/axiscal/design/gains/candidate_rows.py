"""A lattice of candidates with its rows, kept in memory or made anew block by block where that would be too much.

A candidate has as many rows as its instrument gives numbers, one after another: one, or one each along x, y and z.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.design.gains.covariance import Covariance
from axiscal.design.gains.gain import Scorer
from axiscal.design.gains.rests_in_cells import RestsInCells
from axiscal.design.gains.three_values import SharedReadings
from axiscal.measurement.cells import RestEffects, add_rests
from axiscal.measurement.drift import Course
from axiscal.measurement.observation import Observation, directions_of
from axiscal.measurement.place import Places
from axiscal.measurement.reading_rows import numbers_of_setups
from axiscal.measurement.visits import cells_shown, with_cells
from axiscal.numerics import Array

_BLOCK = 4096
"""Rows made at once: of memory, not of the result."""
_NEAR = 81920
"""Numbers of rows that stay in the cache while they are multiplied: of speed, not of the result."""
_FEW = 6
"""Columns up to which one product each is faster: of speed, not of the result."""
MEMORY = 1e9
"""Bytes that the rows of a lattice may take unless said otherwise."""


@dataclass(frozen=True, eq=False, slots=True)
class _Block:
    """Candidates of one set-up.

    candidates, numbers : slices of the pool's candidates and of their numbers; rests : what those of cells do to them
    rows : (numbers, c) over the unknowns that one of them feels, None where they are made anew; felt : (c,) which
    shown : by candidate, the cells that a reading there opens
    """

    setup: int
    candidates: slice
    numbers: slice
    rows: Array | None
    felt: NDArray[np.intp]
    rests: RestsInCells
    shown: RestEffects


class Forms(NamedTuple):
    """Numerator and denominator of the gains of a pool's candidates.

    above, below : (numbers,) of each number alone; joint : what those of one reading have in common
    """

    above: Array
    below: Array
    joint: SharedReadings


class Pool:
    """The candidates of a lattice, sorted by set-up.

    memory : bytes that the rows may take; beyond it they are made anew for every product, at the cost of time
    values : (M,) numbers of each candidate; first : (M,) index of its first one; count : of all numbers
    """

    def __init__(self, observation: Observation, lattice: Places, memory: float = MEMORY) -> None:
        self.lattice = lattice.within(np.argsort(lattice.setups, kind="stable"))
        self._bare = observation.bare
        self.size = self._bare.size
        self.noise = np.array([observation.setups[s].noise ** 2 for s in self.lattice.setups])
        self.values = numbers_of_setups(observation.setups)[self.lattice.setups]
        self.first = np.cumsum(self.values) - self.values
        self.count = int(self.values.sum())
        self.bytes = 8.0 * self.count * self.size
        self.memory, self._kept = memory, self.bytes <= memory
        self._blocks = [self._block(setup, where) for setup, where in self._slices()]

    def __len__(self) -> int:
        return len(self.lattice)

    @property
    def scalar(self) -> bool:
        """Whether every candidate has one number."""
        return self.count == len(self)

    @property
    def none(self) -> Places:
        """None of them, for a search that begins with no plan."""
        return self.lattice.within(slice(0, 0))

    def products(self, observation: Observation, vectors: Array) -> Array:
        """Return the rows of all candidates times vectors (n, c) over the observation's unknowns, (numbers, c).

        With few vectors each row is fetched from memory once and used for all of them while it is near.
        """
        result = np.empty((vectors.shape[1], self.count))
        columns = np.ascontiguousarray(vectors.T)
        for block in self._blocks:
            rows, into = self._rows(block), result[:, block.numbers]
            if len(columns) > _FEW:
                into[:] = columns[:, block.felt] @ rows.T
            else:
                _dotted(rows, columns[:, block.felt], into)
        for block in self._blocks:
            self._add_cells_and_drifts(block, observation, columns, result[:, block.numbers])
        return result.T

    def _add_cells_and_drifts(self, block: _Block, observation: Observation, columns: Array, into: Array) -> None:
        """Add what visited cells and drifts do, in place.  columns : (c, n); into : (c, numbers)."""
        block.rests.add(observation, columns, into)
        for number, course, share in self._drifts(observation, block.setup):
            moved = share * (columns[:, list(course.columns)] @ course.rows()[0])
            into[:, number :: self._values(block)] += moved[:, None]

    def squares(self, observation: Observation, vectors: Array) -> Array:
        """Return the squared lengths of each candidate's rows times vectors (n, c), all its numbers together, (M,)."""
        result = np.empty(len(self))
        columns = np.ascontiguousarray(vectors.T)
        for block in self._blocks:
            seen = columns[:, block.felt] @ self._rows(block).T
            self._add_cells_and_drifts(block, observation, columns, seen)
            result[block.candidates] = np.einsum("ij,ij->j", seen, seen).reshape(-1, self._values(block)).sum(axis=1)
        return result

    def forms(self, scorer: Scorer) -> Forms:
        """Return numerator and denominator of the gain of every candidate."""
        above, below, joints = np.empty(self.count), np.empty(self.count), []
        for block in self._blocks:
            part = self.lattice.poses[block.candidates], self.lattice.approaches[block.candidates]
            seen = scorer.observation.numbers(block.setup, *part)
            n, m = scorer.split_all(seen)
            every = np.arange(self._values(block))
            above[block.numbers], below[block.numbers] = n[:, every, every].ravel(), m[:, every, every].ravel()
            if len(every) > 1:
                first = block.numbers.start + len(every) * np.arange(len(n))
                joints.append(SharedReadings.alike(first, n, m))
        return Forms(above, below, SharedReadings.of(joints))

    def gains(self, above: Array, below: Array, joint: SharedReadings) -> Array:
        """Return the gain of every candidate, (M,), from the forms.  above, below : (numbers and more,)"""
        if self.scalar:
            alone: Array = above[: self.count] / below[: self.count]
            return alone
        result: Array = above[self.first] / below[self.first]
        result[self.values > 1] = joint.gains(above, below)
        return result

    def scorer(self, state: Covariance) -> Scorer:
        """Return the gains under a state, as if no cell had been visited."""
        factor = state.factor[: self.size]
        if factor.shape[1] > self.size:
            factor = np.asarray(np.linalg.qr(factor.T, mode="r")).T
        return replace(state, observation=self._bare, factor=factor).scorer()

    def rows(self, observation: Observation, index: int) -> Array:
        """Return the rows of a candidate whose cells have columns as far as their rests show in it, (k, n)."""
        block = self._block_of(index)
        count = self._values(block)
        inside = count * (index - block.candidates.start) + np.arange(count)
        result = np.zeros((count, observation.size))
        result[:, block.felt] = self._rows(block)[inside]
        effects = block.rests.effects
        of = RestEffects(effects.functions, effects.reach[:, inside], effects.cells[:, inside])
        add_rests(of, np.zeros(len(of.functions)), observation.cell_columns.at(of), result, np.zeros(count))
        for number, course, share in self._drifts(observation, block.setup):
            result[number, list(course.columns)] += share * course.rows()[0]
        return result

    def opened(self, observation: Observation, index: int) -> Observation:
        """Return the map with columns for the cells that a reading at a candidate opens."""
        block = self._block_of(index)
        inside = index - block.candidates.start
        cells = block.shown.cells[:, inside][block.shown.reach[:, inside] > 0]
        functions = block.shown.functions[block.shown.reach[:, inside] > 0]
        return with_cells(observation, zip(functions.tolist(), cells.tolist(), strict=True))

    def _block_of(self, index: int) -> _Block:
        return next(b for b in self._blocks if b.candidates.start <= index < b.candidates.stop)

    def _drifts(self, observation: Observation, setup: int) -> Iterator[tuple[int, Course, float]]:
        """Yield the drifts that each number of a set-up's readings shows, with their shares."""
        mounted = observation.setups[setup]
        for number, direction in enumerate(directions_of(mounted)):
            along = np.array(mounted.direction) if direction is None else direction
            for course, share in observation.drifts_shown(setup, along):
                yield number, course, share

    def _values(self, block: _Block) -> int:
        return int(self.values[block.candidates.start])

    def _slices(self) -> Iterator[tuple[int, slice]]:
        for setup in np.unique(self.lattice.setups):
            mine = np.flatnonzero(self.lattice.setups == setup)
            for start in range(int(mine[0]), int(mine[-1]) + 1, _BLOCK):
                yield int(setup), slice(start, min(start + _BLOCK, int(mine[-1]) + 1))

    def _block(self, setup: int, candidates: slice) -> _Block:
        first, count = int(self.first[candidates.start]), int(self.values[candidates].sum())
        shown = cells_shown(self._bare, setup, self.lattice.poses[candidates])
        rests, every = self._rests(setup, candidates), np.arange(self.size)
        block = _Block(setup, candidates, slice(first, first + count), None, every, rests, shown)
        if not self._kept:
            return block
        rows = self._rows(block)
        felt = np.flatnonzero(np.any(rows != 0, axis=0))
        return replace(block, rows=np.ascontiguousarray(rows[:, felt]), felt=felt)

    def _rests(self, setup: int, candidates: slice) -> RestsInCells:
        """Return what the rests do to the numbers of some candidates, those of one candidate beside each other."""
        part = self.lattice.poses[candidates], self.lattice.approaches[candidates]
        each = self._bare.rest_effects(setup, *part)
        reach = np.stack([one.reach for one in each], axis=2).reshape(each[0].reach.shape[0], len(each) * len(part[0]))
        cells = np.repeat(each[0].cells, len(each), axis=1)
        return RestsInCells.of(self._bare, RestEffects(each[0].functions, reach, cells))

    def _rows(self, block: _Block) -> Array:
        if block.rows is not None:
            return block.rows
        part = self.lattice.poses[block.candidates], self.lattice.approaches[block.candidates]
        each = [seen.rows for seen in self._bare.rows_each(block.setup, *part)]
        return each[0] if len(each) == 1 else np.stack(each, axis=1).reshape(-1, self.size)


def _dotted(rows: Array, columns: Array, into: Array) -> None:
    """Multiply a few rows at a time with every vector.  rows : (m, n); columns : (c, n); into : (c, m)."""
    height = max(1, _NEAR // max(rows.shape[1], 1))
    for start in range(0, len(rows), height):
        part = rows[start : start + height]
        for column, sums in zip(columns, into, strict=True):
            np.dot(part, column, out=sums[start : start + height])
