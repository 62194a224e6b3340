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

    poses : (lines, q), each line's with the moving axis anywhere; effects : by number, (terms, lines, levers) what a
    unit of each error adds; both : [F, C Vᵀ]
    fresh : (lines, levers, levers) the covariance that rests give the levers of all numbers, were no cell of the axis
    visited, or nought as (lines, 1, 1); shown : whether one was
    """

    def __init__(self, observation: Observation, axis: int, poses: Array, effects: list[Array], both: Array) -> None:
        terms = observation.errors.terms
        having = list(observation.with_rest)
        self._axis, self._poses, self._both = axis, poses, both
        self.fresh: Array = np.zeros((len(poses), 1, 1))
        self.shown = False
        if not having:
            return
        self._terms, columns = [terms[i] for i in having], [observation.cell_columns.of(i) for i in having]
        self._reach = np.concatenate([each[having] for each in effects], axis=2)
        variances = np.array([term.rest**2 for term in self._terms])
        moving = [axis in term.axes for term in self._terms]
        still = [_still_open(*each, poses) for each in zip(self._terms, columns, moving, strict=True)]
        spread = self._reach.transpose(1, 2, 0) * (np.array(still).T * variances)[:, None]
        self.fresh = spread @ self._reach.transpose(1, 0, 2)
        self._visited = np.array([i for i in np.flatnonzero(moving) if columns[i].max() >= 0], dtype=np.intp)
        self._columns, self._variances = [columns[i] for i in self._visited], variances[self._visited]
        self.shown = len(self._visited) > 0

    def visited(self, positions: Array, line: NDArray[np.intp]) -> NDArray[np.intp]:
        """Return the columns of the visited cells of the moving axis, −1 for those that are not, (m, errors).

        positions, line : (m,)
        """
        pairs = zip(self._visited, self._columns, strict=True)
        found = [columns[self._cells(self._terms[i], positions, line)] for i, columns in pairs]
        return np.array(found, dtype=np.intp).reshape(len(found), len(positions)).T

    def seen(self, line: NDArray[np.intp], columns: NDArray[np.intp]) -> Array:
        """Return what visited cells add to the vectors of each number's levers, (m, levers, r + w).

        line : (m,); columns : (m, errors)
        """
        added: Array = self._inside(line, columns) @ self._both[columns]
        return added

    def closed(self, line: NDArray[np.intp], columns: NDArray[np.intp]) -> Array:
        """Return what of `fresh` is none where cells were visited, (m, levers, levers); as for `seen`."""
        inside = self._inside(line, columns)
        none: Array = (inside * self._variances) @ inside.swapaxes(1, 2)
        return none

    def _inside(self, line: NDArray[np.intp], columns: NDArray[np.intp]) -> Array:
        """Return the reach of errors whose cells were visited, (m, levers, errors), nought of the others."""
        reach: Array = self._reach[self._visited][:, line].transpose(1, 2, 0) * (columns >= 0)[:, None]
        return reach

    def _cells(self, term: Term, positions: Array, line: NDArray[np.intp]) -> NDArray[np.intp]:
        """Return the number of the cell at positions of the moving axis, (m,)."""
        if not isinstance(term, PlaneError):
            return term.cells(positions).astype(np.intp)
        poses = self._poses[line]
        poses[:, self._axis] = positions
        return term.cells(term.coordinates(poses)).astype(np.intp)


def cells_along(observation: Observation, axis: int) -> list[int]:
    """Return the columns of the visited cells of the errors of an axis."""
    return [column for (i, _), column in observation.cells.items() if axis in observation.errors.terms[i].axes]


def _still_open(term: Term, columns: NDArray[np.intp], moving: bool, poses: Array) -> NDArray[np.bool_]:
    """Return whether the cell of each line was not visited, (lines,); of an error of the moving axis as if none was."""
    return np.ones(len(poses), dtype=bool) if moving else columns[term.cells(term.coordinates(poses))] < 0
