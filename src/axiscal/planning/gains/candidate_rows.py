"""A lattice of candidates with its rows.

A candidate has as many rows as its instrument gives numbers, one after another: one, or one each along x, y and z.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.cells import RestEffects, add_rests
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.measurement.reading_rows import cells_shown, numbers_of_setups, with_cells
from axiscal.numerics import Array
from axiscal.planning.gains.covariance import Covariance, Scorer
from axiscal_core.from_scipy import sparse_product

_BLOCK = 4096
"""Rows made at once: of memory, not of the result."""
_TOGETHER = 64
"""Vectors of which products are summed at once: of memory, not of the result."""


@dataclass(frozen=True, eq=False, slots=True)
class _Block:
    """Candidates of one set-up.

    candidates : slice of the pool's; values : numbers of each; rests : what those of cells do to these numbers
    rows : (numbers, c) over the unknowns that one of them feels; felt : (c,) which
    cells : (e,) those that the numbers feel, in the list of all; of_cells : what makes the products of their rests
    shown : by candidate, the cells that a reading there opens
    """

    setup: int
    candidates: slice
    values: int
    rows: Array
    felt: NDArray[np.intp]
    rests: RestEffects
    cells: NDArray[np.intp]
    of_cells: Callable[[Array], Array]
    shown: RestEffects


class Pool:
    """The candidates of a lattice, sorted by set-up.

    numbers : of a reading of each set-up; width : w, the most of them: every candidate has so many rows, some nought
    """

    def __init__(self, observation: Observation, lattice: Places) -> None:
        self.lattice = lattice.within(np.argsort(lattice.setups, kind="stable"))
        self._bare = observation.bare
        self.size = self._bare.size
        self.noise = np.array([observation.setups[s].noise ** 2 for s in self.lattice.setups])
        self.numbers = numbers_of_setups(observation.setups)
        self.width, self._count = int(self.numbers.max()), len(self.lattice)
        self._blocks = [
            self._block(setup, slice(start, min(start + _BLOCK, int(mine[-1]) + 1)))
            for setup, mine in self.lattice.by_setup()
            for start in range(int(mine[0]), int(mine[-1]) + 1, _BLOCK)
        ]

    def __len__(self) -> int:
        return self._count

    def products(self, observation: Observation, vectors: Array) -> Array:
        """Return the rows of all candidates times vectors (n, c) over the observation's unknowns, (c, w, M)."""
        result = np.zeros((vectors.shape[1], self.width, len(self)))
        columns = np.ascontiguousarray(vectors.T)
        for block in self._blocks:
            seen = columns[:, block.felt] @ block.rows.T
            at = observation.cell_columns.columns[block.cells]
            if np.any(at >= 0):
                seen += block.of_cells(np.where(at[:, None] >= 0, vectors[at], 0.0)).T
            for number, course in observation.drifts_shown(block.setup):
                moved = columns[:, list(course.columns)] @ course.rows()[0]
                seen[:, number :: block.values] += moved[:, None]
            each = seen.reshape(len(result), -1, block.values)
            result[:, : block.values, block.candidates] = each.swapaxes(1, 2)
        return result

    def grams(self, observation: Observation, vectors: Array) -> Array:
        """Return the products of each candidate's rows times vectors (n, c) with one another, (w, w, M)."""
        result = np.zeros((self.width, self.width, len(self)))
        for start in range(0, vectors.shape[1], _TOGETHER):
            seen = self.products(observation, vectors[:, start : start + _TOGETHER])
            result += np.einsum("kim,kjm->ijm", seen, seen)
        return result

    def gain_forms(self, scorer: Scorer) -> tuple[Array, Array]:
        """Return N = G C W C Gᵀ and M = R + G C Gᵀ of every candidate, each (w, w, M)."""
        observation, vectors = scorer.observation, scorer.both
        noise = np.eye(self.width)[:, :, None] * self.noise
        for block in self._blocks:
            part, own = block.candidates, slice(block.values)
            seen = observation.numbers(block.setup, self.lattice.poses[part], self.lattice.approaches[part])
            noise[own, own, part] = seen.covariances.transpose(1, 2, 0)
        above, below = (self.grams(observation, each) for each in (vectors[:, scorer.factor.shape[1] :], scorer.factor))
        return above, noise + below

    def scorer(self, state: Covariance) -> Scorer:
        """Return the gains under a state, as if no cell had been visited."""
        factor = state.factor[: self.size]
        if factor.shape[1] > self.size:
            factor = np.asarray(np.linalg.qr(factor.T, mode="r")).T
        return Covariance.from_factor(self._bare, factor, state.root).scorer()

    def rows(self, observation: Observation, index: int) -> Array:
        """Return the rows of a candidate whose cells have columns as far as their rests show in it, (k, n)."""
        block = self._block_of(index)
        inside = block.values * (index - block.candidates.start) + np.arange(block.values)
        result = np.zeros((block.values, observation.size))
        result[:, block.felt] = block.rows[inside]
        functions, reach, cells = block.rests
        of = RestEffects(functions, reach[:, inside], cells[:, inside])
        add_rests(of, np.zeros(len(functions)), observation.cell_columns.visited(of), result, np.zeros(len(inside)))
        for number, course in observation.drifts_shown(block.setup):
            result[number, list(course.columns)] += course.rows()[0]
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

    def _block(self, setup: int, candidates: slice) -> _Block:
        poses, approaches = self.lattice.poses[candidates], self.lattice.approaches[candidates]
        each = [seen.rows for seen in self._bare.rows_each(setup, poses, approaches)]
        rows = each[0] if len(each) == 1 else np.stack(each, axis=1).reshape(-1, self.size)
        felt = np.flatnonzero(np.any(rows != 0, axis=0))
        functions, reach, cells = self._bare.rest_effects(setup, poses, approaches)
        inside = reach.transpose(1, 2, 0).reshape(len(functions), len(rows))
        rests = RestEffects(functions, inside, np.repeat(cells, len(reach), axis=1))
        return _Block(
            setup, candidates, len(reach), np.ascontiguousarray(rows[:, felt]), felt, rests,
            *self._of_cells(rests), cells_shown(self._bare, setup, poses),
        )  # fmt: skip

    def _of_cells(self, rests: RestEffects) -> tuple[NDArray[np.intp], Callable[[Array], Array]]:
        """Return the cells that numbers feel, in the list of all, and what makes the products of their rests."""
        effects, numbers = np.nonzero(rests.reach)
        every = self._bare.cell_columns.first[rests.functions[effects]] + rests.cells[effects, numbers]
        cells = np.flatnonzero(np.bincount(every))
        entries, shape = rests.reach[effects, numbers], (rests.reach.shape[1], len(cells))
        return cells, sparse_product(entries, numbers, np.searchsorted(cells, every), shape)
