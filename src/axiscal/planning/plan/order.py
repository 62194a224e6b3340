"""The order of the readings of a plan, set-up by set-up, and how long they take in it.

A set-up that moves one axis is read out along it and back again (as ISO 230-2). Read once along, a zero that moves
steadily by 10 µm is a slope of 10 µm, and nothing contradicts it. If the side counts, the way out reads one side, the
way back the other, and neither turns round before a place. `interleaved` goes on from there, so that no drift and no
growth passes for an error of the axis.

Read out and back, a zero that comes and goes is the same on both ways, and an axis that grows and shrinks again has
always grown by half at its far end. Both then look like an error. So pairs of readings change their turns where that
lowers D times the seconds of the plan. D is J with all that passes and with reversals that need a way, less the J that
readings without noise would leave at these places. With rows G, the criterion V and columns P of what passes

    D = tr(K₀⁻¹ B) − tr(K⁻¹ B),    K = K₀ + R + P Pᵀ,    K₀ = G C Gᵀ,    B = G C Vᵀ V C Gᵀ
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.promise.causes import Turning, growing, turning
from axiscal.measurement.reading import Places
from axiscal.measurement.setup import Setup
from axiscal.measurement.travel import reading_seconds, short_way, way_seconds
from axiscal.numerics import Array
from axiscal.planning.plan.task import Limits, Task
from axiscal_core import causes
from axiscal_core.state import unexplained
from axiscal_core.ties import ALIKE, first_best


def seconds_along(task: Task, order: Places) -> float:
    """Return the time of readings in this order."""
    return float(sum(seconds_each(task, order).tolist()))


def seconds_around(task: Task, order: Places, readings: NDArray[np.intp], moved: Places) -> tuple[float, Array]:
    """Return the time of readings in this order, and that to and from each where it has moved, (f,).

    readings : (f,) which; moved : where each has moved to, while the others stay
    """
    own, ends = len(order) + np.arange(len(moved)), np.diff(order.setups, prepend=-1, append=-1) != 0
    before = np.where(ends[readings], own, readings - 1)
    after = np.where(ends[readings + 1], own, readings + 1)
    triples = Places.joined([order, moved]).within(np.stack([before, own, after], axis=1).ravel())
    around = seconds_each(task, triples).reshape(-1, 3)[:, 1:].sum(axis=1)
    return float(seconds_each(task, order).sum()), around


def seconds_each(task: Task, order: Places) -> Array:
    """Return what each reading takes after the one before, (m,).

    Mounting where the set-up changes, the way, settling, reading.
    """
    setups = task.observation.setups
    stays, start = _before(task, order)
    seconds, counted = np.zeros(len(order)), counting(task, order)
    for setup, mine in order.by_setup():
        places = start[mine], order.poses[mine], counted[mine]
        ways = way_seconds(task.observation.machine, setups[setup], *places)
        seconds[mine] = np.where(stays[mine], ways, setups[setup].setup_time) + reading_seconds(setups[setup])
    return seconds


def _before(task: Task, order: Places) -> tuple[NDArray[np.bool_], Array]:
    """Return whether the set-up of each reading is mounted already, (m,), and from where the machine comes, (m, q)."""
    mounted, pose = ([-1], order.poses[:1]) if task.here is None else (task.here.setups, task.here.poses)
    before = np.concatenate([mounted, order.setups])[:-1]
    return before == order.setups, np.concatenate([pose, order.poses])[:-1]


def counting(task: Task, places: Places) -> Array:
    """Return the approaches of readings, (m, q), 0 for axes with no prescribed direction where none matters."""
    counted = np.zeros_like(places.approaches)
    for index, mine in places.by_setup():
        setup = task.observation.setups[index]
        for k in setup.moves:
            if len(setup.sides) == 1 or k in task.observation.errors.reversing:
                counted[mine, k] = places.approaches[mine, k]
    return counted


def in_order(task: Task, places: Places) -> Places:
    """Return the readings in travel order, set-ups as of `set_ups_in_order`."""
    parts = [_on_a_short_way(task, places.within(mine)) for _, mine in places.by_setup()]
    return set_ups_in_order(task, Places.joined(parts)) if parts else places


def set_ups_in_order(task: Task, places: Places) -> Places:
    """Return readings set-up by set-up: the one that takes J down fastest per second comes first.

    places : those of each set-up in their order
    """
    groups = {setup: places.within(mine) for setup, mine in places.by_setup()}
    if len(groups) <= 1:
        return places
    n, order = task.numbers(places), list[int]()
    state = task.state.opened(n)
    told, weighted = {setup: state.whitened(n)[n.setup == setup] for setup in groups}, state.weighted
    seconds = {setup: seconds_along(task, group) for setup, group in groups.items()}
    now, first = state.value, -1 if task.here is None else int(task.here.setups[0])
    while left := [setup for setup in groups if setup not in order]:
        next_ones = [first] if first in left and not order else left
        kept = [unexplained(weighted, np.concatenate([told[s] for s in (*order, one)])) for one in next_ones]
        after = [float(np.sum(each * weighted)) for each in kept]
        rates = [(now - value) / seconds[one] for value, one in zip(after, next_ones, strict=True)]
        best = first_best(np.array(rates), ALIKE)
        order.append(next_ones[best])
        now = after[best]
    return Places.joined([groups[setup] for setup in order])


def _on_a_short_way(task: Task, places: Places) -> Places:
    """Return the readings of one set-up out and back along its axis, or on a short way if several move.

    From where the machine stands, if the set-up is mounted.
    """
    if len(places) < 2:
        return places
    machine, approaches, first = task.observation.machine, counting(task, places), None
    setup = task.observation.setups[int(places.setups[0])]
    if returns(setup):
        return places.within(out_and_back(task, places))
    if task.here is not None and task.here.setups[0] == places.setups[0]:
        first = way_seconds(machine, setup, task.here.poses[0], places.poses, approaches)
    once, place = _at_one_place(np.column_stack([places.poses, approaches]))
    begin = None if first is None else first[once]
    order, _ = short_way(machine, setup, places.poses[once], approaches[once], begin)
    return places.within(np.argsort(np.argsort(order)[place], kind="stable"))


def _at_one_place(rows: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the first reading of each place, (k,), and the number of each reading's place among them, (m,).

    rows : (m, p) poses and approaches
    """
    _, first, place = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    return np.sort(first), np.argsort(np.argsort(first))[place.ravel()]


