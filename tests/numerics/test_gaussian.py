"""Roots of the normal: singular and badly scaled covariances, and the update against the textbook formula."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.exceptions import CovarianceError
from axiscal.numerics import Array, gaussian
from axiscal_core.from_scipy import triangle_over


def covariance(size: int, rank: int, decades: float, seed: int) -> Array:
    """Return a random covariance of a rank, standard deviations spread over decades."""
    rng = np.random.default_rng(seed)
    root = rng.standard_normal((size, rank)) * 10 ** rng.uniform(-decades, 0, size)[:, None]
    return root @ root.T


def product(root: Array) -> Array:
    return root @ root.T


def one_by_one(root: Array, mean: Array, rows: Array, values: Array, noise: Array) -> tuple[Array, Array]:
    """Return root and mean after readings that are taken one after another."""
    for i in range(len(rows)):
        one = slice(i, i + 1)
        root, mean, *_ = gaussian.condition(root, mean, rows[one], values[one], noise[one], np.zeros(1, dtype=int))
    return root, mean


@pytest.mark.parametrize(("size", "rank"), [(1, 1), (5, 5), (40, 40), (40, 39), (40, 7), (40, 1)])
@pytest.mark.parametrize("decades", [0.0, 8.0])
def test_a_root_multiplies_to_the_covariance(size: int, rank: int, decades: float) -> None:
    matrix = covariance(size, rank, decades, size + rank)
    root = gaussian.root_of(matrix)
    scale = np.sqrt(np.diagonal(matrix))
    assert np.abs((product(root) - matrix) / scale[:, None] / scale).max() < 1e-12
    assert rank < size or np.array_equal(root, np.triu(root))


def test_variances_down_to_the_smallest_numbers() -> None:
    matrix = np.diag([1e-320, 1e-300, 1e-150, 1.0, 1e150, 1e300])
    root = gaussian.root_of(matrix)
    assert np.array_equal(root, np.diag(np.diagonal(root)))
    assert np.diagonal(root) ** 2 == pytest.approx(np.diagonal(matrix), rel=1e-3, abs=0.0)


@pytest.mark.parametrize(
    ("matrix", "said"),
    [
        (np.eye(3)[:2], "square"),
        (np.zeros(3), "square"),
        (np.diag([1.0, np.nan]), "finite"),
        (np.diag([1.0, np.inf]), "finite"),
        (np.diag([1.0, -1e-12]), "variance 1"),
        (np.array([[1.0, 0.5], [0.4, 1.0]]), "symmetric"),
        (np.array([[1.0, 1.1], [1.1, 1.0]]), "eigenvalue"),
        (np.array([[1e-12, 1.01e-12], [1.01e-12, 1e-12]]), "eigenvalue"),
        (np.array([[0.0, 1e-9], [1e-9, 1.0]]), "variance of zero"),
    ],
)
def test_what_is_no_covariance_is_refused(matrix: Array, said: str) -> None:
    with pytest.raises(CovarianceError, match=said):
        gaussian.root_of(matrix)


def _of_parts(rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Return the root of three groups of variables and of one that nothing sees, means, and rows that see a group."""
    matrix, rows, group = np.zeros((13, 13)), np.zeros((20, 13)), rng.permutation(13)
    groups = group[:5], group[5:9], group[9:12]
    for own in (*groups, group[12:]):
        matrix[np.ix_(own, own)] = covariance(len(own), len(own), 1.0, len(own))
    for index, row in enumerate(rows):
        own = groups[index % 7 % 3]
        row[own[index % 2 :]] = rng.standard_normal(len(own) - index % 2)
    rows[4] = 0.0
    return gaussian.root_of(matrix), rng.standard_normal(13), rows


@pytest.mark.parametrize("seed", range(4))
def test_parts_that_have_nothing_in_common_are_those_one_after_another(seed: int) -> None:
    """Readings of three parts mixed, one that sees nothing, and two that do not count."""
    rng = np.random.default_rng(seed)
    root, mean, rows = _of_parts(rng)
    values, noise = rng.standard_normal(20), rng.uniform(0.1, 2.0, 20)
    used = noise.copy()
    used[[3, 11]] = np.inf
    counts = np.isfinite(used)
    before = np.cumsum(counts) - counts
    found = gaussian.condition(root, mean, rows, values, used, before)
    for i, row in enumerate(rows):
        assert found.expected[i] == pytest.approx(row @ mean, rel=1e-9, abs=1e-12)
        assert found.variance[i] == pytest.approx(row @ product(root) @ row, rel=1e-9, abs=1e-12)
        if counts[i]:
            after, mean = one_by_one(root, mean, row[None], values[i : i + 1], noise[i : i + 1])
            lost = np.outer(found.losses[i], found.losses[i])
            assert lost == pytest.approx(product(root) - product(after), rel=1e-8, abs=1e-11)
            root = after
    assert product(found.root) == pytest.approx(product(root), rel=1e-9, abs=1e-12)
    assert found.mean == pytest.approx(mean, rel=1e-9)


@pytest.mark.parametrize(("size", "count"), [(5, 3), (40, 90), (90, 40), (4, 0)])
def test_a_triangle_over_rows_is_a_root_of_both(size: int, count: int) -> None:
    rng = np.random.default_rng(size)
    own, below = rng.uniform(0.0, 2.0, size), rng.standard_normal((count, size))
    own[-1] = 0.0
    found = triangle_over(own, below)
    assert np.array_equal(found, np.triu(found))
    assert found.T @ found == pytest.approx(np.diag(own**2) + below.T @ below, rel=1e-12, abs=1e-12)
