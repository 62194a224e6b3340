"""The departures that a plan is to be defended against, as columns b at any candidate.

When a reading will be taken is not known before the way is: a place is read when the nearest one of a plan is, which
it may take the place of; of a set-up that is read out and back, the nearest of its side.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import takewhile
from types import MappingProxyType
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.accuracy.yardstick import Yardstick
from axiscal.design.plan.out_and_back import returns
from axiscal.estimation.defence import COUNTED
from axiscal.estimation.departed_volume import field
from axiscal.estimation.effect_map import LARGEST_SHIFT, largest
from axiscal.measurement.departures import (
    IN_PLANS,
    Departure,
    coming_and_going,
    departures,
    joint_shape,
    shape,
)
from axiscal.measurement.observation import Observation, directions_of
from axiscal.measurement.place import Places
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import numbers_of_setups
from axiscal.numerics import Array

_WAY = 3600.0
"""s: the departures of the drift are asked for on a way of an hour, of which only the shape counts."""
_WATCHED = 400
"""Departures that a search keeps up to date, of time: of more the places are thinned. A search that saw four of nine
places of a step left the others as they were: on a mill 4.7 um were vouched for with 200 of 337, and 3.6 with all.
"""
_PLACES = 16
"""Of a way that nobody planned yet."""

Humps = Literal["bump", "detail"]


class TimedWay(NamedTuple):
    """When places are read.

    poses : (m, q) m or rad; sides : (m,) from where the axis comes that is read out and back, 0 where any will do
    share : (m,) of the time of the set-up
    """

    poses: Array
    sides: Array
    share: Array


Times = Mapping[int, TimedWay]


class _Numbered(NamedTuple):
    """first : (m,) number of each place that is its first; owner : (numbers,) its place; which : (numbers,) of it"""

    first: NDArray[np.intp]
    owner: NDArray[np.intp]
    which: NDArray[np.intp]


@dataclass(frozen=True, eq=False, slots=True)
class Watch:
    """Departures with all their columns, those of one column first, then pairs.

    observation : before any cell is visited; single : how many have one column
    fields : (w, k) V φ; beside : (k,) mean squares that no spline follows, m²; most : (h,) largest sizes
    weights : (h,) one over the number of places of its family
    times : by set-up of which they are known
    doubted : so many readings of a plan may be bad, one of them; theirs are the first columns, 1 at that reading alone
    """

    observation: Observation
    departures: tuple[Departure, ...]
    single: int
    fields: Array
    beside: Array
    most: Array
    weights: Array
    times: Times
    doubted: int = 0

    @property
    def count(self) -> int:
        """How many columns there are, k."""
        return len(self.beside)

    def columns(self, places: Places) -> Array:
        """Return b of all numbers at places not read yet, those of one place beside each other, (numbers, k)."""
        numbers, effects = self._numbers(places), self._effects(places)
        parts = [np.zeros((len(numbers.owner), self.doubted))]
        poses, shares = places.poses[numbers.owner], way_shares(self.observation, places, self.times)[numbers.owner]
        for each in self.departures:
            if each.family == "growth":
                mine = np.where(places.setups[numbers.owner] == each.setup, coming_and_going(shares), 0.0)
                parts.append((mine * self._grown(each, effects, poses))[:, None])
            elif each.function is None:
                parts.append(self._drift(each, places.setups[numbers.owner], numbers.which, shares))
            elif each.pair is not None:
                along = joint_shape(each.place, each.pair, self.observation.machine.axes, poses)
                parts.append(effects[each.function][:, None] * along)
            else:
                function = self.observation.errors.functions[each.function]
                axis = self.observation.machine.axes[function.axis]
                along = shape(each.family, each.place, function, axis, poses[:, function.axis])
                parts.append(effects[each.function][:, None] * along)
        return np.hstack(parts)

    def _numbers(self, places: Places) -> _Numbered:
        counts = numbers_of_setups(self.observation.setups)[places.setups]
        first = np.cumsum(counts) - counts
        owner = np.repeat(np.arange(len(places)), counts)
        return _Numbered(first, owner, np.arange(len(owner)) - first[owner])

    def _effects(self, places: Places) -> Array:
        """Return what a unit of each error adds to each number, (terms, numbers)."""
        numbers = self._numbers(places)
        effects = np.zeros((len(self.observation.errors.terms), len(numbers.owner)))
        for setup, mine in places.by_setup():
            for which, direction in enumerate(directions_of(self.observation.setups[setup])):
                seen = self.observation.effects(setup, places.poses[mine], places.approaches[mine], direction)
                effects[:, numbers.first[mine] + which] = seen
        return effects

    def _drift(self, each: Departure, setups: NDArray[np.intp], which: NDArray[np.intp], shares: Array) -> Array:
        """Return the column of a drift.  setups, which, shares : of each number, (numbers,)"""
        names = np.array([setup.name == each.owner for setup in self.observation.setups])
        mine = names[setups] & (which == int(each.place))
        drifted = shares
        if each.family == "levelling":
            drifted = (1 - np.exp(-3 * shares)) / (1 - np.exp(-3.0))
        if each.family == "excursion":
            drifted = coming_and_going(shares)
        return np.where(mine, drifted, 0.0)[:, None]

    def _grown(self, each: Departure, effects: Array, poses: Array) -> Array:
        """Return what a growth of one axis adds at its height.  effects : (terms, numbers); poses : (numbers, q)"""
        index = next(n for n, f in enumerate(self.observation.errors.functions) if f.name == each.owner)
        k = self.observation.errors.functions[index].axis
        grown: Array = effects[index] * (poses[:, k] - each.place) / self.observation.machine.axes[k].length
        return grown


def retimed(watched: Watch, order: Places, ends: Array) -> Watch:
    """Return the same with the times of a plan.  order : its readings; ends : (m,) when each ends, s"""
    times = {**watched.times, **_on_ways(watched.observation, order, ends)}
    return replace(watched, times=MappingProxyType(times))


def doubting(watched: Watch, readings: int) -> Watch:
    """Return the same, and any one of so many readings of a plan may be bad besides."""
    ones, none = np.ones(readings), np.zeros(readings)
    return replace(
        watched,
        single=watched.single + readings,
        fields=np.hstack([np.zeros((len(watched.fields), readings)), watched.fields]),
        beside=np.concatenate([none, watched.beside]),
        most=np.concatenate([ones * LARGEST_SHIFT, watched.most]),
        weights=np.concatenate([ones / readings, watched.weights]),
        doubted=readings,
    )


def at_share(watched: Watch, share: float) -> Watch:
    """Return the same for readings at one share of the time of their set-up."""
    way = TimedWay(np.zeros((1, len(watched.observation.machine.axes))), np.zeros(1), np.array([share]))
    return replace(watched, times=MappingProxyType(dict.fromkeys(range(len(watched.observation.setups)), way)))


def _on_ways(observation: Observation, order: Places, ends: Array) -> dict[int, TimedWay]:
    """Return when places are read, by the way through readings.  ends : (m,) when each of them ends, s"""
    return {
        index: TimedWay(order.poses[mine], _sides(observation, index, order.within(mine)), _shares(ends[mine]))
        for index, mine in order.by_setup()
        if len(mine) > 1
    }


def _evenly(observation: Observation) -> dict[int, TimedWay]:
    """Return when places of set-ups of one axis are read that rise once along it and fall once, evenly."""
    ways, along = {}, np.linspace(0.0, 1.0, _PLACES)
    for index, setup in enumerate(observation.setups):
        if returns(setup):
            poses = np.zeros((2 * _PLACES, len(observation.machine.axes)))
            low, high = setup.span(observation.machine.axes[setup.moves[0]], setup.moves[0])
            poses[:, setup.moves[0]] = low + (high - low) * np.concatenate([along, along[::-1]])
            sides = np.repeat([1.0, -1.0], _PLACES) * _both_told(observation, index)
            ways[index] = TimedWay(poses, sides, np.linspace(0.0, 1.0, 2 * _PLACES))
    return ways


def _sides(observation: Observation, index: int, places: Places) -> Array:
    """Return from where places of a set-up are come to on the axis along which it is read out and back, (m,)."""
    told = _both_told(observation, index)
    return places.approaches[:, observation.setups[index].moves[0]] if told else np.zeros(len(places))


def _both_told(observation: Observation, index: int) -> bool:
    """Whether a set-up is read out and back, one side on each way."""
    setup = observation.setups[index]
    return returns(setup) and len(setup.sides) > 1 and setup.moves[0] in observation.errors.reversing


def _shares(ends: Array) -> Array:
    """Return at what share of the way of their set-up readings are taken.  ends : (m,) in their order, s"""
    if not ends[-1] > ends[0]:  # a clock that knows of one time alone
        return np.linspace(0.0, 1.0, len(ends))
    shares: Array = (ends - ends[0]) / (ends[-1] - ends[0])
    return shares


def watch(
    observation: Observation,
    yardstick: Yardstick,
    lattice: Places,
    order: Places,
    ends: Array,
    humps: Humps = "bump",
) -> Watch:
    """Return what readings at the places of a lattice are to be watched for.

    lattice : the candidates; order : readings of a plan, from which the way is known
    ends : (m,) when each of them ends, s; humps : which of both, readings that would show every detail show the bumps
    """
    times: Times = MappingProxyType({**_evenly(observation), **_on_ways(observation, order, ends)})
    sought = COUNTED - {"bump", "detail"} | {humps}
    found = _thinned([each for each in _departures(observation, lattice, times) if each.family in sought])
    found = sorted(found, key=lambda each: each.columns.shape[1])
    fields = [
        (np.zeros((len(yardstick.root.matrix), 1)), 0.0) if each.function is None else field(yardstick, each)
        for each in found
    ]
    groups = [(each.family, each.owner, each.setup) for each in found]
    return Watch(
        observation,
        tuple(found),
        sum(each.columns.shape[1] == 1 for each in found),
        np.hstack([part for part, _ in fields]),
        np.concatenate([np.full(part.shape[1], beside / part.shape[1]) for part, beside in fields]),
        np.array([largest(observation.errors, each) for each in found]),
        np.array([1.0 / groups.count(group) for group in groups]),
        times,
    )


def _thinned(found: Sequence[Departure]) -> list[Departure]:
    """Return departures of all families and owners, of no more places than there is time to watch."""
    groups: dict[tuple[str, str, int | None], list[Departure]] = {}
    for each in found:
        groups.setdefault((each.family, each.owner, each.setup), []).append(each)
    most, kept = max(_WATCHED // max(len(groups), 1), 1), list[Departure]()
    for members in groups.values():
        chosen = np.linspace(0, len(members) - 1, min(most, len(members)) + 2).round().astype(int)
        kept += members if len(members) <= most else [members[index] for index in chosen[1:-1]]
    return kept


def _departures(observation: Observation, lattice: Places, times: Times) -> Sequence[Departure]:
    """Return the departures that the candidates of a lattice could show."""
    setups, shares = observation.setups, way_shares(observation, lattice, times)
    others = numbers_of_setups(setups)[lattice.setups] - 1
    columns = lattice.setups, lattice.poses, lattice.approaches.astype(int), shares, others
    readings = [
        Reading(setups[setup].name, tuple(pose), tuple(sides), 0.0, others=(0.0,) * more, time=_WAY * share)
        for setup, pose, sides, share, more in zip(*(part.tolist() for part in columns), strict=True)
    ]
    names = {setups[index].name for index in times}
    possible = takewhile(lambda each: each.family != "bad", departures(observation, readings, IN_PLANS))
    told = [each for each in possible if each.setup is None or each.setup in times]
    return [each for each in told if each.function is not None or each.setup is not None or each.owner in names]


def way_shares(observation: Observation, places: Places, times: Times) -> Array:
    """Return at what share of the way of its set-up each place is read, 0 to 1, (m,); ½ where nobody knows."""
    shares = np.full(len(places), 0.5)
    for index, mine in places.by_setup():
        if index in times:
            shares[mine] = times[index].share[_nearest(observation, index, places.within(mine), times[index])]
    return shares


def _nearest(observation: Observation, index: int, places: Places, way: TimedWay) -> NDArray[np.intp]:
    """Return which place of a way is nearest to each of others, of its side and in shares of the travels, (m,)."""
    spans = np.array([axis.length for axis in observation.machine.axes])
    away = np.column_stack([places.poses / spans, len(spans) * _sides(observation, index, places)])
    near = np.column_stack([way.poses / spans, len(spans) * way.sides])
    squares = np.sum(near**2, axis=1) - 2 * away @ near.T
    nearest: NDArray[np.intp] = squares.argmin(axis=1)
    return nearest
