"""The rests along a line: visited cells share theirs, in cells not visited yet they widen the noise."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from axiscal.error_model.model import Term
from axiscal.error_model.plane import PlaneError
from axiscal.measurement.observation import Observation
from axiscal.numerics import Array


class Rests:
    """What the rests add to the forms of several lines along one axis.

    at : (lines · levers, q), each line's pose at the nodes of λ; effects : (terms, lines · levers) what a unit of
    each error adds there; both : [F, C Vᵀ]
    """

    def __init__(
        self, observation: Observation, axis: int, at: Array, effects: Array, levers: int, both: Array
    ) -> None:
        terms = observation.errors.terms
        self._with = [i for i, f in enumerate(terms) if f.rest > 0]
        self.own_columns = [column for (i, _), column in observation.cells.items() if axis in terms[i].axes]
        if not self._with:
            return
        self._axis, self._both = axis, np.vstack([both, np.zeros(both.shape[1])])
        self._terms = [terms[i] for i in self._with]
        self._columns = [observation.cell_columns.of(i) for i in self._with]
        self._levers = effects[self._with].reshape(len(self._with), -1, levers)
        self._parked = at[::levers]
        cells = [f.cells(f.coordinates(self._parked)) for f in self._terms]
        self._open = np.array([columns[cell] < 0 for columns, cell in zip(self._columns, cells, strict=True)])

    def add(self, seen: Array, positions: Array, line: NDArray[np.intp], levers: Array) -> None:
        """Add the rests of visited cells of the moving axis to rows times `both`, in place.

        seen : (b, k, r + w); positions : (b, k); line : (b,); levers : λ (b, k, n) or (k, n)
        """
        if not self.own_columns:
            return
        for f, columns, own in zip(self._terms, self._columns, self._levers, strict=True):
            if self._axis in f.axes and columns.max() >= 0:
                reach = np.einsum(_reach(levers), levers, own[line])
                seen += reach[..., None] * self._both[columns[self._cells(f, positions, line)]]

    def open_rests(self, positions: Array, line: NDArray[np.intp], levers: Array) -> Array:
        """Return what the rest of each term adds in cells not visited, standard deviations, (terms, b, k)."""
        result = np.zeros((len(self._with), len(line), positions.shape[1]))
        if not self._with:
            return result
        parts = zip(result, self._terms, self._columns, self._levers, self._open, strict=True)
        for into, f, columns, own, still_open in parts:
            reach = np.einsum(_reach(levers), levers, own[line]) * f.rest
            moves = self._axis in f.axes
            fresh = columns[self._cells(f, positions, line)] < 0 if moves else still_open[line, None]
            into[:] = np.where(fresh, reach, 0.0)
        return result

    def _cells(self, term: Term, positions: Array, line: NDArray[np.intp]) -> NDArray[np.intp]:
        """Return the number of the cell at positions of the moving axis, (b, k) or as many as there are."""
        if not isinstance(term, PlaneError):
            return term.cells(positions.ravel()).reshape(positions.shape).astype(np.intp)
        poses = np.repeat(self._parked[line], positions.shape[1], axis=0)
        poses[:, self._axis] = np.broadcast_to(positions, (len(line), positions.shape[1])).ravel()
        return term.cells(term.coordinates(poses)).reshape(len(line), -1).astype(np.intp)


def _reach(levers: Array) -> str:
    """λ at positions that all lines share, or at each line's own."""
    return "kn,bn->bk" if levers.ndim == 2 else "bkn,bn->bk"
