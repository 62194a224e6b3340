"""A lattice of candidates with its rows, kept in memory or made anew block by block where that would be too much."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from axiscal.design.lattice import Lattice
from axiscal.design.rests import columns_of_cells
from axiscal.design.scorer import Scorer
from axiscal.design.state import Point, State
from axiscal.measurement.observation import Observation
from axiscal.numerics import Array

_BLOCK = 4096
_NEAR = 256
_FEW = 4
MEMORY = 1e9
"""Bytes that the rows of a lattice may take unless said otherwise."""


@dataclass(frozen=True, eq=False, slots=True)
class _Block:
    """Candidates of one set-up.  reach : (f, m) what the rest of each function with a rest does; cells : (f, m)."""

    setup: int
    where: slice
    rows: Array | None
    reach: Array
    cells: NDArray[np.intp]


class Pool:
    """The candidates of a lattice, sorted by set-up.

    memory : bytes that the rows may take; beyond it they are made anew for every product, at the cost of time
    """

    def __init__(self, observation: Observation, lattice: Lattice, memory: float = MEMORY) -> None:
        self.lattice = lattice.within(np.argsort(lattice.setups, kind="stable"))
        self._bare = replace(observation, cells=MappingProxyType({}))
        self.size = self._bare.size
        self.noise = np.array([observation.setups[s].noise ** 2 for s in self.lattice.setups])
        self._with = [i for i, f in enumerate(observation.errors.functions) if f.rest > 0]
        self.bytes = 8.0 * len(lattice) * self.size
        self._kept = self.bytes <= memory
        self._blocks = [self._block(setup, where) for setup, where in self._slices()]

    def __len__(self) -> int:
        return len(self.lattice)

    def point(self, index: int) -> Point:
        """Return a candidate."""
        one = self.lattice
        return Point(int(one.setups[index]), one.poses[index], one.approaches[index])

    def products(self, observation: Observation, vectors: Array) -> Array:
        """Return the rows of all candidates times vectors (n, c) over the observation's unknowns, (m, c).

        With few vectors each row is fetched from memory once and used for all of them while it is near.
        """
        result = np.empty((vectors.shape[1], len(self)))
        columns = np.ascontiguousarray(vectors.T)
        for block in self._blocks:
            rows, into = self._rows(block), result[:, block.where]
            if len(columns) > _FEW:
                into[:] = columns[:, : self.size] @ rows.T
            else:
                _dotted(rows, columns[:, : self.size], into)
        for block in self._blocks:
            self._add_rests(block, observation, columns, result[:, block.where])
        return result.T

    def _add_rests(self, block: _Block, observation: Observation, columns: Array, into: Array) -> None:
        """Add what visited cells do, in place.  columns : (c, n); into : (c, m)."""
        for reach, cells, function in zip(block.reach, block.cells, self._with, strict=True):
            of = columns_of_cells(observation, function)
            if of.max() < 0:
                continue
            table = np.where(of >= 0, columns[:, of], 0.0)
            for values, sums in zip(table, into, strict=True):
                sums += reach * values.take(cells)

    def squares(self, observation: Observation, vectors: Array) -> Array:
        """Return the squared length of each candidate's row times vectors (n, c), (m,)."""
        result = np.empty(len(self))
        columns = np.ascontiguousarray(vectors.T)
        for block in self._blocks:
            seen = columns[:, : self.size] @ self._rows(block).T
            self._add_rests(block, observation, columns, seen)
            result[block.where] = np.einsum("ij,ij->j", seen, seen)
        return result

    def forms(self, scorer: Scorer) -> tuple[Array, Array]:
        """Return numerator and denominator of the gain of every candidate."""
        above, below = np.empty(len(self)), np.empty(len(self))
        for block in self._blocks:
            part = self.lattice.poses[block.where], self.lattice.approaches[block.where]
            seen = scorer.observation.rows(block.setup, *part)
            above[block.where], below[block.where] = scorer.split(seen.rows @ scorer.both, seen.variances)
        return above, below

    def scorer(self, state: State) -> Scorer:
        """Return the gains under a state, as if no cell had been visited."""
        factor = state.factor[: self.size]
        if factor.shape[1] > self.size:
            factor = np.linalg.qr(factor.T).R.T
        return replace(state, observation=self._bare, factor=factor).scorer()

    def row(self, observation: Observation, index: int) -> Array:
        """Return the row of a candidate whose cells have columns as far as it feels them, (n,)."""
        block = next(b for b in self._blocks if b.where.start <= index < b.where.stop)
        inside = index - block.where.start
        result = np.zeros(observation.size)
        result[: self.size] = self._rows(block)[inside]
        for function, reach, cells in zip(self._with, block.reach, block.cells, strict=True):
            cell = columns_of_cells(observation, function)[cells[inside]]
            if cell >= 0:
                result[cell] = reach[inside]
        return result

    def _slices(self) -> Iterator[tuple[int, slice]]:
        for setup in np.unique(self.lattice.setups):
            mine = np.flatnonzero(self.lattice.setups == setup)
            for start in range(int(mine[0]), int(mine[-1]) + 1, _BLOCK):
                yield int(setup), slice(start, min(start + _BLOCK, int(mine[-1]) + 1))

    def _block(self, setup: int, where: slice) -> _Block:
        poses, functions = self.lattice.poses[where], self._bare.errors.functions
        reach, cells = np.zeros((0, len(poses))), np.zeros((0, len(poses)), dtype=np.intp)
        if self._with:
            reach = self._bare.effects(setup, poses, self.lattice.approaches[where])[self._with]
            cells = np.stack([functions[i].cells(poses[:, functions[i].axis]) for i in self._with])
        block = _Block(setup, where, None, reach, cells)
        return replace(block, rows=self._rows(block)) if self._kept else block

    def _rows(self, block: _Block) -> Array:
        if block.rows is not None:
            return block.rows
        return self._bare.rows(block.setup, self.lattice.poses[block.where], self.lattice.approaches[block.where]).rows


def _dotted(rows: Array, columns: Array, into: Array) -> None:
    """Multiply a few rows at a time with every vector.  rows : (m, n); columns : (c, n); into : (c, m)."""
    for start in range(0, len(rows), _NEAR):
        part = rows[start : start + _NEAR]
        for column, sums in zip(columns, into, strict=True):
            np.dot(part, column, out=sums[start : start + _NEAR])
