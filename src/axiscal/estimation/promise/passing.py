"""What only readings suffer: drift and growth; and which share of a reversal has not come yet.

Functions of time and way are those of `axiscal_core.causes`. Of more than there are readings come as many columns
as of these: Lᵀ of Z Zᵀ = L Lᵀ. Without what usually goes wrong a zero wanders as stated (`measurement.cells`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.description.usual import CYCLE, DRIFT, GROWTH, WAY, needs_a_way
from axiscal.measurement.cells import Course, wandered
from axiscal.measurement.instrument import instrument_of, values_of
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places, Reading
from axiscal.measurement.reading_rows import numbers_of_setups, places_of, times_of
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.numerics.gaussian import lower_root, of_rank
from axiscal_core import causes
from axiscal_core.theta import Kind, Sizes

_ONE_WAY = 0.5
"""Share by which one way round prevails: with a quarter of circles the other way a lag is told from squareness."""


class Passing(NamedTuple):
    """What only readings suffer.

    columns : (m, q) of all numbers, m or rad, sizes as usual; size_at : (q,) number of each one's θ, −1 for none
    kinds : (q,) cause of each
    """

    columns: Array
    size_at: NDArray[np.intp]
    kinds: tuple[Kind, ...]


@dataclass(frozen=True, eq=False)
class _Mine:
    """The numbers of one set-up's readings.

    first : (r,) which number of all is the first of each reading; clock : (r,) s
    """

    setup: Setup
    index: int
    poses: Array
    approaches: Array
    first: NDArray[np.intp]
    clock: Array


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
    times, parts = np.nan_to_num(times_of(readings)), list[Array]()
    size_at, kinds = list[int](), list[Kind]()
    for index, chosen in places.by_setup():
        which = np.arange(len(places))[chosen]
        first = np.searchsorted(reading, which)
        setup = observation.setups[index]
        mine = _Mine(setup, index, places.poses[which], places.approaches[which], first, times[which])
        made_of = (_of_zeros(mine, len(reading)), _of_axes(observation, mine, len(reading)))
        for kind, made in chain(*made_of) if usual else _as_stated(mine, len(reading)):
            parts.append(made)
            size_at += [sizes.index(kind, setup.name)] * made.shape[1]
            kinds += [kind] * made.shape[1]
    columns = np.hstack(parts) if parts else np.zeros((len(reading), 0))
    return Passing(columns, np.array(size_at, dtype=np.intp), tuple(kinds))


def absent(observation: Observation, readings: Sequence[Reading], places: Places) -> dict[str, Array]:
    """Return, by its name, which share of each part of a reversal is missing at readings, (readings, ways)."""
    times, found = np.nan_to_num(times_of(readings)), dict[str, Array]()
    for index, chosen in places.by_setup():
        which = np.arange(len(places))[chosen]
        poses, order = places.poses[which], np.argsort(times[which], kind="stable")
        for turn in turning(observation, index, poses, places.approaches[which]):
            shares = [turn.absent(poses, order, way) for way in causes.WAYS]
            found.setdefault(turn.name, np.zeros((len(places), len(shares))))[which] = np.transpose(shares)
    return found


class AtFeed(NamedTuple):
    """What servos do to a circle of a ball bar, which runs at feed.

    setup : its name; both : whether it went round both ways: by one way alone a lag is squareness
    lag : (1, m) m of all numbers, of a noise; late : (q, m) what is missing of reversals, of as much as is stated
    """

    setup: str
    both: bool
    lag: Array
    late: Array


def at_feed(observation: Observation, readings: Sequence[Reading]) -> Iterator[AtFeed]:
    """Yield what servos do to each circle: axes that lag differently, and reversals that come some way after the turn.

    At a feed v axes lag by v τ. Along a bar at angle φ that shows ± v Δτ sin φ cos φ, the sign that of the way round.
    """
    places, times = places_of(observation.setups, readings), np.nan_to_num(times_of(readings))
    last = np.cumsum(numbers_of_setups(observation.setups)[places.setups])
    for index, chosen in places.by_setup():
        setup = observation.setups[index]
        if instrument_of(setup).site != "bar":
            continue
        which = np.arange(len(places))[chosen]
        turns = turning(observation, index, places.poses[which], places.approaches[which])
        seen = [turn for turn in turns if np.any(turn.effects)]
        if len(seen) != 2:  # of three, on a circle
            continue
        order, numbers = np.argsort(times[which], kind="stable"), last[which] - 1
        one, other = (turn.effects[0] / np.abs(turn.effects).max() for turn in seen)
        missing = [turn.missing(places.poses[which], order, way)[0] for turn in seen for way in causes.WAYS]
        lag, late = np.zeros((1, last[-1])), np.zeros((len(missing), last[-1]))
        lag[0, numbers] = setup.noise * one * np.abs(other)
        late[:, numbers] = 2 / WAY.size * np.array(missing)
        ways = lag[0, numbers] * one * seen[0].sides * other * seen[1].sides
        yield AtFeed(setup.name, bool(abs(ways.sum()) < _ONE_WAY * np.abs(ways).sum()), lag, late)


def drift_functions(setup: Setup, clock: Array) -> Array:
    """Return how far a zero of a set-up has drifted at some times, of unknowns of variance one, (r, 21) m or rad.

    clock : (r,) s; their size is usual of the noise, with what is stated or usual of the zero
    """
    usual, stated = DRIFT.size * setup.noise, 0.0
    if setup.drift > 0:
        stated = float(np.sqrt(wandered(setup.drift, causes.time_of(clock)) / 2))
    return float(np.hypot(usual, stated)) * causes.drift_functions(clock)


def growth_functions(setup: Setup, clock: Array) -> Array:
    """Return by how much a linear axis has grown at some times, of unknowns of variance one, (r, 10) m.

    clock : (r,) s; both ends of the travel then stand off by half of it
    """
    return GROWTH.size * setup.noise * causes.growth_functions(clock)


def growing(observation: Observation, index: int, poses: Array) -> list[Array]:
    """Return what growth by one does to each number of readings of a set-up, (k, r), for each axis that may grow.

    A linear axis may if it moves in the set-up and its positions are an error.  poses : (r, q)
    """
    machine, levers, found = observation.machine, None, list[Array]()
    for k in observation.setups[index].moves:
        axis = machine.axes[k]
        term = next((i for i, t in enumerate(observation.errors.terms) if t.name == axis.positioning_error), None)
        if term is None or axis.rotary:
            continue
        levers = observation.levers(index, poses) if levers is None else levers
        along = (poses[:, k] - np.mean(axis.travel)) / axis.length
        found.append(np.array([lever[term] * along for lever in levers]))
    return found


@dataclass(frozen=True, eq=False)
class Turning:
    """A reversal of a linear axis that may need a way to be complete.

    name : of the error; axis : k; overrun : m, that the axis has come since it turned where it comes from another side
    sides : (r,) from where it comes; effects : (k, r) what one standard deviation does to each number when it is whole
    """

    name: str
    axis: int
    overrun: float
    sides: Array
    effects: Array

    def absent(self, poses: Array, order: NDArray[np.intp], way: float) -> Array:
        """Return which share is missing at readings, (r,).

        poses : (r, q); order : (r,) in which they are taken; way : m, over which it comes
        """
        left = np.empty(len(poses))
        left[order] = np.exp(-causes.way_since_turn(poses[order, self.axis], self.sides[order], self.overrun) / way)
        return left

    def missing(self, poses: Array, order: NDArray[np.intp], way: float = causes.WAYS[1]) -> Array:
        """Return what is missing of each number of readings, (k, r) m or rad."""
        return -WAY.size * self.absent(poses, order, way) * self.effects


def turning(observation: Observation, index: int, poses: Array, approaches: Array) -> list[Turning]:
    """Return the reversals of linear axes that readings of a set-up from both sides show.

    poses, approaches : (r, q)
    """
    setup, machine, found = observation.setups[index], observation.machine, list[Turning]()
    terms = [
        (number, term)
        for number, term in enumerate(observation.errors.functions)
        if term.axis in setup.moves and needs_a_way(term.kind, machine.axes[term.axis]) and len(setup.sides) > 1
    ]
    if not terms:
        return []
    levers = observation.levers(index, poses)
    for number, term in terms:
        sides, size = approaches[:, term.axis], 0.5 * float(np.sqrt(term.covariance[0, 0]))
        effects = size * sides * levers[:, number]
        found.append(Turning(term.name, term.axis, machine.axes[term.axis].overrun, sides, effects))
    return found


def _of_zeros(mine: _Mine, numbers: int) -> Iterator[tuple[Kind, Array]]:
    """Yield the columns of drift and cycle of each zero of a set-up."""
    functions: list[tuple[Kind, Array]] = [("drift", of_rank(drift_functions(mine.setup, mine.clock)))]
    alike = causes.cycle_correlation(mine.clock, numbers)
    if alike is not None:
        functions.append(("cycle", CYCLE.size * mine.setup.noise * lower_root(alike)))
    yield from _of_each_zero(mine, numbers, functions)


def _as_stated(mine: _Mine, numbers: int) -> Iterator[tuple[Kind, Array]]:
    """Yield the columns of each zero of a set-up that wanders as stated."""
    if mine.setup.drift > 0:
        course = Course.over(mine.setup.drift, np.sort(mine.clock).tolist())
        yield from _of_each_zero(mine, numbers, [("drift", course.rows(mine.clock))])


def _of_each_zero(mine: _Mine, numbers: int, functions: Sequence[tuple[Kind, Array]]) -> Iterator[tuple[Kind, Array]]:
    """Yield the columns of all numbers for functions of a set-up's readings, each zero's apart."""
    for number in range(values_of(mine.setup)):
        for kind, function in functions:
            columns = np.zeros((numbers, function.shape[1]))
            columns[mine.first + number] = function
            yield kind, columns


def _of_axes(observation: Observation, mine: _Mine, numbers: int) -> Iterator[tuple[Kind, Array]]:
    """Yield the columns of the growth of each axis."""
    axes = growing(observation, mine.index, mine.poses)
    functions = of_rank(growth_functions(mine.setup, mine.clock)) if axes else np.zeros((0, 0))
    for axis in axes:
        columns = np.zeros((numbers, functions.shape[1]))
        for number, share in enumerate(axis):
            columns[mine.first + number] = share[:, None] * functions
        yield "growth", columns
