"""Readings chosen together: take one out, put the best one in, until no exchange helps.

On the lattice a reading and its replacement cost O(M) to look at. Afterwards all readings move off the lattice at once,
and each climbs, given all the others.

All readings of a plan moved at once, off the lattice, to where together they leave least.

The whitened rows B of all numbers give J = |Φ|² − tr(Φ Bᵀ (I + B Bᵀ)⁻¹ B Φᵀ). Its gradient with respect to B is −2 (A
Bᵀ)ᵀ A, A = Φ (I + BᵀB)⁻¹. Differences give the change of B with the coordinates. Rests count as noise of each reading's
own here: where two of them would share a cell, the true J decides whether the move is taken.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.charts.room import Chart, arrivals, has_room
from axiscal.measurement.reading import Places
from axiscal.measurement.travel import sides_of
from axiscal.numerics import Array
from axiscal.planning.plan.ground import ground_of
from axiscal.planning.plan.scores import Scores
from axiscal.planning.plan.task import Patience, Task, work_of_climb
from axiscal_core.climb import Climb
from axiscal_core.from_scipy import lowest
from axiscal_core.state import State, gained, unexplained
from axiscal_core.ties import ALIKE, first_best, ranked

_STEP = 1e-6
"""Share of the travel: central differences of smooth rows lose below 1e-8 to bending or rounding, ten times off too."""
_DEAR, _WITHIN = 1e4, 0.9997
"""Times J, what the square of a share too long costs, and the share of a budget that is aimed at: it is just kept."""
_ITERATIONS = 80
"""Iterations; where they are left early the plan is still no worse than before."""


class _Free(NamedTuple):
    """The coordinates that may change, each (f,).

    reading : whose; axis : which, of the machine or of its chart; low, high : of a reading of its set-up, m or rad
    charts : of each; None where it is an axis itself
    """

    reading: NDArray[np.intp]
    axis: NDArray[np.intp]
    low: Array
    high: Array
    charts: tuple[Chart | None, ...]

    @property
    def alone(self) -> _Free:
        """The same where each coordinate has a reading of its own."""
        return self._replace(reading=np.arange(len(self.reading)))

    def coordinates(self, places: Places) -> Array:
        """Return them, (f,) m or rad."""
        coordinates: Array = places.poses[self.reading, np.minimum(self.axis, places.poses.shape[1] - 1)]
        for k, chart in enumerate(self.charts):
            if chart is not None:
                coordinates[k] = chart.places(places.poses[[self.reading[k]]])[0, self.axis[k]]
        return coordinates

    def put(self, places: Places, coordinates: Array) -> Places:
        """Return the places with other values of them, (f,) m or rad; where a chart gives no pose it stays."""
        poses, alone = places.poses.copy(), np.array([chart is None for chart in self.charts], dtype=bool)
        poses[self.reading[alone], self.axis[alone]] = coordinates[alone]
        for k, chart in enumerate(self.charts):
            if chart is None:
                continue
            at = chart.places(poses[[self.reading[k]]])
            at[0, self.axis[k]] = coordinates[k]
            found = chart.poses(at)[0]
            poses[self.reading[k]] = found if np.all(np.isfinite(found)) else poses[self.reading[k]]
        return replace(places, poses=poses)


class _Beside(NamedTuple):
    """The reading of each free coordinate with a little more of it, then with a little less.

    both : (2 f,) places; apart : (f,) how far they are apart, shares of where a reading may be
    """

    both: Places
    apart: Array

    @classmethod
    def of(cls, places: Places, free: _Free) -> _Beside:
        """Return them."""
        alone, span, own = places.within(free.reading), free.high - free.low, free.alone
        further, nearer = (
            own.put(alone, np.clip(own.coordinates(alone) + sign * _STEP * span, free.low, free.high))
            for sign in (1, -1)
        )
        apart = (own.coordinates(further) - own.coordinates(nearer)) / span
        # where a chart gives no pose beside it, nothing changes
        return cls(Places.joined([further, nearer]), np.where(apart > 0, apart, 1.0))


class Minutes(NamedTuple):
    """The seconds that readings in their order may take.

    around : of readings (f,) moved to other places, the seconds of all and of the ways to and from each, (f,)
    """

    budget: float
    around: Callable[[Places, NDArray[np.intp], Places], tuple[float, Array]]

    def over(self, places: Places, free: _Free, beside: _Beside) -> tuple[float, Array]:
        """Return by what share of the budget readings take too long, and its derivative by each free coordinate."""
        seconds, around = self.around(places, np.concatenate([free.reading, free.reading]), beside.both)
        further, nearer = np.split(around, 2)
        slopes = (further - nearer) / beside.apart
        share = seconds / self.budget - _WITHIN
        return share, slopes / self.budget


def relocated(task: Task, places: Places, timed: Minutes | None = None) -> Places:
    """Return the readings, of the same set-ups and from the same sides, where J is lower; the same where it is not.

    timed : the time that they may take, in their order; what takes little more is returned
    Coordinates on a raster stay; what leaves what its chart can give goes back.
    """
    free = _free(task, places)
    if not len(free.reading) or not np.any(task.state.weighted):  # or the tool point moves by no error
        return places
    span = free.high - free.low

    def placed(shares: Array) -> Places:
        return free.put(places, free.low + shares * span)

    def value(shares: Array) -> tuple[float, Array]:
        at = placed(shares)
        beside = _Beside.of(at, free)
        left, slopes = _value(task, at, free, beside)
        if timed is None:
            return left, slopes
        over, slower = timed.over(at, free, beside)
        weight = _DEAR * begun * max(over, 0.0)
        return left + weight * over, slopes + 2 * weight * slower

    begun = task.after(places).value / task.state.value
    start = (free.coordinates(places) - free.low) / span
    ended = placed(np.clip(lowest(value, start, 0.0, 1.0, _ITERATIONS), 0.0, 1.0))
    ended = _that_can_be_taken(task, places, ended)
    return ended if task.after(ended).value < task.after(places).value else places


def _that_can_be_taken(task: Task, before: Places, after: Places) -> Places:
    """Return places on charts as they can be come to from their sides; those that cannot are as they were before."""
    poses, approaches = after.poses.copy(), after.approaches.copy()
    for i, number in enumerate(after.setups.tolist()):
        setup = task.observation.setups[number]
        chart = setup.chart
        if chart is None or np.array_equal(poses[i], before.poses[i]):
            continue
        sides = sides_of(chart, chart.places(before.poses[[i]]), setup.coming(before.approaches[[i]]))
        at = chart.places(poses[[i]])
        if has_room(chart, at, sides)[0]:
            approaches[i] = setup.coming(arrivals(chart, at, sides))[0]
        else:
            poses[i] = before.poses[i]
    return Places(after.setups, poses, approaches)


def _free(task: Task, places: Places) -> _Free:
    found = [each for i, number in enumerate(places.setups.tolist()) for each in _coordinates(task, i, number)]
    reading, axis, low, high = np.array([each[:4] for each in found]).reshape(-1, 4).T
    return _Free(reading.astype(np.intp), axis.astype(np.intp), low, high, tuple(each[4] for each in found))


def _coordinates(task: Task, reading: int, number: int) -> Iterator[tuple[int, int, float, float, Chart | None]]:
    """Yield the coordinates of a reading that are on no raster, with their ends, and the chart that they are of."""
    setup = task.observation.setups[number]
    for k, (low, high, step, *_) in enumerate(setup.coordinates):
        if step == 0:
            yield reading, k if setup.chart else setup.moves[k], low, high, setup.chart


def _value(task: Task, places: Places, free: _Free, beside: _Beside) -> tuple[float, Array]:
    """Return J over what there was before, and its gradient with respect to shares of the free coordinates."""
    target, count = task.state.weighted, len(free.reading)
    every, owner = task.whitened(Places.joined([places, beside.both]))
    first = np.searchsorted(owner, np.arange(len(places) + 2 * count + 1))
    own, middle = first[len(places)], first[len(places) + count]
    rows, total = every[:own], float(np.sum(target**2))
    left = unexplained(target, rows)
    slope = -2 * (left @ rows.T).T @ left / total
    of = owner[own:middle] - len(places)
    inside = np.arange(own, middle) - first[len(places) + of]
    changes = np.einsum("ij,ij->i", slope[first[free.reading[of]] + inside], every[own:middle] - every[middle:])
    gradient = np.bincount(of, changes, count) / beside.apart
    return float(np.sum(left * target)) / total, gradient


ROUNDS = 6
"""Rounds of a polish end where no reading moves; this only ends what would go round."""
SWEEPS = 50
"""Sweeps end where no exchange helps; this only ends what would go round."""
_BETTER = 1e-7
"""Rounding of a running gain, with room: what is no better is not exchanged, whatever the last bits say."""
_SETTLED = 3e-4
"""Share of J that a sweep must gain to be followed by another: climbing off the lattice brings more than that."""
_NOTHING = 1e-10
"""Share of what is to be small: readings that hold next to nothing were exchanged for one another without end."""
_WORTH = 1e-6
_WORTH_OF_MANY = 2e-3
_FEW = 120
_CANDIDATES = 4
_IDLE = 8
"""Climbs that find nothing better in a row: the others of a round hardly would either."""
_WORK = 4e9
"""Floating point operations after which an exchange ends: by work, not by the clock, for the same plan anywhere."""


def exchange(scores: Scores, sweeps: int = SWEEPS, better: float = _BETTER) -> float:
    """Exchange readings for candidates until a whole sweep finds nothing better; return the work, in operations.

    better : by this share of what a reading brings, another one must bring more
    """
    work, changes, looked = 0.0, 0, dict[int, int]()
    for _ in range(sweeps):
        value, least = scores.value, _NOTHING * scores.value
        for slot in ranked(-scores.losses(), ALIKE).tolist():
            if looked.get(slot) == changes or scores.held_alone(slot):
                continue
            if work > _WORK:
                return work
            looked[slot] = changes
            gains, own = scores.without(slot)
            best = first_best(gains, ALIKE)
            work += 4.0 * scores.count
            if gains[best] > own + max(better * own, least):  # the others have to be looked at anew
                scores.put(best, slot)
                work += scores.count * (6.0 * scores.slots + 2.0 * scores.task.belief.size)
                changes += 1
        if value - scores.value <= _SETTLED * value:
            break
    return work


def polish(scores: Scores, rounds: int, patience: Patience) -> None:
    """Move all readings off the lattice at once, then climb them one by one, until a round gains little."""
    size = scores.task.belief.size
    work = work_of_climb(size, size + len(scores.state.weighted))
    least = _WORTH if size <= _FEW else _WORTH_OF_MANY  # rounds are dear with many unknowns
    for _ in range(rounds):
        before = scores.value
        if not patience.spent:
            _move(scores)
            patience.take(work * len(scores.places))
        _climb_all(scores, patience, work)
        if patience.spent or before - scores.value <= least * before:
            return


def _move(scores: Scores) -> None:
    found = relocated(scores.task, scores.places)
    for slot in np.flatnonzero(np.any(found.poses != scores.places.poses, axis=1)).tolist():
        if not scores.held_alone(slot):
            scores.put(found.single(slot), slot)


def _climb_all(scores: Scores, patience: Patience, work: float) -> None:
    """Put the best reading there is, on the lattice or off it, into each slot; work : of one climb, operations"""
    idle = 0
    for slot in range(len(scores.places)):
        if patience.spent or idle > _IDLE:
            return
        if scores.held_alone(slot):
            continue
        patience.take(work)
        found = _better(scores, slot)
        if found is not None:
            scores.put(found, slot)
        idle = 0 if found is not None else idle + 1


def _better(scores: Scores, slot: int) -> Places | None:
    """Return the best reading for a slot, or None where none is better than what it holds."""
    task, (gains, own) = scores.task, scores.without(slot)
    state = task.after(scores.places.without(slot))
    found = _climbed(task, state, scores.lattice.within(ranked(gains, ALIKE, _CANDIDATES)), scores.places.single(slot))
    n = task.numbers(found)
    more = state.gains(n, np.arange(len(n.rows))[None])[0] > own * (1 + _BETTER)  # tables are changed for it only
    return found if more else None


def _climbed(task: Task, state: State, candidates: Places, old: Places) -> Places:
    """Return the best reading found from a reading and the best candidates, by Newton's steps and looks.

    state : without the reading
    Cells visited by others are taken for fresh ones meanwhile: their edges would cut every line into small pieces.
    """
    starts, bare = Places.joined([old, candidates]), state.of_first(task.observation.size)
    found = [(setup, _climb(task, bare, setup, *starts.in_setup(setup))) for setup, _ in starts.by_setup()]
    if not (climbs := [each for each in found if len(each[1].gains)]):  # places of a raster may leave nothing to climb
        return old
    setup, climb = climbs[first_best(np.array([each.gains.max() for _, each in climbs]), ALIKE)]
    return Places.one(setup, *(part[first_best(climb.gains, ALIKE)] for part in climb.readings))


def climb_from(task: Task, state: State, setup: int, poses: Array, approaches: Array) -> Climb:
    """Return the climb from readings of a set-up.  state : as if no cell had been read; poses, approaches : (n, q)"""
    observation = task.observation
    ground = ground_of(observation, setup)

    def gains(places: Array, sides: Array) -> Array:
        seen = observation.numbers(Places.of_setup(setup, *ground.as_poses(places, sides)))
        return gained(*state.of_places(seen, len(observation.setups[setup].names)))

    def taken(places: Array, sides: Array) -> Array:
        can = ground.approachable(places, sides)
        if can is None:
            return gains(places, sides)
        found = np.full(len(places), -np.inf)
        if can.any():
            found[can] = gains(places[can], sides[can])
        return found

    return Climb.begun(ground, taken, *ground.as_places(poses, approaches))


def _climb(task: Task, state: State, setup: int, poses: Array, approaches: Array) -> Climb:
    climb = climb_from(task, state, setup, poses, approaches)
    climb.newton(3)
    climb = climb.distinct().best(1, 0.0, 1.0)
    climb.uphill()
    return climb