def arriving(task: Task, order: Places) -> Array:
    """Return the approaches of readings, (m, q), with the direction of travel where any direction will do.

    There an axis that stands, or comes from nearer than its overrun, has none: nothing makes it turn. In touch all axes
    come together, from where their place has them or, if none counts, from anywhere.
    """
    counted = counting(task, order)
    stays, start = _before(task, order)
    way = order.poses - start
    overrun = np.array([axis.overrun for axis in task.observation.machine.axes])
    travel = np.sign(way) * (np.abs(way) >= overrun) * (order.approaches != 0)
    alone = np.where(counted != 0, counted, travel)
    together = np.where(np.any(counted != 0, axis=1)[:, None], order.approaches, 0.0)
    setups = task.observation.setups
    held = np.array([s.chart is not None and s.contact == "held" for s in setups])[order.setups][:, None]
    come = np.where(held, together, alone)
    return np.where(stays[:, None], come, order.approaches)


def inserted(task: Task, order: Places, more: Places) -> tuple[Places, NDArray[np.bool_]]:
    """Return readings with more of them where each costs least time, after the first of its set-up, and which are more.

    Those of a set-up that is neither mounted nor to be mounted are left out.
    """
    added = np.zeros(len(order), dtype=bool)
    for index in range(len(more)):
        each = more.single(index)
        if (at := _cheapest(task, order, each)) is not None:
            order = Places.joined([order.within(slice(at)), each, order.within(slice(at, None))])
            added = np.insert(added, at, True)
    return replace(order, approaches=arriving(task, order)), added


