"""The lower bound: below every plan, and sharp where it is known to be."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from axiscal.design.bound.certificate import rank_bound
from axiscal.design.bound.lower_bound import lower_bound
from axiscal.design.gains.candidate_rows import Pool
from axiscal.measurement.candidates import spread
from axiscal.measurement.place import Places
from tests.generators.designs import levered, splines


def test_seven_readings_on_seven_knots() -> None:
    asked = splines(1, 7, 0.1)
    pool = Pool(asked.observation, asked.lattice)
    bound = lower_bound(pool, asked.state, pool.none, np.ones(len(pool)), 7.0)
    assert bound.value == pytest.approx(0.0788, abs=2e-4)
    assert not bound.everywhere


@pytest.mark.parametrize(("knots", "noise", "readings"), [(4, 0.5, 2), (5, 1.0, 3), (5, 0.05, 3)])
def test_no_subset_of_a_small_lattice_beats_it(knots: int, noise: float, readings: int) -> None:
    asked = splines(1, knots, noise, 14)
    pool, state = Pool(asked.observation, asked.lattice), asked.state
    bound = lower_bound(pool, state, pool.none, np.ones(len(pool)), float(readings)).value
    subsets = itertools.combinations_with_replacement(range(len(pool)), readings)
    best = min(state.after_readings(pool.lattice.within(np.array(subset))).value for subset in subsets)
    assert 0 < bound <= best * (1 + 1e-12)
    assert best < 3 * bound


def test_readings_that_cost_differently_and_points_off_the_lattice() -> None:
    asked = levered(200)
    pool, state = Pool(asked.observation, asked.lattice), asked.state
    places = Places.of_setup(0, asked.lattice.poses[:6] + 0.001, np.ones((6, 3)))
    costs = np.where(np.concatenate([pool.lattice.setups, np.zeros(6)]) == 0, 4.0, 9.0)
    bound = lower_bound(pool, state, places, costs, 24.0)
    generator = np.random.default_rng(0)
    for _ in range(50):
        cheap = generator.choice(np.flatnonzero(costs[: len(pool)] == 4.0), 6)
        assert state.after_readings(pool.lattice.within(cheap)).value >= bound.value
    assert state.after_readings(places).value >= bound.value


def test_what_few_readings_must_leave() -> None:
    asked = splines(3, 7, 1e-9, 400)
    state = asked.state
    lattice = spread(asked.observation.machine, asked.observation.setups, 5)
    value = state.after_readings(lattice).value
    assert rank_bound(state, 5) <= value * (1 + 1e-12)
    assert rank_bound(state, 0) == pytest.approx(state.value)
    assert rank_bound(state, 1000) == 0.0
