"""The order of the readings of a plan, set-up by set-up, and how long they take in it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from axiscal.design.gains.covariance import Covariance, Point
from axiscal.design.plan.task import Task, counting, ordered, way_seconds
from axiscal.numerics import Array


def seconds_of(problem: Task, points: list[Point]) -> float:
    """Return the time of readings on a short way, set-up by set-up."""
    return seconds_along(problem, _by_setup(problem, points))


def seconds_along(problem: Task, order: list[Point]) -> float:
    """Return the time of readings in this order."""
    return sum(way_seconds(problem, before, point) for before, point in steps(problem, order))


def steps(problem: Task, order: list[Point]) -> Iterator[tuple[Point | None, Point]]:
    """Return each reading with where the machine stands before it."""
    return zip([problem.here, *order], order, strict=False)


def _by_setup(problem: Task, points: list[Point]) -> list[Point]:
    """Return the readings in travel order, set-ups in order of their index, the mounted one first."""
    mounted = problem.here.setup if problem.here else -1
    setups = sorted({p.setup for p in points}, key=lambda s: (s != mounted, s))
    groups = [[p for p in points if p.setup == setup] for setup in setups]
    return [group[i] for group in groups for i in ordered(problem, group)]


def in_order(problem: Task, points: list[Point]) -> list[Point]:
    """Return the readings in travel order; the set-up that takes J down fastest per second comes first."""
    setups = {p.setup for p in points}
    groups = {setup: _by_setup(problem, [p for p in points if p.setup == setup]) for setup in setups}
    if len(groups) == 1:
        return groups.popitem()[1]
    done: list[Point] = []
    state: Covariance = problem.state
    while groups:
        mounted = problem.here is not None and problem.here.setup in groups and not done
        after = {setup: state.with_points(group) for setup, group in groups.items()}
        rates = {s: (state.value - after[s].value) / seconds_of(problem, groups[s]) for s in groups}
        best = problem.here.setup if mounted and problem.here else max(rates, key=lambda s: rates[s])
        done, state = done + groups.pop(best), after[best]
    return done


def arriving(problem: Task, before: Point | None, point: Point) -> Array:
    """Return the approach of a reading, with the direction of travel where any direction will do.

    There an axis that stands, or comes from nearer than its overrun, has none: nothing makes it turn.
    """
    counted = counting(problem, point)
    if before is None or before.setup != point.setup:
        return point.approach
    way = point.pose - before.pose
    overrun = np.array([axis.overrun for axis in problem.observation.errors.machine.axes])
    travel = np.sign(way) * (np.abs(way) >= overrun) * (point.approach != 0)
    return np.where(counted != 0, counted, travel)
