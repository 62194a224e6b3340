"""A lattice of candidates with its rows, kept in memory or made anew block by block where that would be too much.

A candidate has as many rows as its instrument gives numbers, one after another: one, or one each along x, y and z.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.cells import Course, RestEffects, add_rests
from axiscal.measurement.observation import Observation, directions_of
from axiscal.measurement.reading import Places
from axiscal.measurement.reading_rows import cells_shown, numbers_of_setups, with_cells
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import sparse_product
from axiscal.numerics.remembered import remembered
from axiscal.planning.gains.covariance import Covariance
from axiscal.planning.gains.gain import Scorer

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

    candidates : slice of the pool's; values : numbers of each; rests : what those of cells do to these numbers
    rows : (numbers, c) over the unknowns that one of them feels, None where they are made anew; felt : (c,) which
    shown : by candidate, the cells that a reading there opens
    """

    setup: int
    candidates: slice
    values: int
    rows: Array | None
    felt: NDArray[np.intp]
    rests: RestsInCells
    shown: RestEffects


class Pool:
    """The candidates of a lattice, sorted by set-up.

    memory : bytes that the rows may take; those beyond are made anew for every product, at the cost of time
    numbers : of a reading of each set-up; width : w, the most of them: every candidate has so many rows, some nought
    """

    def __init__(self, observation: Observation, lattice: Places, memory: float = MEMORY) -> None:
        self.lattice = lattice.within(np.argsort(lattice.setups, kind="stable"))
        self._bare = observation.bare
        self.size = self._bare.size
        self.noise = np.array([observation.setups[s].noise ** 2 for s in self.lattice.setups])
        self.numbers = numbers_of_setups(observation.setups)
        self.width = int(self.numbers.max())
        self.memory = memory
        self._bytes = 8.0 * self.size * np.cumsum(self.numbers[self.lattice.setups])
        self._blocks = [self._block(setup, where) for setup, where in self._slices()]

    def __len__(self) -> int:
        return len(self.lattice)

    def among(self, setups: Collection[int]) -> Self:
        """Return the candidates of some set-ups alone, with the rows that are there."""
        kept, other = np.isin(self.lattice.setups, list(setups)), copy.copy(self)
        before = [0, *np.cumsum(kept).tolist()]
        other.lattice, other.noise = self.lattice.within(kept), self.noise[kept]
        other._blocks = [
            replace(block, candidates=slice(before[block.candidates.start], before[block.candidates.stop]))
            for block in self._blocks
            if block.setup in setups
        ]
        return other

    def products(self, observation: Observation, vectors: Array) -> Array:
        """Return the rows of all candidates times vectors (n, c) over the observation's unknowns, (c, w, M)."""
        columns = np.ascontiguousarray(vectors.T)
        result = np.zeros((len(columns), self.width, len(self)))
        for block in self._blocks:
            seen = self._seen(block, observation, columns).reshape(len(columns), -1, block.values)
            result[:, : block.values, block.candidates] = seen.swapaxes(1, 2)
        return result

    def squares(self, observation: Observation, vectors: Array) -> Array:
        """Return the squared lengths of each candidate's rows times vectors (n, c), all its numbers together, (M,)."""
        result = np.empty(len(self))
        columns = np.ascontiguousarray(vectors.T)
        for block in self._blocks:
            seen = self._seen(block, observation, columns)
            result[block.candidates] = np.einsum("ij,ij->j", seen, seen).reshape(-1, block.values).sum(axis=1)
        return result

    def _seen(self, block: _Block, observation: Observation, columns: Array) -> Array:
        """Return the rows of a block times vectors, (c, numbers), those of one candidate beside each other.

        columns : (c, n). With few vectors each row is fetched from memory once and used for all of them while it is
        near.
        """
        rows = self._rows(block)
        if len(columns) > _FEW:
            seen = columns[:, block.felt] @ rows.T
        else:
            seen = np.empty((len(columns), len(rows)))
            _dotted(rows, columns[:, block.felt], seen)
        block.rests.add(observation, columns, seen)
        for number, course, share in self._drifts(observation, block.setup):
            moved = share * (columns[:, list(course.columns)] @ course.rows()[0])
            seen[:, number :: block.values] += moved[:, None]
        return seen

    def gain_forms(self, scorer: Scorer) -> tuple[Array, Array]:
        """Return N = G C W C Gᵀ and M = R + G C Gᵀ of every candidate, each (w, w, M)."""
        above = np.zeros((self.width, self.width, len(self)))
        below = np.eye(self.width)[:, :, None] * self.noise
        for block in self._blocks:
            part, own = block.candidates, slice(block.values)
            seen = scorer.observation.numbers(block.setup, self.lattice.poses[part], self.lattice.approaches[part])
            for whole, each in zip((above, below), scorer.split_all(seen), strict=True):
                whole[own, own, part] = each.transpose(1, 2, 0)
        return above, below

    def scorer(self, state: Covariance) -> Scorer:
        """Return the gains under a state, as if no cell had been visited."""
        factor = state.factor[: self.size]
        if factor.shape[1] > self.size:
            factor = np.asarray(np.linalg.qr(factor.T, mode="r")).T
        return Covariance.from_factor(self._bare, factor, state.root).scorer()

    def rows(self, observation: Observation, index: int) -> Array:
        """Return the rows of a candidate whose cells have columns as far as their rests show in it, (k, n)."""
        block = self._block_of(index)
        count = block.values
        inside = count * (index - block.candidates.start) + np.arange(count)
        result = np.zeros((count, observation.size))
        result[:, block.felt] = self._rows(block)[inside]
        effects = block.rests.effects
        of = RestEffects(effects.functions, effects.reach[:, inside], effects.cells[:, inside])
        add_rests(of, np.zeros(len(of.functions)), observation.cell_columns.visited(of), result, np.zeros(count))
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

    def _slices(self) -> Iterator[tuple[int, slice]]:
        for setup in np.unique(self.lattice.setups):
            mine = np.flatnonzero(self.lattice.setups == setup)
            for start in range(int(mine[0]), int(mine[-1]) + 1, _BLOCK):
                yield int(setup), slice(start, min(start + _BLOCK, int(mine[-1]) + 1))

    def _block(self, setup: int, candidates: slice) -> _Block:
        shown = cells_shown(self._bare, setup, self.lattice.poses[candidates])
        rests, every = self._rests(setup, candidates), np.arange(self.size)
        block = _Block(setup, candidates, int(self.numbers[setup]), None, every, rests, shown)
        if self._bytes[candidates.stop - 1] > self.memory:
            return block
        rows = self._rows(block)
        felt = np.flatnonzero(np.any(rows != 0, axis=0))
        return replace(block, rows=np.ascontiguousarray(rows[:, felt]), felt=felt)

    def _rests(self, setup: int, candidates: slice) -> RestsInCells:
        """Return what the rests do to the numbers of some candidates, those of one candidate beside each other."""
        part = self.lattice.poses[candidates], self.lattice.approaches[candidates]
        functions, reach, cells = self._bare.rest_effects(setup, *part)
        inside = reach.transpose(1, 2, 0).reshape(len(functions), len(reach) * len(part[0]))
        return RestsInCells.ordered(self._bare, RestEffects(functions, inside, np.repeat(cells, len(reach), axis=1)))

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


