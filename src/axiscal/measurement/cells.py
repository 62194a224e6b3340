"""The rests of cells: what no spline follows is one number per short cell of an axis, shared by all readings in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.error_model.model import ErrorModel
from axiscal.measurement.setup import Setup
from axiscal.measurement.way import feet, moved
from axiscal.numerics import Array

Cell = tuple[int, int]
"""Index of an error with a rest, and the number of the cell along its axis, or of the plane of its axes."""


class RestEffect(NamedTuple):
    """What the rest of one error does to readings.

    reach : (m,) what a unit of it adds; cells : (m,) the number of the cell that they are in
    """

    function: int
    reach: Array
    cells: NDArray[np.int64]


def rest_effects(
    errors: ErrorModel, mounted: Setup, levers: Array, poses: Array, approaches: Array, among: Sequence[int]
) -> list[RestEffect]:
    """Return what the rests of some errors do to readings of a set-up; of each foot where it has feet.

    levers : (terms, m) what a unit of each error adds; poses, approaches : (m, q); among : indices of terms
    """
    found = list[RestEffect]()
    effects = errors.effects(levers, approaches) if among else levers
    for i in among:
        term = errors.terms[i]
        if mounted.base is None:
            found.append(RestEffect(i, effects[i], term.cells(term.coordinates(poses))))
        elif mounted.base and np.any(effects[i]):  # a base without length is refused where its way has a rest
            (axis,) = mounted.moves
            for foot in feet(mounted.base):
                at = term.coordinates(moved(poses, axis, foot.shift))
                found.append(RestEffect(i, foot.weight * effects[i], term.cells(at)))
    return found


def cell_columns(
    errors: ErrorModel, with_rest: Sequence[int], cells: Mapping[Cell, int]
) -> dict[int, NDArray[np.intp]]:
    """Return for each error with a rest the column of every cell that it has, -1 where there is none."""
    columns = {i: np.full(errors.terms[i].cell_count, -1) for i in with_rest}
    for (owner, cell), column in cells.items():
        columns[owner][cell] = column
    return columns


def add_rest(effect: RestEffect, rest: float, columns: NDArray[np.intp], rows: Array, variances: Array) -> None:
    """Add a rest to readings, in place: to the rows where its cell has a column, else to the variances.

    rest : its standard deviation; columns : (cells,); rows : (m, size); variances : (m,)
    """
    here = columns[effect.cells]
    known = np.flatnonzero(here >= 0)
    rows[known, here[known]] += effect.reach[known]
    variances += np.where(here >= 0, 0.0, (effect.reach * rest) ** 2)
