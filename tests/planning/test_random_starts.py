"""Plans from random starts: as good as many plain ones, with the readings asked for, and only where rows add up."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.numerics import Array
from axiscal.planning.plan.beginnings import best_of_random
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.task import Limits, Task
from tests.generators.designs import levered, problem, splines


def plainly(asked: Task, readings: int, rng: np.random.Generator) -> float:
    """Return J after one random start: coordinates move one by one to the best of 51 positions until none does."""
    axes, noise = len(asked.observation.machine.axes), asked.observation.setups[0].noise ** 2
    weights, prior = asked.root.matrix.T @ asked.root.matrix, np.linalg.inv(asked.belief.covariance)
    poses = np.repeat(np.linspace(0.0, 10.0, 51)[:, None], axes, axis=1)
    along = asked.observation.rows(0, poses, np.ones_like(poses)).rows.reshape(51, axes, -1)

    def covariance(rows: Array) -> Array:
        seen = rows.reshape(len(rows), -1)
        return np.asarray(np.linalg.inv(prior + seen.T @ seen / noise))

    rows, before = along[rng.integers(0, 51, (readings, axes)), np.arange(axes)], np.inf
    while (value := float(np.trace(covariance(rows) @ weights))) < before * (1 - 1e-5):
        before = value
        for slot in range(readings):
            c = covariance(np.delete(rows, slot, axis=0))
            for axis in range(axes):
                tried = np.tile(rows[slot], (51, 1, 1))
                tried[:, axis] = along[:, axis]
                g = tried.reshape(51, -1)
                far = g @ c
                gains = np.sum(far @ weights * far, axis=1) / (noise + np.sum(far * g, axis=1))
                rows[slot] = tried[gains.argmax()]
    return value


@pytest.mark.long
def test_a_plan_is_as_good_as_the_best_of_fifty_plain_random_starts() -> None:
    asked, rng = splines(3, 7, 0.05, 1000), np.random.default_rng(3)
    asked = replace(asked, root=asked.yardstick.root)
    best = min(plainly(asked, 20, rng) for _ in range(50))
    assert make_plan(asked, Limits(readings=20), bounded=False).value <= 1.002 * best


def one_axis_each() -> Task:
    """Return levers, reversal and rests, with two set-ups in each of which one slide moves, the first by steps."""
    machine, (first, second) = levered(30).observation.machine, levered(30).observation.setups
    stepped = replace(first, moves=(1,), raster=(0.0, 0.05, 0.0))
    return problem(machine, (stepped, replace(second, moves=(2,))), 200)


def test_the_readings_are_as_many_as_asked_for_on_the_raster_and_from_a_side() -> None:
    asked = one_axis_each()
    found = best_of_random(asked, [(0, 5), (1, 7)], 1e9)
    assert found is not None
    assert found.setups.tolist() == [0] * 5 + [1] * 7
    steps = found.poses[:5, 1] / 0.05
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-9)
    np.testing.assert_array_equal(np.abs(found.approaches), np.abs(np.sign(found.approaches)))
    assert np.all(found.approaches[:5, 1] != 0)
    assert np.all(found.approaches[5:, 2] != 0)
    np.testing.assert_array_equal(
        found.poses[:5, [0, 2]], np.tile(np.array(asked.observation.setups[0].park)[[0, 2]], (5, 1))
    )


def test_the_best_of_random_starts_is_better_than_readings_chosen_at_random() -> None:
    asked, rng = one_axis_each(), np.random.default_rng(1)
    found = best_of_random(asked, [(0, 5), (1, 7)], 1e9)
    assert found is not None
    of = [np.flatnonzero(asked.lattice.setups == setup) for setup in (0, 1)]
    drawn = [np.concatenate([rng.choice(of[0], 5), rng.choice(of[1], 7)]) for _ in range(200)]
    values = [asked.state.after_readings(asked.lattice.within(each)).value for each in drawn]
    assert asked.state.after_readings(found).value < min(values)


def test_there_is_no_random_start_where_rows_do_not_add_up_or_work_is_too_little() -> None:
    assert best_of_random(levered(30), [(0, 4), (1, 4)], 1e12) is None
    assert best_of_random(splines(3, 5, 0.1, 100), [(0, 12)], 1e5) is None
