"""Few points that stand for many: the same whatever the order, and spread as all are."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.numerics import even_subset
from axiscal_core.points import even_points


@given(st.integers(1, 4), st.integers(1, 60), st.integers(1, 80), st.integers(0, 2**32 - 1))
def test_the_same_points_whatever_the_order(dimensions: int, many: int, few: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.integers(0, 5, (many, dimensions)).astype(float)  # many of them alike
    order = rng.permutation(many)
    found = even_subset(points, few)
    assert len(np.unique(found)) == len(found) == min(few, many)
    np.testing.assert_array_equal(points[order][even_subset(points[order], few)], points[found])


def test_along_a_line_every_so_many_th_in_the_middle_of_its_share() -> None:
    points = np.random.default_rng(1).permutation(120.0 * np.arange(120))[:, None]
    assert (points[even_subset(points, 12), 0] / 120.0).tolist() == list(range(5, 120, 10))


@pytest.mark.parametrize("dimensions", [1, 2, 3, 5])
def test_means_over_few_are_means_over_all(dimensions: int) -> None:
    """No more than a third of what so many drawn at random would miss."""
    rng, points = np.random.default_rng(2), even_points(4000, dimensions) * 10.0 ** np.arange(dimensions)
    shares = points / 10.0 ** np.arange(dimensions)
    waves = np.cos(shares @ rng.normal(0, 2, (dimensions, 60)) + rng.uniform(0, 6, 60))
    missed = waves[even_subset(points, 400)].mean(axis=0) - waves.mean(axis=0)
    drawn = waves.std(axis=0) / np.sqrt(400)
    assert np.sqrt(np.mean(missed**2)) < {1: 0.02, 2: 0.15, 3: 0.35, 5: 0.7}[dimensions] * np.sqrt(np.mean(drawn**2))
