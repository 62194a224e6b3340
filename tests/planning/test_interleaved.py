"""Readings interleaved: what passes looks like no error of the axis, in hardly more time."""

import numpy as np

from axiscal.estimation.promise.causes import passing_columns
from axiscal.measurement.reading import Places
from axiscal.numerics import Array
from axiscal.planning.plan.order import seconds_along, seconds_each
from axiscal.planning.plan.task import Task
from tests.planning.test_out_and_back import apart, one_axis, planned


def passing(task: Task, order: Places) -> Array:
    """Return the columns of what passes but for a cycle, three times as large as usual, (m, q)."""
    ends = np.cumsum(seconds_each(task, order))
    found, _ = passing_columns(task.observation, order, np.arange(len(order)), ends)
    return 3.0 * np.hstack([columns for kind, _, columns in found if kind != "cycle"])


def left(task: Task, order: Places) -> float:
    """Return J with what passes: all unknowns at once."""
    n = task.numbers(order)
    state = task.state.opened(n)
    both = np.hstack([state.wide(n) @ state.root, passing(task, order)]) / n.noise[:, None]
    count = state.root.shape[1]
    covariance = np.linalg.inv(np.eye(both.shape[1]) + both.T @ both)[:count, :count]
    return float(np.trace(state.weighted @ covariance @ state.weighted.T))


def test_j_with_what_passes_falls_by_more_than_the_time_rises() -> None:
    _, task = one_axis()
    before, after = planned(task), apart(task)
    assert sorted(map(tuple, before.poses)) == sorted(map(tuple, after.poses))
    costs = [left(task, each) * seconds_along(task, each) for each in (before, after)]
    assert costs[1] < 0.8 * costs[0]
    assert left(task, after) < 0.8 * left(task, before)
    assert seconds_along(task, after) < 1.02 * seconds_along(task, before)
