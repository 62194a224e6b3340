"""The departures that a plan is to be defended against, as columns b at any candidate.

When a reading will be taken is not known before the way is: of a set-up that is read out and back, a place on the way
out is at half its share of the travel, one on the way back as far from the end. Where several axes move, a place is
read when the nearest one of a plan is.
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
from axiscal.design.plan.out_and_back import repeats, returns
from axiscal.estimation.defence import COUNTED, largest
from axiscal.estimation.departed_volume import field
from axiscal.measurement.departures import (
    COME_AND_GO,
    IN_PLANS,
    Departure,
    Family,
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
_PARTS = 1000
"""Where no side is asked for, every other thousandth of the travel is read on the way back."""


Humps = Literal["bump", "detail"]
ON_THE_WAY: frozenset[Family] = COUNTED - COME_AND_GO
"""Families that places on a way out and back can show; what comes and goes on it, only what is read after it."""


class OneWay(NamedTuple):
    """When places along one way are read.  at : (m,) m or rad, ascending; share : (m,) of the time of the set-up"""

    at: Array
    share: Array


class RoundTrip(NamedTuple):
    """The way that rises and the one that falls."""

    out: OneWay
    back: OneWay


class ShortWay(NamedTuple):
    """When places of several axes are read.  poses : (m, q) m or rad; share : (m,) of the time of the set-up"""

    poses: Array
    share: Array


Times = Mapping[int, RoundTrip | ShortWay]


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
    """

    observation: Observation
    departures: tuple[Departure, ...]
    single: int
    fields: Array
    beside: Array
    most: Array
    weights: Array
    times: Times

    @property
    def count(self) -> int:
        """How many columns there are, k."""
        return len(self.beside)

    def columns(self, places: Places) -> Array:
        """Return b of all numbers at places, those of one place beside each other, (numbers, k)."""
        parts, numbers, effects = [], self._numbers(places), self._effects(places)
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
    """Return the same with the times of a plan: places between its readings are read between them.

    order : its readings; ends : (m,) when each ends, s
    """
    times = dict(watched.times)
    times |= _on_short_ways(watched.observation, order, ends)
    for index, mine in order.by_setup():
        evenly = times.get(index)
        if isinstance(evenly, RoundTrip) and len(mine) > 1:
            (k,) = watched.observation.setups[index].moves
            share = _shares(ends[mine])
            out = _on_the_way_out(watched.observation, index, order.within(mine))
            first, _ = repeats(np.column_stack([order.poses[mine], order.approaches[mine]]))
            once = np.isin(np.arange(len(mine)), first)
            passes = [_pass(order.poses[mine, k][part & once], share[part & once]) for part in (out, ~out)]
            times[index] = RoundTrip(*(new or old for new, old in zip(passes, evenly, strict=True)))
    return replace(watched, times=MappingProxyType(times))


def at_share(watched: Watch, share: float) -> Watch:
    """Return the same for readings at one share of the time of their set-up."""
    nowhere = np.zeros((1, len(watched.observation.machine.axes)))
    way = ShortWay(nowhere, np.array([share]))
    return replace(watched, times=MappingProxyType(dict.fromkeys(range(len(watched.observation.setups)), way)))


def _pass(at: Array, share: Array) -> OneWay | None:
    """Return when places along one way are read; None where nobody is told."""
    order = np.argsort(at, kind="stable")
    return OneWay(at[order], share[order]) if len(at) else None


def _on_short_ways(observation: Observation, order: Places, ends: Array) -> dict[int, ShortWay]:
    """Return when places are read where several axes move, by the way through readings.  ends : (m,) of each, s"""
    groups = [(index, mine) for index, mine in order.by_setup() if not returns(observation.setups[index])]
    return {index: ShortWay(order.poses[mine], _shares(ends[mine])) for index, mine in groups if len(mine) > 1}


def _shares(ends: Array) -> Array:
    """Return at what share of the way of their set-up readings are taken.  ends : (m,) in their order, s"""
    shares: Array = (ends - ends[0]) / (ends[-1] - ends[0])
    return shares


def watch(
    observation: Observation,
    yardstick: Yardstick,
    lattice: Places,
    order: Places,
    ends: Array,
    humps: Humps = "bump",
    families: frozenset[Family] = ON_THE_WAY,
) -> Watch:
    """Return what readings at the places of a lattice are to be watched for.

    lattice : the candidates; order : readings of a plan, from which the way is known where several axes move
    ends : (m,) when each of them ends, s; humps : which of both, readings that would show every detail show the bumps
    families : that are watched for
    """
    known: dict[int, RoundTrip | ShortWay] = {**_evenly(observation), **_on_short_ways(observation, order, ends)}
    times: Times = MappingProxyType(known)
    sought = families - {"bump", "detail"} | {humps}
    found = _thinned([each for each in _departures(observation, lattice, times) if each.family in sought])
    found = sorted(found, key=lambda each: each.columns.shape[1])
    fields = [
        (np.zeros((len(yardstick.root.matrix), 1)), 0.0) if each.function is None else field(yardstick, each)
        for each in found
    ]
    groups = [(each.family, each.owner) for each in found]
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
    groups: dict[tuple[str, str], list[Departure]] = {}
    for each in found:
        groups.setdefault((each.family, each.owner), []).append(each)
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


def _evenly(observation: Observation) -> dict[int, RoundTrip]:
    """Return the times of ways that rise first and go evenly."""
    times = {}
    for index, setup in enumerate(observation.setups):
        if returns(setup):
            (k,) = setup.moves
            ends = np.array(setup.span(observation.machine.axes[k], k))
            times[index] = RoundTrip(OneWay(ends, np.array([0.0, 0.5])), OneWay(ends, np.array([1.0, 0.5])))
    return times


def way_shares(observation: Observation, places: Places, times: Times) -> Array:
    """Return at what share of the way of its set-up each place is read, 0 to 1, (m,); ½ where nobody knows."""
    shares = np.full(len(places), 0.5)
    for index, mine in places.by_setup():
        known = times.get(index)
        if isinstance(known, ShortWay):
            shares[mine] = known.share[_nearest(observation, places.poses[mine], known.poses)]
        elif known is not None:
            at = places.poses[mine, observation.setups[index].moves[0]]
            out = _on_the_way_out(observation, index, places.within(mine))
            there, back = (np.interp(at, each.at, each.share) for each in known)
            shares[mine] = np.where(out, there, back)
    return shares


def _nearest(observation: Observation, poses: Array, among: Array) -> NDArray[np.intp]:
    """Return which of some poses (k, q) is nearest to each of others (m, q), in shares of the travels, (m,)."""
    spans = np.array([axis.length for axis in observation.machine.axes])
    away: Array = poses / spans
    near: Array = among / spans
    squares = np.sum(near**2, axis=1) - 2 * away @ near.T
    nearest: NDArray[np.intp] = squares.argmin(axis=1)
    return nearest


def _on_the_way_out(observation: Observation, index: int, places: Places) -> NDArray[np.bool_]:
    """Return which places of a set-up are read on the way that rises, (m,)."""
    setup = observation.setups[index]
    (k,) = setup.moves
    if len(setup.sides) > 1 and k in observation.errors.reversing:
        rising: NDArray[np.bool_] = places.approaches[:, k] > 0
        return rising
    low, high = setup.span(observation.machine.axes[k], k)
    every_other: NDArray[np.bool_] = np.floor((places.poses[:, k] - low) / (high - low) * _PARTS) % 2 == 0
    return every_other
