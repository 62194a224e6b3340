"""Expanded uncertainties against draws: of the squared length itself, and of machines drawn from a belief."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq
from scipy.special import chdtr, chdtri

from axiscal.estimation.accuracy.expanded import LEVEL, expanded_of, reach

DRAWS = 1_000_000


@pytest.mark.parametrize("degrees", [np.inf, 20.0, 6.0])
def test_over_many_places_u_is_that_of_draws_at_places_drawn_evenly(degrees: float) -> None:
    """Of a normal, and of a multivariate t of the same covariances."""
    rng = np.random.default_rng(2)
    scales, turns = rng.uniform(0.1, 3.0, (200, 1, 1)), np.linalg.qr(rng.standard_normal((200, 3, 3)))[0]
    covariances = scales * (turns @ np.diag([4.0, 1.0, 0.1]) @ turns.transpose(0, 2, 1))
    found = expanded_of(covariances, np.ones(200, dtype=bool), degrees=degrees)
    roots = np.linalg.cholesky(covariances)[rng.integers(0, 200, DRAWS)]
    draws = np.einsum("nij,nj->ni", roots, rng.standard_normal((DRAWS, 3)))
    draws *= np.sqrt(1.0 if np.isinf(degrees) else (degrees - 2) / rng.chisquare(degrees, (DRAWS, 1)))
    assert found.space == pytest.approx(np.quantile(np.linalg.norm(draws, axis=1), LEVEL), rel=0.015)
    assert found.axes == pytest.approx(np.quantile(np.abs(draws), LEVEL, axis=0), rel=0.015)
    height = expanded_of(covariances, np.ones(200, dtype=bool), (False, False, True), degrees)
    assert height.space == pytest.approx(height.axes[2], rel=1e-9)  # a distance along one direction is a ±
    assert height.axes == pytest.approx(found.axes, rel=1e-12)


@given(
    st.lists(st.floats(1e-3, 1e3), min_size=1, max_size=6),
    st.integers(0, 20),
    st.integers(1, 3),
)
def test_over_places_of_equal_directions_u_is_where_the_mean_of_chi_square_is_95_percent(
    sizes: list[float], still: int, directions: int
) -> None:
    """Three moments are all of a chi-square; where nothing varies it lies within any U."""
    variances = np.r_[sizes, np.zeros(still)]

    def beyond(reached: float) -> float:
        within = chdtr(directions, reached**2 / np.array(sizes))
        return float((within.sum() + still) / len(variances)) - LEVEL

    found = reach(np.tile(variances[:, None], directions))
    if still >= LEVEL * len(variances):
        assert found == 0.0
    else:
        assert found == pytest.approx(brentq(beyond, 0.0, 1e3, xtol=1e-12), rel=1e-8)


def test_the_worst_place_is_the_one_of_the_largest_u_and_a_factor_is_u_over_rms() -> None:
    """Of nearly equal traces: all in one direction goes to 1.96 of its root, a third in each to 1.61."""
    places = [np.eye(3) / 3] * 9 + [np.diag([0.99, 0.0, 0.0])] + [0.01 * np.eye(3)] * 40
    found = expanded_of(np.array(places), np.ones(len(places), dtype=bool))
    assert found.worst == pytest.approx(np.sqrt(0.99 * chdtri(1, 0.05)), rel=1e-9)
    assert found.factor(0.5 * found.space) == pytest.approx(2.0)
    assert found.factor(0.0) == 1.96
