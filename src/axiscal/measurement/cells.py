"""The rests of cells: what no spline follows is one number per short cell of an axis, shared by all readings in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.error_model.model import ErrorModel
from axiscal.measurement.setup import Setup
from axiscal.measurement.way import feet
from axiscal.numerics import Array

Cell = tuple[int, int]
"""Index of an error function with a rest, and the number of the cell along its axis."""


class RestEffect(NamedTuple):
    """What the rest of one error function does to readings.

    reach : (m,) what a unit of it adds; cells : (m,) the number of the cell that they are in
    """

    function: int
    reach: Array
    cells: NDArray[np.int64]


def rest_effects(
    errors: ErrorModel, mounted: Setup, levers: Array, poses: Array, approaches: Array, among: Sequence[int]
) -> list[RestEffect]:
    """Return what the rests of some functions do to readings of a set-up; of each foot where it has feet.

    levers : (functions, m) what a unit of each error adds; poses, approaches : (m, q); among : indices of functions
    """
    found = list[RestEffect]()
    effects = errors.effects(levers, approaches) if among else levers
    for i in among:
        function, at = errors.functions[i], poses[:, errors.functions[i].axis]
        if mounted.base is None:
            found.append(RestEffect(i, effects[i], function.cells(at)))
        elif mounted.base and np.any(effects[i]):  # a base without length is refused where its way has a rest
            stands = feet(mounted.base)
            found += [RestEffect(i, foot.weight * effects[i], function.cells(at + foot.shift)) for foot in stands]
    return found


def cell_columns(
    errors: ErrorModel, with_rest: Sequence[int], cells: Mapping[Cell, int]
) -> dict[int, NDArray[np.intp]]:
    """Return for each function with a rest the column of every cell of its axis, -1 where there is none."""
    columns = {i: np.full(errors.functions[i].cell_count, -1) for i in with_rest}
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