def _cheapest(task: Task, order: Places, place: Places) -> int | None:
    """Return before which reading of an order a place costs least time; None where its set-up is not there."""
    index = int(place.setups[0])
    mine = np.flatnonzero(order.setups == index)
    if not len(mine):
        return 0 if task.here is not None and int(task.here.setups[0]) == index else None
    machine, setup, run = task.observation.machine, task.observation.setups[index], order.within(mine)
    sides, own = counting(task, run)[1:], counting(task, place)
    there = way_seconds(machine, setup, run.poses, place.poses, own)
    back = way_seconds(machine, setup, place.poses, run.poses[1:], sides)
    saved = way_seconds(machine, setup, run.poses[:-1], run.poses[1:], sides)
    return int(mine[np.argmin(there + np.append(back - saved, 0.0))]) + 1


_LONGER = 1e-9
"""s; rounding of a time."""


def returns(setup: Setup) -> bool:
    """Whether a set-up is read out and back: where one axis moves."""
    return setup.chart is None and len(setup.moves) == 1


def out_and_back(task: Task, places: Places) -> NDArray[np.intp]:
    """Return the order (m,) of readings of such a set-up: the shorter way round, the rising one if equal."""
    setup = task.observation.setups[int(places.setups[0])]
    (k,) = setup.moves
    rises = _rises(setup, places.poses[:, k], counting(task, places)[:, k])
    along = np.argsort(places.poses[:, k], kind="stable")
    out, back = along[rises[along]], along[~rises[along]][::-1]
    rising, falling = np.concatenate([out, back]), np.concatenate([back, out])
    longer = seconds_along(task, places.within(rising)) - _LONGER
    return falling if seconds_along(task, places.within(falling)) < longer else rising


def _rises(setup: Setup, at: Array, sides: Array) -> NDArray[np.bool_]:
    """Return which readings are taken on the way that rises, (m,): by their sides where these say it, else by turns.

    at : (m,) m or rad along the axis; sides : (m,) from where it comes
    """
    if len(setup.sides) > 1 and np.all(sides != 0):
        return np.asarray(sides > 0)
    return np.asarray(np.argsort(np.argsort(at, kind="stable")) % 2 == 0)


_LARGER = 3.0
"""Times its default, so large is what passes here: with the defaults readings interleave too little."""
_WOUND = 10.0
"""Times its default, so large is what a reversal lacks here: with the default no order of readings shows it."""
_PAIRS, _WORK = 300, 1e9
"""Pairs that are tried, and operations at most: a hundred pairs leave J within 2 % of what a thousand do."""
_SAME = 1e-9
"""Readings that differ by less of their variances are the same."""
_SEED = 1
"""Any: a plan is the same every time."""
_CHANGES, _FEWEST = 3, 8
"""Of the side, and readings: out and back once, a drift looks like a backlash that differs along the axis."""


class _AtTurns(NamedTuple):
    """What passes at the turns of a set-up: covariances of its zeros and of its growth, (r, r)."""

    zeros: Array
    growth: Array

    @classmethod
    def timed(cls, setup: Setup, clock: Array) -> _AtTurns:
        """Return it.  clock : (r,) of the turns, s"""
        drift = _LARGER * causes.drift(clock, setup.noise, setup.drift)
        growth = _LARGER * causes.GROWTH * setup.noise * causes.growth_functions(clock)
        return cls(drift @ drift.T, growth @ growth.T)


@dataclass(frozen=True, eq=False)
class _OneSetup:
    """Readings of one set-up, in any order.

    exact : tr(K₀⁻¹ B); lasting : (k, k) K₀ + R; weights : B (k, k); owner : (k,) the reading of each number
    shared : (k, k) whether two numbers have one zero; growing : (k, k) how alike two of them grow
    turning : reversals that need a way; inside : (k,) which number of its reading each is; poses : (r, q)
    ways : (r, r) seconds from each reading to each; first : (r,) seconds to each from where the machine stands
    """

    passing: _AtTurns
    exact: float
    lasting: Array
    weights: Array
    owner: NDArray[np.intp]
    shared: Array
    growing: Array
    turning: list[Turning]
    inside: NDArray[np.intp]
    poses: Array
    ways: Array
    first: Array

    def loss(self, turns: NDArray[np.intp]) -> float:
        """Return D.  turns : (r,) of each reading"""
        at = np.ix_(turns[self.owner], turns[self.owner])
        known = self.lasting + self.passing.zeros[at] * self.shared + self.passing.growth[at] * self.growing
        for each in self.turning:
            missing = _WOUND * each.missing(self.poses, np.argsort(turns))[self.inside, self.owner]
            known += np.outer(missing, missing)
        return self.exact - float(np.sum(np.linalg.inv(known) * self.weights))

    def seconds(self, turns: NDArray[np.intp]) -> float:
        """Return the time of the ways.  turns : (r,) of each reading"""
        order = np.argsort(turns)
        return float(self.first[order[0]] + self.ways[order[:-1], order[1:]].sum())


