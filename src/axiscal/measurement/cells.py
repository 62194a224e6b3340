"""The rests of cells that readings open: the part of an error that splines miss, one number per short cell."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.setup import Setup
from axiscal.measurement.travel import feet_of
from axiscal.numerics import Array
from axiscal_core.machine import Machine

Cell = tuple[int, int]
"""Index of an error with a rest, and the number of the cell along its axis, or of the plane of its axes."""


class RestEffects(NamedTuple):
    """The effect of the rests of some errors on readings: one row for each error, or for each of its places.

    functions : (e,) index of the error; reach : (..., e, m) what a unit of its rest adds to each number
    cells : (e, m) the number of the cell that they are in
    """

    functions: NDArray[np.intp]
    reach: Array
    cells: NDArray[np.int64]


def rest_effects(
    errors: Machine, mounted: Setup, levers: Array, poses: Array, approaches: Array, among: Sequence[int]
) -> RestEffects:
    """Return what the rests of some errors do to readings of a set-up; at each place of which they show a sum.

    levers : (..., terms, m) what a unit of each error adds; poses, approaches : (m, q); among : indices of terms
    """
    effects = errors.effects(levers, approaches) if len(among) else levers
    standing = feet_of(mounted, poses)
    if len(standing) == 1:  # as nearly always, and at every look of a plan
        functions = np.array(among, dtype=np.intp)
        return RestEffects(functions, effects[..., functions, :], _cells_of(errors, functions, poses))
    # a base without length is refused where its way has a rest
    felt = np.array([i for i in among if mounted.base != 0 and np.any(effects[..., i, :])], dtype=np.intp)
    cells = np.stack([_cells_of(errors, felt, foot.poses) for foot in standing], axis=1)
    reach = effects[..., felt, :][..., None, :] * np.array([foot.weight for foot in standing])[:, None]
    every = len(felt) * len(standing), len(poses)
    return RestEffects(np.repeat(felt, len(standing)), reach.reshape(*reach.shape[:-3], *every), cells.reshape(every))


def _cells_of(errors: Machine, functions: NDArray[np.intp], poses: Array) -> NDArray[np.int64]:
    """Return the cells of some errors at poses, (e, m); those of errors with the same cells once."""
    firsts = errors.firsts[functions].tolist()
    found = {i: errors.terms[i].cells(*errors.terms[i].at(poses)) for i in {*firsts}}
    return np.array([found[i] for i in firsts], dtype=np.int64).reshape(len(firsts), len(poses))


class CellColumns:
    """The column of the rest of every cell of every error that has one, -1 where there is none.

    first : (terms,) where the cells of each error begin in the list of all of them; columns : (all cells,)
    """

    def __init__(self, errors: Machine, with_rest: Sequence[int], cells: Mapping[Cell, int]) -> None:
        counts = np.zeros(len(errors.terms), dtype=np.intp)
        counts[list(with_rest)] = [errors.terms[i].cell_count for i in with_rest]
        self.first: NDArray[np.intp] = np.cumsum(counts) - counts
        self._counts = counts
        self.columns: NDArray[np.intp] = np.full(int(counts.sum()), -1, dtype=np.intp)
        if cells:
            visited = np.array(list(cells), dtype=np.intp)
            self.columns[self.first[visited[:, 0]] + visited[:, 1]] = list(cells.values())

    def visited(self, effects: RestEffects) -> NDArray[np.intp]:
        """Return those of the cells that readings are in, (e, m)."""
        found: NDArray[np.intp] = self.columns[self.first[effects.functions][:, None] + effects.cells]
        return found


def add_rests(effects: RestEffects, rests: Array, here: NDArray[np.intp], rows: Array, variances: Array) -> None:
    """Add rests to readings, in place: to the rows where a cell has a column, else to the variances.

    rests : (e,) standard deviations; here : (e, m) columns, -1 where there is none
    rows : (..., m, size); variances : (..., m)
    """
    known = here >= 0
    which, reading = np.nonzero(known)
    at: tuple[Any, ...] = ..., reading, here[which, reading]
    np.add.at(rows, at, effects.reach[..., which, reading])
    variances += np.sum(np.where(known, 0.0, (effects.reach * rests[:, None]) ** 2), axis=-2)
