"""The rests along a line: visited cells share theirs, in cells not visited yet they widen the noise."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from axiscal.error_model.model import ErrorFunction
from axiscal.measurement.observation import Observation
from axiscal.numerics import Array


class Rests:
    """What the rests add to the forms of several lines along one axis.

    at : (lines · levers, q), each line's pose at the nodes of λ; effects : (functions, lines · levers) what a unit of
    each error adds there; both : [F, C Vᵀ]
    """

    def __init__(
        self, observation: Observation, axis: int, at: Array, effects: Array, levers: int, both: Array
    ) -> None:
        functions = observation.errors.functions
        self._with = [i for i, f in enumerate(functions) if f.rest > 0]
        self.own_columns = [column for (i, _), column in observation.cells.items() if functions[i].axis == axis]
        if not self._with:
            return
        self._axis, self._both = axis, np.vstack([both, np.zeros(both.shape[1])])
        self._functions = [functions[i] for i in self._with]
        self._columns = [observation.cell_columns(i) for i in self._with]
        self._levers = effects[self._with].reshape(len(self._with), -1, levers)
        parked = at[::levers]
        cells = [f.cells(parked[:, f.axis]) for f in self._functions]
        self._open = np.array([columns[cell] < 0 for columns, cell in zip(self._columns, cells, strict=True)])

    def add(self, seen: Array, positions: Array, line: NDArray[np.intp], levers: Array) -> None:
        """Add the rests of visited cells of the moving axis to rows times `both`, in place.

        seen : (b, k, r + w); positions : (b, k); line : (b,); levers : λ (b, k, n) or (k, n)
        """
        if not self.own_columns:
            return
        for f, columns, own in zip(self._functions, self._columns, self._levers, strict=True):
            if f.axis == self._axis and columns.max() >= 0:
                reach = np.einsum(_reach(levers), levers, own[line])
                seen += reach[..., None] * self._both[columns[_cells(f, positions)]]

    def open_rests(self, positions: Array, line: NDArray[np.intp], levers: Array) -> Array:
        """Return what the rest of each function adds in cells not visited, standard deviations, (functions, b, k)."""
        result = np.zeros((len(self._with), len(line), positions.shape[1]))
        if not self._with:
            return result
        parts = zip(result, self._functions, self._columns, self._levers, self._open, strict=True)
        for into, f, columns, own, still_open in parts:
            reach = np.einsum(_reach(levers), levers, own[line]) * f.rest
            fresh = columns[_cells(f, positions)] < 0 if f.axis == self._axis else still_open[line, None]
            into[:] = np.where(fresh, reach, 0.0)
        return result


def _cells(function: ErrorFunction, positions: Array) -> NDArray[np.intp]:
    """Return the number of the cell at positions of a function's axis, of any shape."""
    return function.cells(positions.ravel()).reshape(positions.shape).astype(np.intp)


def _reach(levers: Array) -> str:
    """λ at positions that all lines share, or at each line's own."""
    return "kn,bn->bk" if levers.ndim == 2 else "bkn,bn->bk"
