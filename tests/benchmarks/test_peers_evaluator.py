"""The evaluator that judges both sides agrees with our belief, and with figures found independently."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from axiscal.numerics import Array
from benchmarks.cases import stacked
from benchmarks.peers import evaluator
from benchmarks.peers.features import Features
from benchmarks.peers.problems import CASES, CRITERIA, TRAVEL, CriterionName, Posed, Stacked

EVERY = [Posed(case, criterion) for case in CASES for criterion in CRITERIA]
PUBLISHED = (5.8730, 2.3144, 8.7285, 4.1742, 1.3682, 0.0, 10.0, 7.0444, 3.1836, 5.0)
J_AFTER = (8.435996, 6.86244, 5.29228, 3.73376, 2.21355, 1.07741, 0.62000, 0.19634, 0.09769, 0.07641, 0.06404)


def _somewhere(case: Stacked, count: int, seed: int = 0) -> Array:
    return np.random.default_rng(seed).uniform(0.0, TRAVEL, (count, case.axes))


def test_published_sequence() -> None:
    posed = Posed(CASES[0], "joint")
    taken = np.array(PUBLISHED)[:, None]
    found = [evaluator.value(posed, taken[:count]) for count in range(11)]
    assert found == pytest.approx(J_AFTER, rel=3e-4)
    falls = [evaluator.gain(posed, taken[:i], taken[i]) for i in range(10)]
    assert falls == pytest.approx(-np.diff(found), rel=1e-9)


@pytest.mark.parametrize("posed", EVERY, ids=lambda posed: f"{posed.case.letter}-{posed.criterion}")
def test_agrees_with_our_belief(posed: Posed) -> None:
    problem = stacked(posed.case, 50, posed.criterion == "volume")
    taken = _somewhere(posed.case, 12)
    taken[:3] = np.array([0.0, TRAVEL, TRAVEL / 2])[:, None]
    seen = problem.observation.rows(0, taken, np.ones_like(taken))
    belief = problem.belief.read(seen.rows, np.zeros(12), seen.variances)
    assert evaluator.value(posed, taken) == pytest.approx(problem.root.criterion(belief.factor), rel=1e-9)


@pytest.mark.parametrize("posed", EVERY, ids=lambda posed: f"{posed.case.letter}-{posed.criterion}")
def test_linear_forms_add_up_to_the_criterion(posed: Posed) -> None:
    weight = evaluator.weight(posed.case, posed.criterion)
    for root in (evaluator.weight_root(posed), evaluator.nodes_root(posed)):
        np.testing.assert_allclose(root.T @ root, weight, atol=1e-12)


@pytest.mark.parametrize("name", CRITERIA)
def test_criteria_are_the_integrals_they_say(name: CriterionName) -> None:
    case = Stacked("t", "two", 2, 4, 0.1, 3)
    spread = evaluator.covariance(case, _somewhere(case, 3))
    unit = evaluator.spline(case)
    inner = [10.0 / 3.0, 20.0 / 3.0]

    def integral(function: Callable[[float], float]) -> float:
        return float(quad(function, 0.0, TRAVEL, points=inner)[0])

    def variance(own: Array) -> float:
        return integral(lambda t: float(unit(t) @ own @ unit(t)))

    def share(i: int) -> float:
        return integral(lambda t: float(unit(t)[i])) / TRAVEL

    parts = [variance(spread[:4, :4]), variance(spread[4:, 4:])]
    mean = np.array([share(i) for i in range(4)])
    mixed = 2.0 * mean @ spread[:4, 4:] @ mean
    expected = sum(parts) if name == "joint" else sum(parts) / TRAVEL + mixed
    assert evaluator.value(Posed(case, name), _somewhere(case, 3)) == pytest.approx(expected, rel=1e-8)


@given(st.sampled_from(EVERY), st.integers(0, 10_000))
def test_kernel_poses_the_same_problem(posed: Posed, seed: int) -> None:
    inside = _somewhere(posed.case, 9, seed)
    inside[0], inside[1] = 0.0, TRAVEL
    for fewest, root in ((True, evaluator.weight_root(posed)), (False, evaluator.nodes_root(posed))):
        features = Features.of(posed, fewest)
        np.testing.assert_allclose(features(inside), evaluator.rows(posed.case, inside), atol=1e-12)
        np.testing.assert_allclose(features(features.places), root, atol=1e-12)
        assert not features(features.nothing).any()
