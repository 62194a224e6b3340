"""The lower bound: below every plan, and sharp where it is known to be."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.machine import load_machine
from axiscal.measurement.candidates import spread
from axiscal.measurement.reading import Places
from axiscal.planning.bound.certificate import rank_bound
from axiscal.planning.bound.lower_bound import lower_bound, with_main_directions
from axiscal.planning.bound.relaxation import Relaxation
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.next_readings import posed
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.task import Limits
from tests.generators.designs import levered, splines
from tests.generators.texts import setup_text


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


def test_what_few_readings_must_leave() -> None:
    asked = splines(3, 7, 1e-9, 400)
    state = asked.state
    lattice = spread(asked.observation.machine, asked.observation.setups, 5)
    value = state.after_readings(lattice).value
    assert rank_bound(state, 5) <= value * (1 + 1e-12)
    assert rank_bound(state, 0) == pytest.approx(state.value)
    assert rank_bound(state, 1000) == 0.0


UNLIKE = "".join(
    setup_text(f"laser {d}", "interferometer", direction=d, moves=[d.upper()], noise="0.3 um")
    + setup_text(f"dial {d}", "indicator", direction=d, moves=["X", "Y", "Z"], noise="6 um")
    for d in "xyz"
)


@pytest.mark.long
def test_more_candidates_of_set_ups_of_unlike_noise_never_lower_the_bound_by_more_than_a_hundredth() -> None:
    """Little weight of a laser is as much information as many readings of a dial.

    From 500 candidates on the optimum falls by 1.5 %, and then by less than half of that.
    """
    text = f'machine = "three-axis-mill"\nusual = "off"\n[target]\nreadings = 60\n{UNLIKE}'
    case = Case(campaign_from_texts(text, "campaign.toml", load_machine("three-axis-mill").text, "three-axis-mill"))
    places, bounds = (
        make_plan(posed(case, case.knowledge, candidates=500), Limits(60), patience=0.0, bounded=False).places,
        list[float](),
    )
    for count in (500, 1000, 2000):
        asked = posed(case, case.knowledge, candidates=count)
        pool = Pool(asked.observation, asked.lattice)
        bounds.append(lower_bound(pool, asked.state, places, np.ones(len(pool) + 60), 60.0).value)
        assert bounds[-1] > 0.8 * asked.state.after_readings(places).value
    assert bounds[2] > 0.99 * bounds[1]


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


def test_a_bound_by_the_main_directions_alone_is_a_bound_and_little_lower() -> None:
    asked = levered(200)
    pool, state = Pool(asked.observation, asked.lattice), asked.state
    places, costs = pool.lattice.within(np.arange(0, 90, 10)), np.ones(len(pool) + 9)
    reached = state.after_readings(places).value
    whole = lower_bound(pool, state, places, costs, 9.0).value
    fewer = lower_bound(pool, with_main_directions(state, 1e-3 * reached, most=3), places, costs, 9.0).value
    assert 0.97 * whole < fewer < reached


def test_weights_of_a_whole_are_those_of_its_part_scaled_to_the_limit() -> None:
    asked = levered(200)
    pool, places = (
        Pool(asked.observation, asked.lattice),
        asked.lattice.within(np.arange(9) * (len(asked.lattice) // 9)),
    )
    whole = Relaxation(pool, asked.state, places, np.ones(len(pool) + 9), 9.0)
    whole.solved()
    assert set(whole.setups.tolist()) == {0, 1}
    kept = whole.everything.setups == 1
    alone = whole.within(kept)
    part = alone.weighted_as(whole, kept)
    assert np.sum(part.weights) == pytest.approx(9.0)
    shares = whole.weights[kept[whole.support]] / np.sum(whole.weights[kept[whole.support]])
    np.testing.assert_allclose(part.weights / 9.0, shares[shares > 0], rtol=1e-12)
    stood = whole.everything.within(whole.support[kept[whole.support] & (whole.weights > 0)])
    np.testing.assert_array_equal(part.everything.within(part.support).poses, stood.poses)
    whole.weights = np.zeros_like(whole.weights)
    np.testing.assert_array_equal(alone.weighted_as(whole, kept).weights, alone.weights)
