"""What proves a bound: valid for any matrix and any plan, and the known bounds where it must be them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.planning.bound.certificate import Dual, rank_bound
from axiscal.planning.bound.lower_bound import lower_bound
from axiscal.planning.bound.relaxation import Relaxation
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.running_gains import Scores
from axiscal.planning.plan.task import Task
from tests.generators.designs import levered, splines


def spent(asked: Task, dual: Dual, readings: int) -> float:
    """Return what Σ |Z b|² of a plan from the lattice comes to at most."""
    pool = Pool(asked.observation, asked.lattice)
    return readings * float((pool.squares(dual.state.observation, dual.reach) / pool.noise).max())


@given(st.integers(0, 2**32 - 1), st.integers(1, 6), st.floats(0.0, 2.0))
def test_any_matrix_bounds_every_plan(seed: int, readings: int, size: float) -> None:
    generator = np.random.default_rng(seed)
    asked = splines(2, 4, 0.3, 25)
    state, pool = asked.state, Pool(asked.observation, asked.lattice)
    target = state.weighted
    dual = Dual(state, size * (target + 0.5 * generator.normal(size=target.shape) * np.abs(target).mean()))
    floor = dual.floor(spent(asked, dual, readings), readings)
    for _ in range(10):
        places = pool.lattice.within(generator.integers(len(pool), size=readings))
        assert floor <= state.after_readings(places).value * (1 + 1e-9)


def test_nothing_is_weyl_and_everything_is_the_equivalence_theorem() -> None:
    asked = splines(1, 7, 0.1, 1000)
    state = asked.state
    nothing = Dual(state, np.zeros_like(state.weighted))
    assert nothing.floor(0.0, 3) == pytest.approx(rank_bound(state, 3), rel=1e-9)
    pool = Pool(asked.observation, asked.lattice)
    relaxation = Relaxation(pool, state, pool.lattice.within(slice(0, 0)), np.ones(len(pool)), 7.0)
    for _ in range(20):
        dual = relaxation.solved()
        slopes = relaxation.slopes(dual)
        if not relaxation.grow(slopes):
            break
    assert dual.value == pytest.approx(0.0788, abs=2e-4)
    by_hand = dual.value + float(slopes[relaxation.support] @ relaxation.weights) - 7 * float(slopes.max())
    assert dual.whole - 7 * float(slopes.max()) == pytest.approx(by_hand, rel=1e-6)


def test_both_together_prove_more_than_either() -> None:
    asked = levered(300)
    pool, count = Pool(asked.observation, asked.lattice), 8
    relaxation = Relaxation(pool, asked.state, pool.lattice.within(slice(0, 0)), np.ones(len(pool)), float(count))
    for _ in range(30):
        dual = relaxation.solved()
        slopes = relaxation.slopes(dual)
        if not relaxation.grow(slopes):
            break
    most = count * float(slopes.max())
    assert dual.floor(most, count) > 1.02 * max(rank_bound(asked.state, count), dual.whole - most)


@pytest.mark.parametrize("readings", [1, 4, 9])
def test_rests_are_not_averaged_away(readings: int) -> None:
    """Readings at one place share their rest: the bound knows it, and stays below what greedy picks reach."""
    asked = levered(150)
    pool = Pool(asked.observation, asked.lattice)
    scores = Scores(pool, asked.state)
    for _ in range(readings):
        scores.enter(int(scores.gains.argmax()))
    costs = np.ones(len(pool))
    bound = lower_bound(pool, asked.state, pool.lattice.within(slice(0, 0)), costs, float(readings)).value
    assert 0 < bound <= scores.state.value
    known = Relaxation(pool, asked.state, pool.lattice.within(slice(0, 0)), costs, float(readings), rests=False)
    shared = Relaxation(pool, asked.state, pool.lattice.within(slice(0, 0)), costs, float(readings))
    for each in (known, shared):
        each.begin_everywhere()
    assert shared.solved().value > known.solved().value


def test_one_reading_is_bounded_by_the_best_one() -> None:
    asked = levered(100)
    pool = Pool(asked.observation, asked.lattice)
    best = asked.state.value - float(Scores(pool, asked.state).gains.max())
    assert (
        0.5 * best
        < lower_bound(pool, asked.state, pool.lattice.within(slice(0, 0)), np.ones(len(pool)), 1.0).value
        <= best
    )