@dataclass(frozen=True, eq=False, slots=True)
class RestsInCells:
    """Effects of the rests on many numbers, cell by cell.

    effects : of all of them; numbers, reach : (k,) which feel a cell and how much, cell by cell
    first : (all cells + 1,) where those of each cell begin
    """

    effects: RestEffects
    numbers: NDArray[np.intp]
    reach: Array
    first: NDArray[np.intp]

    @classmethod
    def ordered(cls, observation: Observation, effects: RestEffects) -> RestsInCells:
        """Return them in the order of the cells."""
        table = observation.cell_columns
        cells = (table.first[effects.functions][:, None] + effects.cells).ravel()
        order = np.argsort(cells, kind="stable")
        order = order[effects.reach.ravel()[order] != 0]
        first = np.searchsorted(cells[order], np.arange(len(table.columns) + 1))
        return cls(effects, order % max(effects.reach.shape[1], 1), effects.reach.ravel()[order], first)

    def add(self, observation: Observation, vectors: Array, into: Array) -> None:
        """Add what the rows of cells with columns make of vectors, in place.  vectors : (c, n); into : (c, numbers)"""
        columns, product = _visited(observation, self, into.shape[1])
        if len(columns):
            into += product(vectors[:, columns].T).T


@remembered
def _visited(
    observation: Observation, rests: RestsInCells, numbers: int
) -> tuple[NDArray[np.intp], Callable[[Array], Array]]:
    """Return the columns of visited cells that some of so many numbers feel, and what makes their part of a product."""
    columns = observation.cell_columns.columns
    visited = np.flatnonzero(columns >= 0)
    counts = rests.first[visited + 1] - rests.first[visited]
    visited, counts = visited[counts > 0], counts[counts > 0]
    first = np.concatenate([np.zeros(1, dtype=np.intp), np.cumsum(counts)])
    entries = np.arange(int(counts.sum())) + np.repeat(rests.first[visited] - first[:-1], counts)
    return columns[visited], sparse_product(rests.reach[entries], rests.numbers[entries], first, numbers)
