"""The rests of cells: the part of an error that splines miss, one number per short cell, shared by its readings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.errors.model import ErrorModel
from axiscal.measurement.setup import Setup
from axiscal.measurement.travel import feet, moved
from axiscal.numerics import Array

Cell = tuple[int, int]
"""Index of an error with a rest, and the number of the cell along its axis, or of the plane of its axes."""


class RestEffects(NamedTuple):
    """The effect of the rests of some errors on readings: one row for each error, or for each of its feet.

    functions : (e,) index of the error; reach : (e, m) what a unit of its rest adds
    cells : (e, m) the number of the cell that they are in
    """

    functions: NDArray[np.intp]
    reach: Array
    cells: NDArray[np.int64]


def rest_effects(
    errors: ErrorModel, mounted: Setup, levers: Array, poses: Array, approaches: Array, among: Sequence[int]
) -> RestEffects:
    """Return what the rests of some errors do to readings of a set-up; of each foot where it has feet.

    levers : (terms, m) what a unit of each error adds; poses, approaches : (m, q); among : indices of terms
    """
    effects = errors.effects(levers, approaches) if len(among) else levers
    if mounted.base is None:
        functions = np.array(among, dtype=np.intp)
        return RestEffects(functions, effects[functions], _cells_of(errors, functions, poses))
    felt = [i for i in among if mounted.base and np.any(effects[i])]
    parts = list[RestEffects]()  # a base without length is refused where its way has a rest
    for foot in feet(mounted.base) if felt else ():
        functions = np.array(felt, dtype=np.intp)
        at = moved(poses, mounted.moves[0], foot.shift)
        parts.append(RestEffects(functions, foot.weight * effects[functions], _cells_of(errors, functions, at)))
    return _of_all_feet(parts, len(poses))


def _of_all_feet(parts: Sequence[RestEffects], count: int) -> RestEffects:
    """Return the rests under all feet, those of one error beside each other.  count : of readings"""
    if not parts:
        return RestEffects(np.zeros(0, dtype=np.intp), np.zeros((0, count)), np.zeros((0, count), dtype=np.int64))
    functions, reach, cells = (np.stack(column, axis=1) for column in zip(*parts, strict=True))
    return RestEffects(functions.ravel(), reach.reshape(-1, count), cells.reshape(-1, count))


def _cells_of(errors: ErrorModel, functions: NDArray[np.intp], poses: Array) -> NDArray[np.int64]:
    """Return the cells of some errors at poses, (e, m); those of errors with the same cells once."""
    found: dict[int, NDArray[np.int64]] = {}
    result = np.empty((len(functions), len(poses)), dtype=np.int64)
    for row, i in enumerate(errors.same_cells[functions].tolist()):
        if i not in found:
            found[i] = errors.terms[i].cells(errors.terms[i].coordinates(poses))
        result[row] = found[i]
    return result


class CellColumns:
    """The column of the rest of every cell of every error that has one, -1 where there is none.

    first : (terms,) where the cells of each error begin in the list of all of them; columns : (all cells,)
    """

    def __init__(self, errors: ErrorModel, with_rest: Sequence[int], cells: Mapping[Cell, int]) -> None:
        counts = np.zeros(len(errors.terms), dtype=np.intp)
        counts[list(with_rest)] = [errors.terms[i].cell_count for i in with_rest]
        self.first: NDArray[np.intp] = np.cumsum(counts) - counts
        self._counts = counts
        self.columns: NDArray[np.intp] = np.full(int(counts.sum()), -1, dtype=np.intp)
        if cells:
            visited = np.array(list(cells), dtype=np.intp)
            self.columns[self.first[visited[:, 0]] + visited[:, 1]] = list(cells.values())

    def of(self, function: int) -> NDArray[np.intp]:
        """Return those of the cells of one error."""
        start = int(self.first[function])
        return self.columns[start : start + int(self._counts[function])]

    def at(self, effects: RestEffects) -> NDArray[np.intp]:
        """Return those of the cells that readings are in, (e, m)."""
        found: NDArray[np.intp] = self.columns[self.first[effects.functions][:, None] + effects.cells]
        return found


def add_rests(effects: RestEffects, rests: Array, here: NDArray[np.intp], rows: Array, variances: Array) -> None:
    """Add rests to readings, in place: to the rows where a cell has a column, else to the variances.

    rests : (e,) standard deviations; here : (e, m) columns, -1 where there is none; rows : (m, size); variances : (m,)
    """
    known = here >= 0
    which, reading = np.nonzero(known)
    np.add.at(rows, (reading, here[which, reading]), effects.reach[which, reading])
    variances += np.sum(np.where(known, 0.0, (effects.reach * rests[:, None]) ** 2), axis=0)
