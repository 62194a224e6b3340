"""Weights found of all candidates at once: the same optimum as by second derivatives, and bounds that hold."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest

from axiscal.planning.bound import relaxation
from axiscal.planning.bound.lower_bound import lower_bound
from axiscal.planning.bound.relaxation import Relaxation, optimal_weights, turns
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.task import Limits
from tests.generators.designs import levered, splines


def test_turns_end_at_the_optimum_of_the_second_derivatives() -> None:
    asked, limit = splines(2, 7, 0.1, 60), 9.0
    state = asked.state
    rows, variances, owner = state.rows(asked.lattice)
    along = rows / np.sqrt(variances)[:, None] @ state.factor
    count = len(asked.lattice)
    costs = np.linspace(1.0, 2.0, count)
    even = np.full(count, limit / costs.sum())
    best = optimal_weights(along, owner, state.weighted, even, costs, limit, 1e-9)
    found = list(islice(turns(state, along, owner, even, costs, limit), 400))
    assert all(turn.weights @ costs == pytest.approx(limit) for turn in found)
    optimum = next(turns(state, along, owner, best, costs, limit)).dual.value
    assert optimum * (1 - 1e-9) <= found[-1].dual.value <= optimum * 1.002
    assert found[-1].dual.value - optimum < 0.1 * (found[0].dual.value - optimum)


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


def test_candidates_that_may_want_weight_get_it_once(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = levered(300)
    pool, state = Pool(asked.observation, asked.lattice), asked.state
    places = pool.lattice.within(np.arange(0, len(pool), 25))
    sought = Relaxation(pool, state, places, np.ones(len(pool) + len(places)), 12.0)
    slopes = sought.slopes(sought.solved())
    monkeypatch.setattr(relaxation, "_MOST", 30)
    turn = next(sought.over_all(slopes))
    assert len(np.unique(sought.support)) == len(sought.support) == len(turn.slopes) <= len(places) + 30
    np.testing.assert_allclose(turn.slopes, sought.slopes(turn.dual)[sought.support], rtol=1e-6)


@pytest.mark.parametrize("seen", [(1e2, 1e2), (1e3, 1e3), (1e4, 1e3), (1e5, 1e5)])
def test_readings_that_say_the_same_share_their_weight(seen: tuple[float, float]) -> None:
    """Two set-ups at one place, and a third reading that begins with hardly any weight.

    J = 1/(1 + a² (x₁ + x₂)) + 1/(1 + b² x₃) is least where a/(1 + a² (x₁ + x₂)) = b/(1 + b² x₃).
    """
    a, b = seen
    along, limit = np.array([[a, 0.0], [a, 0.0], [0.0, b]]), 9.0
    begun = np.array([4.4955, 4.4955, 0.009])
    found = optimal_weights(along, np.arange(3), np.eye(2), begun, np.ones(3), limit, 1e-6)
    third = (b * (1 + a**2 * limit) - a) / (a * b * (a + b))
    assert found.sum() == pytest.approx(limit)
    assert found[2] == pytest.approx(third, rel=1e-3)
