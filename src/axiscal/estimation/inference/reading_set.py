"""All numbers of all readings as one linear map: what errors, unknowns of set-ups and drifts do to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.errors.model import Term
from axiscal.measurement.drift import Course
from axiscal.measurement.observation import Observation, directions_of
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import linear_values, places_of, rows_at
from axiscal.numerics import Array


@dataclass(frozen=True, eq=False, slots=True)
class ErrorPart:
    """What one error does to the numbers.

    rows : (m, k) G; shared : (m, c) what a unit of the rest in each cell that was visited adds to them
    """

    term: Term
    rows: Array
    shared: Array


class _Visits(NamedTuple):
    """The cells of one error that numbers are in: which number, which cell, and what a unit of its rest adds."""

    number: list[NDArray[np.intp]]
    cell: list[NDArray[np.int64]]
    reach: list[Array]

    def note(self, number: NDArray[np.intp], cells: NDArray[np.int64], reach: Array) -> None:
        """Add what a rest does to some numbers."""
        self.number.append(number)
        self.cell.append(cells)
        self.reach.append(reach)

    def shared(self, numbers: int) -> Array:
        """Return what a unit of the rest in each cell that was visited adds to the numbers, (m, c)."""
        number, cell = np.concatenate(self.number), np.concatenate(self.cell)
        reach = np.concatenate(self.reach)
        felt = reach != 0
        _, column = np.unique(cell[felt], return_inverse=True)
        result = np.zeros((numbers, int(column.max(initial=-1)) + 1))
        np.add.at(result, (number[felt], column), reach[felt])
        return result


class ReadingSet:
    """All numbers of all readings.

    reading, setups : (m,) indices of the reading and the set-up of each number
    values : (m,), what is not linear taken off
    rows : (m, size) over errors and unknowns of set-ups; noise : (m,) variances
    extra_variance : (m,) of what else widens a number
    """

    def __init__(self, observation: Observation, readings: Sequence[Reading]) -> None:
        self._observation, self._readings = observation, readings
        self._places = places_of(observation.setups, readings)
        self.rows, variances, self.reading = rows_at(observation, self._places)
        self.setups = self._places.setups[self.reading]
        self.values = linear_values(observation, self._places, readings)
        usual = np.array([setup.noise**2 for setup in observation.setups])[self._places.setups]
        each = [noise if r.std is None else r.std**2 for r, noise in zip(readings, usual, strict=True)]
        self.noise: Array = np.array(each)[self.reading]
        self._visits = [_Visits([], [], []) for _ in observation.errors.terms]
        self.extra_variance = variances - usual[self.reading]  # such as of a side that nobody told
        for setup, mine in self._places.by_setup():
            self._share_rests(setup, mine)
        self.extra_variance = np.maximum(self.extra_variance, 0.0)

    def _share_rests(self, setup: int, mine: NDArray[np.intp]) -> None:
        """Note which cells the numbers of a set-up share; what their rests add to the variances is taken off."""
        terms, where = self._observation.errors.terms, (self._places.poses[mine], self._places.approaches[mine])
        for number, effects in enumerate(self._observation.rest_effects(setup, *where, everyone=True)):
            at = self._first(mine) + number
            for function, reach, cells in zip(effects.functions.tolist(), effects.reach, effects.cells, strict=True):
                self._visits[function].note(at, cells, reach)
                self.extra_variance[at] -= (reach * terms[function].rest) ** 2

    def _first(self, readings: NDArray[np.intp]) -> NDArray[np.intp]:
        """Return where the numbers of readings begin."""
        return np.searchsorted(self.reading, readings)

    def parts(self) -> list[ErrorPart]:
        """Return what each error does to the numbers, without those that none of them depends on."""
        result = []
        for term, visits in zip(self._observation.errors.terms, self._visits, strict=True):
            shared = visits.shared(len(self.rows)) if visits.number else np.zeros((0, 0))
            if shared.size:
                result.append(ErrorPart(term, self.rows[:, term.columns], shared))
        return result

    def features(self, root: Array) -> Array:
        """Return Φ with Φ Φᵀ the covariance of the numbers without noise, (m, k), the errors first.

        root : F (size, r) with F Fᵀ the covariance of the errors
        """
        rests = [part.term.rest * part.shared for part in self.parts() if part.term.rest > 0]
        return np.hstack([self.rows[:, : len(root)] @ root, *rests, self.unknowns()])

    def unknowns(self) -> Array:
        """Return U with U Uᵀ the covariance that unknowns and drifts of the set-ups give the numbers, (m, k)."""
        start, setups = self._observation.errors.size, self._observation.setups
        stds = np.array([unknown.std for unknown in self._observation.unknowns])
        drifts = [self._drifts(setup, mine) for setup, mine in self._places.by_setup() if setups[setup].drift > 0]
        return np.hstack([self.rows[:, start : start + len(stds)] * stds, *drifts])

    def _drifts(self, setup: int, mine: NDArray[np.intp]) -> Array:
        """Return the rows of the zeros of a set-up over the unknowns of its drift, (m, k); those of three apart."""
        times = np.array([self._readings[i].time or 0.0 for i in mine])
        course = Course.over(self._observation.setups[setup].drift, np.sort(times).tolist())
        parts = []
        for number in range(len(directions_of(self._observation.setups[setup]))):
            rows = np.zeros((len(self.values), len(course.columns)))
            rows[self._first(mine) + number] = course.rows(times)
            parts.append(rows)
        return np.hstack(parts)
