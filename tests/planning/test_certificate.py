"""What proves a bound: valid for any matrix and any plan, with zeros of set-ups and weights of all candidates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.estimation.case import Case
from axiscal.measurement.setup import Unknown
from axiscal.planning.bound import relaxation
from axiscal.planning.bound.certificate import Dual, rank_bound, zeros_each, zeros_of
from axiscal.planning.bound.lower_bound import lower_bound
from axiscal.planning.bound.relaxation import Relaxation
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.running_gains import Scores
from axiscal.planning.next_readings import posed
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.task import Limits, Task
from tests.generators.campaigns import built_in
from tests.generators.designs import levered, problem, splines
from tests.generators.texts import setup_text


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


@pytest.mark.parametrize("given", [True, False])
def test_bounds_from_weights_of_all_hold_and_are_hardly_looser(given: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    asked, readings = levered(300), 12
    pool, state = Pool(asked.observation, asked.lattice), asked.state
    plan = make_plan(asked, Limits(readings=readings), bounded=False, patience=0.0)
    places = plan.places if given else pool.lattice.within(slice(0, 0))
    costs = np.ones(len(pool) + len(places))
    asked_of = pool, state, places, costs, float(readings)
    closely = lower_bound(*asked_of).value
    monkeypatch.setattr(relaxation, "_DEAR", 20)  # far sooner than in use
    found = lower_bound(*asked_of).value
    assert 0 < found <= plan.value
    assert closely - found < 0.15 * (plan.value - closely)


def with_zeros(std: float, candidates: int) -> Task:
    """Return the table under two slides with zeros of a standard deviation."""
    found = levered(candidates).observation
    setups = tuple(replace(each, unknowns=(Unknown("zero", n * std),)) for n, each in enumerate(found.setups, 1))
    return problem(found.machine, setups, candidates)


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


def test_a_set_up_that_shows_nothing_but_its_zero_is_bounded_by_what_is_there() -> None:
    """The noise is so large that it, and the zero, leave less than rounding of what else a reading shows."""
    laser = setup_text("laser", "interferometer", direction="y", moves=["X"], noise="5 mm")
    case = Case(built_in(laser, "one-axis"))
    task = posed(case, case.knowledge, candidates=20)
    places = task.lattice.within(slice(3))
    bound = lower_bound(Pool(task.observation, task.lattice), task.state, places, np.ones(23), 3.0)
    assert 0.99 * task.state.value <= bound.value <= task.state.value * (1 + 1e-9)
