"""What only readings suffer: zeros that drift or go to and fro, axes that grow while they are read.

A zero drifts by a line, Brownian motion over the time T of its set-up, and Matérn-1/2 in time with 6 min. The Brownian
motion has Karhunen-Loève functions √2 sin((k − ½)π t/T)/((k − ½)π), k = 1…20, which leave 0.5 % of its variance. A
linear axis grows by the coordinate over its travel times Matérn-3/2 in time with 0.4 T, linear between ten nodes.
Without what usually goes wrong a zero wanders as stated (`measurement.drift`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.description.causes import CYCLE, DRIFT, GROWTH
from axiscal.description.sizes import Kind, Sizes
from axiscal.errors.prior import exponential, matern32
from axiscal.measurement.drift import Course, wandering
from axiscal.measurement.observation import Observation, directions_of
from axiscal.measurement.place import Places
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import times_of
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.numerics.gaussian import lower_root

_FUNCTIONS = 20
"""They leave 0.5 % of the variance of Brownian motion: 1 − Σ 2/((k − ½)π)²."""
_NODES = 10
"""Five in a length of 0.4: what lies between two of them is straight to a tenth."""
_CYCLE_SECONDS = 360.0
"""s, six minutes: assumption."""
_MEMORY = 0.4
"""Of the set-up's time: over so much the growth of an axis forgets itself."""
_LONGEST = 4 * 3600.0
"""s: over a longer time six minutes are too short to be told from noise."""
_MOST = 300
"""Numbers beyond which the columns of a cycle would cost more than everything else."""
_SINGLE = 1e-9
"""Added to a correlation of readings at one time."""


class Passing(NamedTuple):
    """columns : (m, q) of all numbers, m or rad, sizes as usual; size_at : (q,) number of each one's θ, −1 for none."""

    columns: Array
    size_at: NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class _Mine:
    """The numbers of one set-up's readings.

    first : (r,) which number of all is the first of each reading; clock : (r,) s; length : T, s
    """

    setup: Setup
    index: int
    poses: Array
    approaches: Array
    first: NDArray[np.intp]
    clock: Array

    @property
    def length(self) -> float:
        """T, s; 1 where all readings have one time."""
        return float(np.ptp(self.clock)) or 1.0

    @property
    def share(self) -> Array:
        """Times as shares of T, (r,)."""
        result: Array = (self.clock - self.clock.min()) / self.length
        return result


def passing_columns(
    observation: Observation,
    readings: Sequence[Reading],
    places: Places,
    reading: NDArray[np.intp],
    sizes: Sizes,
    usual: bool = True,
) -> Passing:
    """Return the columns.

    reading : (m,) the reading of each number, ascending; readings have their times
    usual : with what usually goes wrong; else zeros wander as stated and nothing besides
    """
    times, parts, size_at = np.nan_to_num(times_of(readings)), list[Array](), list[int]()
    for index, chosen in places.by_setup():
        which = np.arange(len(places))[chosen]
        first = np.searchsorted(reading, which)
        setup = observation.setups[index]
        mine = _Mine(setup, index, places.poses[which], places.approaches[which], first, times[which])
        made_of = (_of_zeros(mine, len(reading)), _of_axes(observation, mine, len(reading)))
        for kind, made in chain(*made_of) if usual else _as_stated(mine, len(reading)):
            parts.append(made)
            size_at += [sizes.index(kind, setup.name)] * made.shape[1]
    columns = np.hstack(parts) if parts else np.zeros((len(reading), 0))
    return Passing(columns, np.array(size_at, dtype=np.intp))


def _of_zeros(mine: _Mine, numbers: int) -> Iterator[tuple[Kind, Array]]:
    """Yield the columns of drift and cycle of each zero of a set-up."""
    noise, share = mine.setup.noise, mine.share
    turns = (np.arange(_FUNCTIONS) + 0.5) * np.pi
    drift = np.column_stack([share, np.sqrt(2.0) * np.sin(np.outer(share, turns)) / turns])
    functions: list[tuple[Kind, Array]] = [("drift", _drift_size(mine) * drift)]
    if mine.length <= _LONGEST and numbers <= _MOST:
        apart = np.abs(mine.clock[:, None] - mine.clock[None]) / _CYCLE_SECONDS
        root: Array = CYCLE.size * noise * lower_root(exponential(apart) + _SINGLE * np.eye(len(apart)))
        functions.append(("cycle", root))
    yield from _of_each_zero(mine, numbers, functions)


def _as_stated(mine: _Mine, numbers: int) -> Iterator[tuple[Kind, Array]]:
    """Yield the columns of each zero of a set-up that wanders as stated."""
    if mine.setup.drift > 0:
        course = Course.over(mine.setup.drift, np.sort(mine.clock).tolist())
        yield from _of_each_zero(mine, numbers, [("drift", course.rows(mine.clock))])


def _of_each_zero(mine: _Mine, numbers: int, functions: Sequence[tuple[Kind, Array]]) -> Iterator[tuple[Kind, Array]]:
    """Yield the columns of all numbers for functions of a set-up's readings, each zero's apart."""
    for number in range(len(directions_of(mine.setup))):
        for kind, function in functions:
            columns = np.zeros((numbers, function.shape[1]))
            columns[mine.first + number] = function
            yield kind, columns


def _drift_size(mine: _Mine) -> float:
    """Return the size of line and Brownian motion: as usual of the noise, with what is stated or usual of the zero."""
    usual, stated = DRIFT.size * mine.setup.noise, 0.0
    if mine.setup.drift > 0:
        stated = float(np.sqrt(wandering(mine.setup.drift, [mine.length])[0, 0] / 2))
    return float(np.hypot(usual, stated))


def _of_axes(observation: Observation, mine: _Mine, numbers: int) -> Iterator[tuple[Kind, Array]]:
    """Yield the columns of the growth of each linear axis that moves in a set-up and whose positions are an error."""
    nodes = np.linspace(0.0, 1.0, _NODES)
    correlation = matern32(np.abs(nodes[:, None] - nodes[None]) / _MEMORY)
    root = lower_root(correlation + _SINGLE * np.eye(_NODES))
    hats = np.column_stack([np.interp(mine.share, nodes, each) for each in np.eye(_NODES)]) @ root
    machine, levers = observation.machine, None
    for k in mine.setup.moves:
        axis = machine.axes[k]
        term = next((i for i, t in enumerate(observation.errors.terms) if t.name == f"E{axis.name}{axis.name}"), None)
        if term is None or axis.rotary:
            continue
        levers = observation.levers(mine.index, mine.poses) if levers is None else levers
        along = (mine.poses[:, k] - np.mean(axis.travel)) / axis.length
        columns = np.zeros((numbers, _NODES))
        for number, lever in enumerate(levers):
            columns[mine.first + number] = (lever[term] * along)[:, None] * hats
        yield "growth", GROWTH.size * mine.setup.noise * columns
