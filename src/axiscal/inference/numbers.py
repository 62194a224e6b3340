"""All numbers of all readings as one linear map: what errors, unknowns of set-ups and drifts do to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.error_model.model import ErrorFunction
from axiscal.error_model.prior import distances, matern52, matern52_by_length
from axiscal.measurement.drift import Course
from axiscal.measurement.observation import Cell, Observation, Seen, directions_of
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array


class Sharing(NamedTuple):
    """The entries of a matrix (m, m) that are not nought: where, counted along its rows, and their values."""

    where: NDArray[np.intp]
    values: Array


@dataclass(frozen=True, eq=False, slots=True)
class Part:
    """What one error does to the numbers.

    rows : (m, k) G; distances : (k, k) of its control values
    shared : (m, c) what a unit of the rest in each cell that was visited adds to them
    """

    function: ErrorFunction
    rows: Array
    distances: Array
    shared: Array

    def correlation(self, length: float | None) -> Array:
        """R (k, k)."""
        if length is None:
            return np.eye(self.rows.shape[1])
        return matern52(self.distances / length)

    def by_length(self, length: float) -> Array:
        """∂R/∂log ℓ (k, k)."""
        return matern52_by_length(self.distances / length)

    def sharing(self) -> Sharing:
        """Return E (m, m), the products of the levers of numbers that share a cell; most share none."""
        products = (self.shared @ self.shared.T).ravel()
        where = np.flatnonzero(products)
        return Sharing(where, products[where])


class ReadingSet:
    """All numbers of all readings.

    reading : (m,) index of the reading of each number; values : (m,), what is not linear taken off
    rows : (m, size) over errors and unknowns of set-ups; noise : (m,) variances
    own : (m,) whether a reading states its own; loose : (m,) variances of what else widens a number
    """

    def __init__(self, observation: Observation, readings: Sequence[Reading]) -> None:
        self._observation, self._readings = observation, readings
        counts = np.array([len(reading.values) for reading in readings])
        self.reading = np.repeat(np.arange(len(readings)), counts)
        self._first = np.cumsum(counts) - counts
        size = len(self.reading)
        self.values, self.rows = np.zeros(size), np.zeros((size, observation.size))
        self._shared = [np.zeros((size, function.cell_count)) for function in observation.errors.functions]
        self.loose = np.zeros(size)  # such as a side that nobody told
        for index in range(len(observation.setups)):
            self._fill(index)
        usual = {setup.name: setup.noise for setup in observation.setups}
        each = [(usual[r.setup] if r.std is None else r.std) ** 2 for r in readings]
        self.noise: Array = np.array(each)[self.reading]
        self.own: NDArray[np.bool_] = np.array([r.std is not None for r in readings], dtype=bool)[self.reading]

    def _fill(self, index: int) -> None:
        """Fill in the numbers of one set-up."""
        setup = self._observation.setups[index]
        mine = self._of(setup)
        if not mine:
            return
        poses = np.array([self._readings[i].pose for i in mine])
        approaches = np.array([self._readings[i].approach for i in mine], dtype=float)
        for number, direction in enumerate(directions_of(setup)):
            at = self._first[mine] + number
            seen = self._observation.rows(index, poses, approaches, direction)
            self.rows[at], self.loose[at] = seen.rows, seen.variances - setup.noise**2
            for felt in self._observation.felt_by_all(index, poses, approaches, direction):
                np.add.at(self._shared[felt.function], (at, felt.cells), felt.reach)
                self.loose[at] -= (felt.reach * self._observation.errors.functions[felt.function].rest) ** 2
            self.values[at] = [self._readings[i].values[number] for i in mine]
            self.values[at] -= self._observation.beyond(index, poses)
        self.loose = np.maximum(self.loose, 0.0)

    def _of(self, setup: Setup) -> list[int]:
        return [i for i, reading in enumerate(self._readings) if reading.setup == setup.name]

    def parts(self) -> list[Part]:
        """Return what each error does to the numbers, without those that none of them depends on."""
        result = []
        for function, felt in zip(self._observation.errors.functions, self._shared, strict=True):
            shared = felt[:, np.any(felt != 0, axis=0)]
            if shared.size:
                result.append(Part(function, self.rows[:, function.columns], distances(function.basis), shared))
        return result

    def unknowns(self) -> Array:
        """Return U with U Uᵀ the covariance that unknowns and drifts of the set-ups give the numbers, (m, k)."""
        start = self._observation.errors.size
        stds = np.array([unknown.std for setup in self._observation.setups for unknown in setup.unknowns])
        drifts = [self._drifts(setup) for setup in self._observation.setups if setup.drift > 0 and self._of(setup)]
        return np.hstack([self.rows[:, start : start + len(stds)] * stds, *drifts])

    def _drifts(self, setup: Setup) -> Array:
        """Return the rows of the zeros of a set-up over the unknowns of its drift, (m, k); those of three apart."""
        mine = self._of(setup)
        times = [self._readings[i].time or 0.0 for i in mine]
        course = _course(setup, sorted(times))
        parts = []
        for number in range(len(directions_of(setup))):
            rows = np.zeros((len(self.values), len(course.columns)))
            rows[self._first[mine] + number] = np.array([course.row(time) for time in times])
            parts.append(rows)
        return np.hstack(parts)


def seen_together(observation: Observation, readings: Sequence[Reading]) -> list[Seen]:
    """Return what `Observation.reading` does of each reading, of all at once."""
    found: list[Seen] = [_NOTHING] * len(readings)
    for index, setup in enumerate(observation.setups):
        mine = [i for i, reading in enumerate(readings) if reading.setup == setup.name]
        if not mine:
            continue
        poses = np.array([readings[i].pose for i in mine])
        approaches = np.array([readings[i].approach for i in mine], dtype=float)
        parts = [observation.rows(index, poses, approaches, direction) for direction in directions_of(setup)]
        _let_wander(observation, index, [readings[i].time for i in mine], [part.rows for part in parts])
        beyond = observation.beyond(index, poses)
        for at, i in enumerate(mine):
            own = 0.0 if (std := readings[i].std) is None else std**2 - setup.noise**2
            rows, variances = (np.array([part[which][at] for part in parts]) for which in (0, 1))
            found[i] = Seen(rows, variances + own, np.array(readings[i].values) - beyond[at])
    return found


def _let_wander(observation: Observation, setup: int, times: Sequence[float | None], parts: Sequence[Array]) -> None:
    """Put the drift of a set-up's zeros at each reading's time into the rows of its numbers, (m, size) each."""
    for direction, rows in zip(directions_of(observation.setups[setup]), parts, strict=True):
        at = np.array(observation.setups[setup].direction) if direction is None else direction
        for course, share in observation.wandering(setup, at):
            rows[:, list(course.columns)] = share * np.array([course.row(time) for time in times])


def visited_together(observation: Observation, readings: Sequence[Reading]) -> Observation:
    """Return what `Observation.visited` makes of a map, reading by reading."""
    setups = {setup.name: index for index, setup in enumerate(observation.setups)}
    for reading, cells in zip(readings, _cells(observation, readings), strict=True):
        setup = setups[reading.setup]
        if not cells <= observation.cells.keys() or _wanders_on(observation, setup, reading.time):
            observation = observation.visited(np.array(reading.pose), setup, reading.time)
    return observation


def _cells(observation: Observation, readings: Sequence[Reading]) -> list[set[Cell]]:
    """Return the cells in which each reading feels a rest."""
    found: list[set[Cell]] = [set() for _ in readings]
    for index, setup in enumerate(observation.setups):
        mine = [i for i, reading in enumerate(readings) if reading.setup == setup.name]
        poses = np.array([readings[i].pose for i in mine])
        for direction in directions_of(setup) if mine else ():
            for felt in observation.felt(index, poses, np.ones_like(poses), direction):
                for at in np.flatnonzero(felt.reach):
                    found[mine[at]].add((felt.function, int(felt.cells[at])))
    return found


def _wanders_on(observation: Observation, setup: int, time: float | None) -> bool:
    """Whether the drift of a set-up has to be followed to a time beyond what the map knows, s."""
    if time is None or observation.setups[setup].drift == 0:
        return False
    course = observation.courses.get((setup, 0))
    return course is None or course.needs_node(time)


_NOTHING = Seen(np.zeros((0, 0)), np.zeros(0), np.zeros(0))


def _course(setup: Setup, times: Sequence[float]) -> Course:
    """Return the drift over times, in order, s."""
    course = Course.begun(setup.drift, times[0], 0)
    for time in times:
        if course.needs_node(time):
            course = course.with_node(time, len(course.columns))
    return course
