"""The rests of cells that were visited, in products of many rows: only the numbers in such a cell feel its column."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.cells import RestEffects
from axiscal.measurement.observation import Observation
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import sparse_product
from axiscal.numerics.remembered import remembered


@dataclass(frozen=True, eq=False, slots=True)
class RestsInCells:
    """What the rests do to many numbers, cell by cell.

    effects : of all of them; numbers, reach : (k,) which feel a cell and how much, cell by cell
    first : (all cells + 1,) where those of each cell begin
    """

    effects: RestEffects
    numbers: NDArray[np.intp]
    reach: Array
    first: NDArray[np.intp]

    @classmethod
    def of(cls, observation: Observation, effects: RestEffects) -> RestsInCells:
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