def interleaved(task: Task, limits: Limits, order: Places) -> Places:
    """Return readings with those of set-ups that move one axis interleaved, as far as the time allows.

    order : in which they would be taken, set-up by set-up
    """
    result = order
    for setup in dict.fromkeys(order.setups.tolist()):
        where = np.flatnonzero(order.setups == setup)
        if returns(task.observation.setups[setup]) and len(where) > 2:
            every = np.arange(len(order))
            every[where] = where[_turned(task, limits, result, where)]
            result = result.within(every)
    return result


def _turned(task: Task, limits: Limits, order: Places, where: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the order of the readings of one set-up.  where : (r,) they are, among all"""
    way, count = _way(task, order, where), len(where)
    (axis,) = task.observation.setups[order.setups[where[0]]].moves
    turns, sides = np.arange(count), order.approaches[where, axis]
    others = seconds_along(task, order) - way.seconds(turns)
    most = np.inf if limits.budget is None else max(limits.budget, others + way.seconds(turns))
    enough = _CHANGES if count >= _FEWEST and len({*sides.tolist()}) > 1 else 0

    def cost(turns: NDArray[np.intp]) -> float:
        seconds = others + way.seconds(turns)
        allowed = seconds <= most and np.count_nonzero(np.diff(sides[np.argsort(turns)])) >= enough
        return way.loss(turns) * seconds if allowed else np.inf

    rng, least, tried = np.random.default_rng(_SEED), cost(turns), set[tuple[int, ...]]()
    for _ in range(int(min(_PAIRS, _WORK / (2 * len(way.owner) ** 3)))):
        if len(tried) == math.comb(count, 2):
            break
        changed, pair = turns.copy(), rng.choice(count, 2, replace=False)
        if (swapped := tuple(sorted(pair.tolist()))) in tried:
            continue
        tried.add(swapped)
        changed[pair] = turns[pair[::-1]]
        if (found := cost(changed)) < least:
            turns, least, tried = changed, found, {swapped}
    return np.argsort(turns)


def _way(task: Task, order: Places, where: NDArray[np.intp]) -> _OneSetup:
    mine, index = order.within(where), int(order.setups[where[0]])
    setup, machine = task.observation.setups[index], task.observation.machine
    others = order.within(np.setdiff1d(np.arange(len(order)), where))
    n = task.numbers(mine)
    state = task.after(others).opened(n)
    seen, owner, inside = state.wide(n) @ state.root, n.place, n.part
    lasting, crossed = seen @ seen.T, state.weighted @ seen.T
    weights = crossed.T @ crossed
    grown = [axis[inside, owner] for axis in growing(task.observation, index, mine.poses)]
    counted = counting(task, mine)
    here = task.here if task.here is not None and int(task.here.setups[0]) == index else None
    first = np.zeros(len(mine)) if here is None else way_seconds(machine, setup, here.poses, mine.poses, counted)
    return _OneSetup(
        _AtTurns.timed(setup, np.cumsum(seconds_each(task, order)[where])),
        float(np.sum(np.linalg.pinv(lasting, _SAME, hermitian=True) * weights)),
        lasting + np.diag(n.noise**2),
        weights,
        owner,
        inside[:, None] == inside,
        sum((np.outer(each, each) for each in grown), np.zeros(lasting.shape)),
        turning(task.observation, index, mine.poses, mine.approaches),
        inside,
        mine.poses,
        way_seconds(machine, setup, mine.poses[:, None], mine.poses[None], counted[None]),
        first,
    )
