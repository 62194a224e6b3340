"""The normal: roots of any scale and rank, and readings all at once against one by one."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal_core.eigen import root_of
from axiscal_core.from_scipy import triangle_over
from axiscal_core.normal import Normal, condition


@pytest.mark.parametrize(("size", "rank"), [(1, 1), (5, 5), (40, 40), (40, 39), (40, 7), (40, 1)])
@pytest.mark.parametrize("decades", [0.0, 8.0])
def test_a_root_multiplies_to_the_covariance(size: int, rank: int, decades: float) -> None:
    rng = np.random.default_rng(size + rank)
    half = rng.standard_normal((size, rank)) * 10 ** rng.uniform(-decades, 0, size)[:, None]
    matrix, scale = half @ half.T, np.linalg.norm(half, axis=1)
    root = root_of(matrix)
    assert np.abs((root @ root.T - matrix) / scale[:, None] / scale).max() < 1e-12
    assert rank < size or np.array_equal(root, np.triu(root))


def test_variances_down_to_the_smallest_numbers() -> None:
    matrix = np.diag([1e-320, 1e-300, 1e-150, 1.0, 1e150, 1e300])
    root = root_of(matrix)
    assert np.array_equal(root, np.diag(np.diagonal(root)))
    assert np.diagonal(root) ** 2 == pytest.approx(np.diagonal(matrix), rel=1e-3, abs=0.0)


@pytest.mark.parametrize(("size", "count"), [(5, 3), (40, 90), (90, 40), (4, 0)])
def test_a_triangle_over_rows_is_a_root_of_both(size: int, count: int) -> None:
    rng = np.random.default_rng(size)
    own, below = rng.uniform(0.0, 2.0, size), rng.standard_normal((count, size))
    own[-1] = 0.0
    found = triangle_over(own, below)
    assert np.array_equal(found, np.triu(found))
    assert found.T @ found == pytest.approx(np.diag(own**2) + below.T @ below, rel=1e-12, abs=1e-12)


@given(st.integers(0, 10_000), st.floats(-3.0, 8.0), st.integers(0, 3))
def test_readings_at_once_are_those_one_after_another(seed: int, decades: float, fixed: int) -> None:
    """With priors that are very wide, variables that are known exactly, and readings that do not count."""
    rng = np.random.default_rng(seed)
    size, count = 5, int(rng.integers(1, 12))
    root = rng.standard_normal((size, size)) * 10.0 ** (decades / 2 * rng.random(size))[:, None]
    root[:fixed] = 0.0
    twin, rows = Normal.of_factor(rng.standard_normal(size), root), rng.standard_normal((count, size))
    values, noise = rng.standard_normal(count), rng.uniform(0.5, 2.0, count)
    used = np.where(rng.random(count) < 0.3, np.inf, noise)
    counts = np.isfinite(used)
    found = condition(twin.factor, twin.mean, rows, values, used, np.cumsum(counts) - counts)
    whole = twin.covariance
    for i, row in enumerate(rows):
        expected = twin.through(row[None])
        wide = float(np.hypot(expected.std[0], np.sqrt(noise[i])))
        assert found.variance[i] + noise[i] == pytest.approx(wide**2, rel=1e-6)
        assert found.expected[i] == pytest.approx(expected.mean[0], rel=1e-6, abs=1e-6 * wide)
        twin = twin.read(row[None], values[[i]], noise[[i]]) if counts[i] else twin
    spread = np.maximum(twin.std, 1e-100)
    after = found.root @ found.root.T
    assert np.max(np.abs(after - twin.covariance) / np.outer(spread, spread)) < 1e-7
    assert np.max(np.abs(found.mean - twin.mean) / spread) < 1e-6
    left = whole - found.losses.T @ found.losses
    np.testing.assert_allclose(left, twin.covariance, atol=1e-9 * float(np.max(whole) + 1.0))
