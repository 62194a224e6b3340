"""The lower bound: below every plan, and sharp where it is known to be."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from axiscal.measurement.reading import Places
from axiscal.planning.bound.lower_bound import lower_bound, with_main_directions
from axiscal.planning.gains.candidate_rows import Pool
from tests.generators.designs import levered, splines


@pytest.mark.parametrize(("knots", "noise", "readings"), [(4, 0.5, 2), (5, 1.0, 3), (5, 0.05, 3)])
def test_no_subset_of_a_small_lattice_beats_it(knots: int, noise: float, readings: int) -> None:
    asked = splines(1, knots, noise, 14)
    pool, state = Pool(asked.observation, asked.lattice), asked.state
    bound = lower_bound(pool, state, pool.lattice.within(slice(0, 0)), np.ones(len(pool)), float(readings)).value
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


def test_what_directions_of_the_target_leave_that_do_not_count_is_no_more_than_was_given_away() -> None:
    asked = levered(200)
    pool, state = Pool(asked.observation, asked.lattice), asked.state
    fewer = with_main_directions(state, 1e-3 * state.value, most=3)
    assert 3 < len(fewer.weighted) < len(state.weighted)
    generator = np.random.default_rng(0)
    for _ in range(20):
        places = pool.lattice.within(generator.integers(len(pool), size=7))
        left, whole = fewer.after_readings(places).value, state.after_readings(places).value
        assert whole - 1e-3 * state.value <= left <= whole * (1 + 1e-12)
    assert with_main_directions(state, state.value, most=len(state.weighted)) is state
