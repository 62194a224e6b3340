"""Readings that go into the zeros of set-ups: the bound knows them, and still no plan of all there are is below it."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.measurement.setup import Unknown
from axiscal.planning.bound.certificate import Dual, groups, zeros_each, zeros_of
from axiscal.planning.bound.lower_bound import lower_bound
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.running_gains import Scores
from axiscal.planning.plan.task import Task
from tests.generators.designs import levered, problem


def with_zeros(std: float, candidates: int, instrument: str = "indicator") -> Task:
    """Return the table under two slides with zeros of a standard deviation."""
    asked = levered(candidates)
    names = ("zero_x", "zero_y", "zero_z") if instrument == "rtest" else ("zero",)
    first, second = asked.observation.setups
    first = replace(first, instrument=instrument, unknowns=tuple(Unknown(name, std) for name in names))
    second = replace(second, unknowns=(Unknown("zero", 2 * std),))
    return problem(asked.observation.machine, (first, second), candidates)


@pytest.mark.long
@pytest.mark.parametrize("std", [1e-6, 3e-5, 1e-3])
@pytest.mark.parametrize("instrument", ["indicator", "rtest"])
@pytest.mark.parametrize("readings", [1, 2, 3])
def test_no_plan_of_all_that_there_are_is_below(std: float, instrument: str, readings: int) -> None:
    asked = with_zeros(std, 16, instrument)
    pool, state = Pool(asked.observation, asked.lattice), asked.state
    bound = lower_bound(pool, state, pool.lattice.within(slice(0, 0)), np.ones(len(pool)), float(readings)).value
    plans = itertools.combinations_with_replacement(range(len(pool)), readings)
    best = min(state.after_readings(pool.lattice.within(np.array(plan))).value for plan in plans)
    assert 0 < bound <= best * (1 + 1e-12)


def test_a_first_reading_tells_little_but_its_zero() -> None:
    asked = with_zeros(1e-3, 100)
    pool = Pool(asked.observation, asked.lattice)
    best = asked.state.value - float(Scores(pool, asked.state).gains.max())
    bound = lower_bound(pool, asked.state, pool.lattice.within(slice(0, 0)), np.ones(len(pool)), 1.0).value
    assert 0.999 * best < bound <= best


@given(st.integers(0, 2**32 - 1), st.floats(-6.0, -3.0), st.integers(2, 6))
def test_any_matrix_with_zeros_bounds_every_plan_that_mounts_both(seed: int, wide: float, readings: int) -> None:
    generator = np.random.default_rng(seed)
    asked = with_zeros(10**wide, 24)
    state, pool = asked.state, Pool(asked.observation, asked.lattice)
    target = state.weighted
    noise = np.abs(target).mean() * generator.normal(size=target.shape) * generator.uniform(0, 0.3)
    dual = Dual(state, generator.uniform(0, 1) * target + noise)
    spent = readings * float((pool.squares(state.observation, dual.reach) / pool.noise).max())
    floor = dual.floor(spent, readings, zeros_of(zeros_each(state, pool.lattice), (0, 1)))
    ways = [np.flatnonzero(pool.lattice.setups == setup) for setup in (0, 1)]
    for _ in range(10):
        each = [generator.choice(ways[0]), generator.choice(ways[1])]
        chosen = np.concatenate([each, generator.integers(len(pool), size=readings - 2)])
        assert floor <= state.after_readings(pool.lattice.within(chosen)).value * (1 + 1e-9)


def test_which_zeros_count() -> None:
    asked = with_zeros(1e-4, 30, "rtest")
    state, lattice = asked.state, asked.lattice
    both = zeros_of(zeros_each(state, lattice), (0, 1))
    assert both is not None
    assert len(both.columns) == 4
    one = zeros_of(zeros_each(state, lattice), (1,))
    assert one is not None
    assert one.stiffness > both.stiffness
    size = asked.observation.errors.size
    np.testing.assert_array_equal(np.sort(both.columns), np.arange(size, size + 4))


def test_a_zero_that_is_known_with_other_things_does_not_count() -> None:
    asked = with_zeros(1e-4, 30)
    state = asked.state
    place = Pool(asked.observation, asked.lattice).lattice.at(3)
    assert zeros_of(zeros_each(state.after_readings(place), asked.lattice), (int(place.setups[0]),)) is None


def test_sets_of_set_ups() -> None:
    assert groups(np.array([0, 0, 2]), 5) == [(0, 2), (0,), (2,)]
    assert groups(np.array([0, 1, 2]), 1) == [(0,), (1,), (2,)]
    assert groups(np.arange(4), 9) == []
