"""What machine and instruments may do that a model does not hold, as columns b that readings would show.

Under a departure of size s the readings are y = model + s b. Each family is the same in all set-ups and axes; a family
with places has one column for each place that it may be at.

    drift             τ, hours since the set-up began; levelling off 1 − exp(−3τ)
    excursion         (1 − cos 2πu)/2, u the share of the time of the set-up: a zero that comes and goes; once along a
                      way out and back it is the same on both, like an error of the curve
    growth            the same times (t − c)/travel times the lever of a positioning error, c either end or the middle
    jump              1 from one reading of a set-up on: its zero was set anew, its stand was knocked, its beam broken
    step              1 where the axis is beyond a place, times the lever of the error
    pitch             cos, sin 2πt/p times the lever (screw pitch, encoder line)
    bump, detail      exp(−(t − c)²/w²) times the lever, w the spacing of the knots, or half of it
    reversal varies   ±½ exp(−(t − c)²/w²), w a quarter of the travel, times the lever
    scale             (t − middle)/travel times the lever (thermal growth, a wrong scale)
    together          twist u v of two linear axes, or sag of both, u, v their shares of the travel, times the lever
    bad reading       1 for one reading
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.error_model.model import ErrorFunction, ErrorModel
from axiscal.machine.axis import Axis
from axiscal.measurement.observation import Observation, directions_of
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.remembered import remembered_lately

Family = Literal[
    "drift",
    "levelling",
    "excursion",
    "growth",
    "jump",
    "step",
    "pitch",
    "bump",
    "detail",
    "reversal",
    "scale",
    "together",
    "bad",
]

COME_AND_GO: frozenset[Family] = frozenset({"excursion", "growth"})
"""Families that are gone again when the last reading of a set-up is taken."""
_HOUR, _LEVELLING = 3600.0, 1200.0
"""s: a drift is counted by the hour, and a machine that stood levels out in twenty minutes, or about."""
_PLACES = 48
"""Steps and bumps are looked for at so many places along an axis."""
_PITCHES = (5e-3, 10e-3, 20e-3)
"""Usual pitches of screws, m, where an axis states none."""
_FINEST, _MOST_PITCHES = 2.0, 60
"""A scan over frequencies ends at so many turns per reading, and takes at most so many."""
_OWN_SHARE, _QUARTER, _NARROW = 0.8, 0.25, 0.5
"""Shares: bumps overlap a little, a varying reversal is half as wide as the travel, a detail half as wide as a bump."""
_HUMPS: tuple[Family, ...] = ("bump", "detail")
_FELT = 1e-12
"""m/rad, 1, or rad/rad: rounding of a lever."""
_POINTS = 400
"""Points of an axis: a step is met to a four-hundredth of the travel."""
TWIST, SAG = 0.0, 1.0
"""Places of what two axes do together: no places, but shapes."""
_SIDE = 41
"""Points along each side of a plane: a mean square of two waves is exact to a thousandth."""
_A_LINE = 3
"""So many readings tell a rate from a zero."""
_A_STAND = 2
"""So many readings on either side tell another zero from a bad reading."""


@dataclass(frozen=True, slots=True)
class Search:
    """How closely departures are looked for.

    steps : places of a step along an axis
    scanned : whether periods that nobody stated are looked for at any frequency, in all errors; if not, the usual
        pitches of a screw in the positioning of its axis
    jumps : whether a zero is looked for that jumped. No plan is guarded against that: where the side changes with the
        way, a zero set anew at the turn is the same to its readings as a reversal
    """

    steps: int = _PLACES
    scanned: bool = True
    jumps: bool = True


EVERYWHERE = Search()
"""For what readings say."""
IN_PLANS = Search(steps=9, scanned=False, jumps=False)
"""For what readings could say: enough for a root mean square over the places that a step may have."""


@dataclass(frozen=True, eq=False, slots=True)
class Departure:
    """One departure that may be.

    columns : (m, r) b; its size has the unit of what `columns` are per: m, rad, or per hour of drift
    owner : the set-up, or the error whose curve departs
    place : where, m or rad; the pitch; the index of a reading; of a jump that of the first number after it; of growth
        where the axis is held
    function : index of that error; None where only the readings suffer, of growth too, which its owner has lost again
    pair : the two axes that act together, of which the error is one component; None for what one axis does
    setup : of growth the index of the set-up in the course of which it comes and goes
    """

    family: Family
    owner: str
    columns: Array
    place: float = 0.0
    function: int | None = None
    pair: tuple[int, int] | None = None
    setup: int | None = None


class Followed(NamedTuple):
    """columns : of the error; coefficients : (k, r) of its spline; left : (r, r) mean products of what is left.

    All None where only the readings suffer.
    """

    columns: slice | None
    coefficients: Array | None
    left: Array | None


@dataclass(frozen=True, eq=False)
class _Numbers:
    """All numbers of readings.  setup, reading, number : (m,) indices; time : s; effects : (terms, m).

    to_come : (m,) which of them are not taken yet
    """

    setup: NDArray[np.intp]
    reading: NDArray[np.intp]
    number: NDArray[np.intp]
    time: Array
    poses: Array
    approaches: Array
    effects: Array
    to_come: NDArray[np.bool_]


def departures(
    observation: Observation, readings: Sequence[Reading], search: Search = EVERYWHERE, taken: int | None = None
) -> Iterator[Departure]:
    """Yield what readings could show that the model does not hold; numbers in the order of the readings.

    taken : so many of the readings were taken, and the others are to come: what comes and goes is gone by then
    """
    seen = _numbers(observation, readings, len(readings) if taken is None else taken)
    for index, setup in enumerate(observation.setups):
        for number in range(len(directions_of(setup))):
            yield from _drifts(seen, index, number, setup.name)
            yield from _jumps(seen, index, number, setup.name) if search.jumps else ()
        yield from _growths(observation, seen, index)
    for index in range(len(observation.errors.functions)):
        if np.any(np.abs(seen.effects[index]) > _FELT):
            yield from _of_error(observation, seen, index, search)
    yield from _together(observation, seen)
    for index in range(len(readings)):
        yield Departure("bad", readings[index].setup, (seen.reading == index).astype(float)[:, None], float(index))


@remembered_lately
def every_departure(observation: Observation, readings: tuple[Reading, ...]) -> tuple[Departure, ...]:
    """Return all of them wherever they may be: readings are compared with them, and averaged over them."""
    return tuple(departures(observation, readings))


def _numbers(observation: Observation, readings: Sequence[Reading], taken: int) -> _Numbers:
    names = {setup.name: index for index, setup in enumerate(observation.setups)}
    owners = np.array([names[reading.setup] for reading in readings])
    reading = np.repeat(np.arange(len(readings)), [len(each.values) for each in readings])
    number = np.concatenate([np.arange(len(each.values)) for each in readings])
    poses = np.array([each.pose for each in readings])[reading]
    approaches = np.array([each.approach for each in readings], dtype=float)[reading]
    effects = np.zeros((len(observation.errors.terms), len(reading)))
    for index, setup in enumerate(observation.setups):
        for which, direction in enumerate(directions_of(setup)):
            mine = (owners[reading] == index) & (number == which)
            if np.any(mine):
                effects[:, mine] = observation.effects(index, poses[mine], approaches[mine], direction)
    times = np.array([each.time or 0.0 for each in readings])[reading]
    return _Numbers(owners[reading], reading, number, times, poses, approaches, effects, reading >= taken)


def _drifts(seen: _Numbers, setup: int, number: int, name: str) -> Iterator[Departure]:
    mine = (seen.setup == setup) & (seen.number == number)
    if mine.sum() < _A_LINE:
        return
    since = np.where(mine, seen.time - seen.time[mine].min(), 0.0)
    if np.ptp(since) > 0:
        yield Departure("drift", name, (since / _HOUR)[:, None], float(number))
        yield Departure("levelling", name, np.where(mine, 1 - np.exp(-since / _LEVELLING), 0.0)[:, None], float(number))
        yield Departure("excursion", name, _wave(seen, mine)[:, None], float(number))


def _wave(seen: _Numbers, mine: NDArray[np.bool_]) -> Array:
    """Return what comes and goes once while these numbers are taken, (m,), and nothing of it after the last of them."""
    taken = mine & ~seen.to_come
    begun, ended = float(seen.time[taken].min(initial=np.inf)), float(seen.time[taken].max(initial=-np.inf))
    if not ended > begun:
        return np.zeros(len(seen.time))
    return np.where(taken, coming_and_going((seen.time - begun) / (ended - begun)), 0.0)


def coming_and_going(shares: Array) -> Array:
    """Return what comes and goes once in the course of a set-up, 0 to 1.  shares : of its time, 0 to 1"""
    wave: Array = (1 - np.cos(2 * np.pi * shares)) / 2
    return wave


def _growths(observation: Observation, seen: _Numbers, setup: int) -> Iterator[Departure]:
    """Yield the growth of each linear axis that a set-up moves, held at either end or in the middle."""
    mine = seen.setup == setup
    if len(np.unique(seen.reading[mine])) < _A_LINE or not np.ptp(seen.time[mine]) > 0:
        return
    wave = _wave(seen, mine)
    axes, errors = observation.machine.axes, observation.errors
    for k in observation.setups[setup].moves:
        index = next((n for n, f in enumerate(errors.functions) if f.name == axes[k].positioning_error), None)
        if axes[k].rotary or index is None or not np.any(np.abs(seen.effects[index][mine]) > _FELT):
            continue
        for held in np.linspace(*axes[k].travel, 3).tolist():
            shown = seen.effects[index] * wave * (seen.poses[:, k] - held) / axes[k].length
            yield Departure("growth", errors.functions[index].name, shown[:, None], held, setup=setup)


def _jumps(seen: _Numbers, setup: int, number: int, name: str) -> Iterator[Departure]:
    mine = np.flatnonzero((seen.setup == setup) & (seen.number == number))
    mine = mine[np.argsort(seen.time[mine], kind="stable")]
    for before in range(_A_STAND, len(mine) - _A_STAND + 1):
        last, first = mine[before - 1], mine[before]
        if seen.time[first] > seen.time[last]:
            after = np.zeros(len(seen.time))
            after[mine[before:]] = 1.0
            yield Departure("jump", name, after[:, None], float(first))


def _of_error(observation: Observation, seen: _Numbers, index: int, search: Search) -> Iterator[Departure]:
    function = observation.errors.functions[index]
    axis = observation.errors.machine.axes[function.axis]
    for family, place in _possible(observation, function, axis, len(seen.time), search):
        along = shape(family, place, function, axis, seen.poses[:, function.axis])
        yield Departure(family, function.name, seen.effects[index][:, None] * along, place, index)


def _together(observation: Observation, seen: _Numbers) -> Iterator[Departure]:
    """Yield what two linear axes that one set-up moves may do together, where no error of both is described."""
    axes, errors = observation.machine.axes, observation.errors
    for pair in combinations((k for k, axis in enumerate(axes) if not axis.rotary), 2):
        mine = np.array([set(pair) <= set(setup.moves) for setup in observation.setups])[seen.setup]
        if not np.any(mine) or np.any(np.ptp(seen.poses[mine][:, list(pair)], axis=0) == 0):
            continue
        for component in range(3):
            carrier = _carrier(errors, pair, component)
            if carrier is None or not np.any(np.abs(seen.effects[carrier]) > _FELT):
                continue
            name = f"E{'XYZ'[component]}{''.join(axes[k].name for k in pair)}"
            for place in (TWIST, SAG):
                shown = seen.effects[carrier][:, None] * joint_shape(place, pair, axes, seen.poses)
                yield Departure("together", name, shown, place, carrier, pair)


def _carrier(errors: ErrorModel, pair: tuple[int, int], component: int) -> int | None:
    """Return the curve along one direction of the later axis of two, else of the earlier; None where both hold more."""
    if any(set(plane.axes) == set(pair) and plane.component == component for plane in errors.planes):
        return None
    curves = [n for n, f in enumerate(errors.functions) if f.kind == "motion" and f.basis.size > 1]
    found = [n for n in curves if errors.functions[n].axis in pair and errors.functions[n].component == component]
    return max(found, key=lambda n: errors.functions[n].axis, default=None)


def joint_shape(place: float, pair: tuple[int, int], axes: Sequence[Axis], poses: Array) -> Array:
    """Return what a departure of two axes of size 1 adds at poses (m, q), (m, 1), less what curves of each can hold."""
    lows, highs = np.array([axes[k].travel for k in pair]).T
    shares = 2 * (poses[:, list(pair)] - lows) / (highs - lows) - 1
    sides = shares if place == TWIST else np.cos(np.pi / 2 * shares) - 2 / np.pi
    shape: Array = np.prod(sides, axis=1)[:, None]
    return shape


def _possible(
    observation: Observation, function: ErrorFunction, axis: Axis, count: int, search: Search
) -> Iterator[tuple[Family, float]]:
    """Yield what one error may do, and where."""
    if function.kind == "location" or (function.kind == "motion" and function.basis.size == 1):
        return
    if function.stated_shape:
        return
    low, high = axis.travel
    if function.kind == "reversal":
        yield from (("reversal", float(centre)) for centre in np.linspace(low, high, 5))
        return
    yield from (("step", float(place)) for place in np.linspace(low, high, search.steps + 2)[1:-1])
    for family in _HUMPS:
        apart = _OWN_SHARE * _width(family, function, axis)
        yield from ((family, float(place)) for place in np.arange(low, high, apart))
    yield "scale", 0.0
    yield from (("pitch", pitch) for pitch in _pitches(observation, function, axis, count, search))


def shape(family: Family, place: float, function: ErrorFunction, axis: Axis, at: Array) -> Array:
    """Return what a departure of size 1 adds to an error along its axis, (m, r).  at : (m,) m or rad"""
    low, high = axis.travel
    if family == "pitch":
        turns = 2 * np.pi * at / place
        return np.column_stack([np.cos(turns), np.sin(turns)])
    if family == "step":
        return np.where(at > place, 1.0, 0.0)[:, None]
    if family == "scale":
        linear: Array = ((at - (low + high) / 2) / (high - low))[:, None]
        return linear
    hump: Array = np.exp(-(((at - place) / _width(family, function, axis)) ** 2))[:, None]
    return hump


def followed(departure: Departure, functions: Sequence[ErrorFunction], axes: Sequence[Axis]) -> Followed:
    """Return what splines follow of a departure of size 1 over the travel, by least squares, and what they leave."""
    if departure.function is None:
        return Followed(None, None, None)
    function = functions[departure.function]
    if departure.pair is not None:
        square = np.mean(joint_shape(departure.place, departure.pair, axes, _grid(departure.pair, axes)) ** 2)
        return Followed(None, None, np.array([[square]]))
    axis = axes[function.axis]
    at = axis.travel[0] + axis.length * (np.arange(_POINTS) + 0.5) / _POINTS
    values, rows = shape(departure.family, departure.place, function, axis, at), function.basis.rows(at)
    coefficients: Array = np.asarray(np.linalg.lstsq(rows, values, rcond=None)[0])
    left = values - rows @ coefficients
    return Followed(function.columns, coefficients, left.T @ left / _POINTS)


def _grid(pair: tuple[int, int], axes: Sequence[Axis]) -> Array:
    """Return poses evenly over two axes, (m, q)."""
    poses = np.zeros((_SIDE**2, len(axes)))
    lines = [np.linspace(*axes[k].travel, _SIDE) for k in pair]
    poses[:, list(pair)] = np.stack([each.ravel() for each in np.meshgrid(*lines)], axis=1)
    return poses


def _width(family: Family, function: ErrorFunction, axis: Axis) -> float:
    """Return how wide a hump is, m or rad."""
    if family == "reversal":
        return _QUARTER * axis.length
    return _spacing(function, axis) * (_NARROW if family == "detail" else 1.0)


def _spacing(function: ErrorFunction, axis: Axis) -> float:
    """Return how far apart the knots of an error are, m or rad."""
    return axis.length / max(len(function.basis.knots) - 1, 1)


def _pitches(
    observation: Observation, function: ErrorFunction, axis: Axis, count: int, search: Search
) -> Sequence[float]:
    """Return the stated period, or usual pitches and a scan over frequencies in steps of half a turn per travel."""
    entry = next(e for e in observation.errors.machine.errors if e.name == function.name)
    if entry.period is not None:
        return [entry.period]
    usual = [] if axis.rotary else list(_PITCHES)
    if not search.scanned:
        return usual if function.name == axis.positioning_error else []
    slowest = 2.0 * max(len(function.basis.knots) - 1, 1) / 2
    turns = np.arange(slowest, min(_FINEST * count, slowest + _MOST_PITCHES / 2), 0.5)
    return [*(axis.length / turns).tolist(), *usual]
