"""The factorised normal: singular and badly scaled covariances, and the update against the textbook formula."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.exceptions import CovarianceError
from axiscal.numerics import Array, gaussian
from axiscal.numerics.from_scipy import triangle_over


def covariance(size: int, rank: int, decades: float, seed: int) -> Array:
    """Return a random covariance of a rank, standard deviations spread over decades."""
    rng = np.random.default_rng(seed)
    root = rng.standard_normal((size, rank)) * 10 ** rng.uniform(-decades, 0, size)[:, None]
    return root @ root.T


def product(factors: gaussian.Factors) -> Array:
    return factors.upper @ np.diag(factors.diagonal) @ factors.upper.T


@pytest.mark.parametrize(("size", "rank"), [(1, 1), (5, 5), (40, 40), (40, 39), (40, 7), (40, 1)])
@pytest.mark.parametrize("decades", [0.0, 8.0])
def test_factors_multiply_to_the_covariance(size: int, rank: int, decades: float) -> None:
    matrix = covariance(size, rank, decades, size + rank)
    factors = gaussian.factorise(matrix)
    scale = np.sqrt(np.diagonal(matrix))
    assert np.abs((product(factors) - matrix) / scale[:, None] / scale).max() < 1e-12
    assert np.array_equal(factors.upper, np.triu(factors.upper))
    assert np.array_equal(np.diagonal(factors.upper), np.ones(size))
    assert np.all(factors.diagonal >= 0)
    if rank < size // 2:
        assert np.count_nonzero(factors.diagonal) == rank  # no pivot is lifted where there is no variance


def test_variables_that_are_known_exactly_stay_so() -> None:
    matrix = np.zeros((4, 4))
    matrix[np.ix_([0, 2], [0, 2])] = covariance(2, 2, 0.0, 1)
    factors = gaussian.factorise(matrix)
    assert np.abs(product(factors) - matrix).max() < 1e-15
    after = gaussian.condition(factors, np.zeros(4), np.ones((1, 4)), np.ones(1), np.array([1e-3]))
    assert np.array_equal(after.mean[[1, 3]], np.zeros(2))


def test_no_variables_at_all() -> None:
    assert gaussian.factorise(np.zeros((0, 0))).diagonal.shape == (0,)
    assert np.array_equal(product(gaussian.factorise(np.zeros((3, 3)))), np.zeros((3, 3)))


def test_variances_down_to_the_smallest_numbers() -> None:
    matrix = np.diag([1e-320, 1e-300, 1e-150, 1.0, 1e150, 1e300])
    factors = gaussian.factorise(matrix)
    assert factors.diagonal == pytest.approx(np.diagonal(matrix), rel=1e-3)
    assert np.array_equal(factors.upper, np.eye(6))


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
        gaussian.factorise(matrix)


@pytest.mark.parametrize("size", [1, 2, 7, 63, 130])
def test_an_update_is_the_textbook_formula(size: int) -> None:
    """B&H eq. 21-23 with the full covariance."""
    rng = np.random.default_rng(size)
    matrix, mean, row = covariance(size, size, 1.0, size), rng.standard_normal(size), rng.standard_normal(size)
    value, variance = 0.7, 0.3
    found = gaussian.condition(gaussian.factorise(matrix), mean, row[None], np.array([value]), np.array([variance]))
    expected = row @ matrix @ row + variance
    gain = matrix @ row / expected
    assert found.innovation == pytest.approx([value - row @ mean])
    assert found.variance == pytest.approx([expected])
    assert np.abs(found.mean - (mean + gain * (value - row @ mean))).max() < 1e-12 * np.abs(found.mean).max()
    assert np.abs(product(found.factors) - (matrix - np.outer(gain, row @ matrix))).max() < 1e-12 * matrix.max()


def test_readings_one_after_another_are_those_at_once() -> None:
    """Two ways to the same posterior; the expectation of each is what was known before it."""
    rng = np.random.default_rng(5)
    factors, mean, rows = gaussian.factorise(covariance(9, 9, 1.0, 5)), rng.standard_normal(9), rng.normal(size=(6, 9))
    values, noise = rng.standard_normal(6), rng.uniform(0.1, 2.0, 6)
    found = gaussian.condition(factors, mean, rows, values, noise)
    at_once = gaussian.condition_at_once(factors, mean, rows, values, noise, np.arange(6))
    assert product(found.factors) == pytest.approx(product(at_once.factors), rel=1e-9, abs=1e-12)
    assert found.mean == pytest.approx(at_once.mean, rel=1e-9)
    assert found.innovation == pytest.approx(values - at_once.expected, rel=1e-9)
    assert found.variance == pytest.approx(at_once.variance + noise, rel=1e-9)


def _of_parts(rng: np.random.Generator) -> tuple[gaussian.Factors, Array, Array]:
    """Return factors of three groups of variables and of one that nothing sees, means, and rows that see a group."""
    matrix, rows, group = np.zeros((13, 13)), np.zeros((20, 13)), rng.permutation(13)
    groups = group[:5], group[5:9], group[9:12]
    for own in (*groups, group[12:]):
        matrix[np.ix_(own, own)] = covariance(len(own), len(own), 1.0, len(own))
    for index, row in enumerate(rows):
        own = groups[index % 7 % 3]
        row[own[index % 2 :]] = rng.standard_normal(len(own) - index % 2)
    rows[4] = 0.0
    return gaussian.factorise(matrix), rng.standard_normal(13), rows


@pytest.mark.parametrize("seed", range(4))
def test_parts_that_have_nothing_in_common_are_those_one_after_another(seed: int) -> None:
    """Readings of three parts mixed, one that sees nothing, and two that do not count."""
    rng = np.random.default_rng(seed)
    factors, mean, rows = _of_parts(rng)
    values, noise = rng.standard_normal(20), rng.uniform(0.1, 2.0, 20)
    used = noise.copy()
    used[[3, 11]] = np.inf
    counts = np.isfinite(used)
    before = np.cumsum(counts) - counts
    found = gaussian.condition_at_once(factors, mean, rows, values, used, before)
    whole = product(factors)
    for i, row in enumerate(rows):
        assert found.expected[i] == pytest.approx(row @ mean, rel=1e-9, abs=1e-12)
        assert found.variance[i] == pytest.approx(row @ whole @ row, rel=1e-9, abs=1e-12)
        if counts[i]:
            done = gaussian.condition(factors, mean, row[None], values[i : i + 1], noise[i : i + 1])
            after = product(done.factors)
            assert np.outer(found.losses[i], found.losses[i]) == pytest.approx(whole - after, rel=1e-8, abs=1e-11)
            factors, mean, whole = done.factors, done.mean, after
    assert product(found.factors) == pytest.approx(whole, rel=1e-9, abs=1e-12)
    assert np.array_equal(found.factors.upper, np.triu(found.factors.upper))
    assert found.mean == pytest.approx(mean, rel=1e-9)


def test_a_part_of_which_no_reading_counts_stays_as_it_was() -> None:
    rows = np.array([[1.0, 0.5, 0.0], [0.0, 0.0, 2.0]])
    factors, noise = gaussian.factorise(np.diag([1.0, 2.0, 3.0])), np.array([1.0, np.inf])
    found = gaussian.condition_at_once(factors, np.zeros(3), rows, np.ones(2), noise, np.array([0, 1]))
    assert product(found.factors)[2, 2] == pytest.approx(3.0)
    assert found.mean[2] == 0.0
    assert found.variance == pytest.approx([1.5, 12.0])
    assert not found.losses[1].any()


@pytest.mark.parametrize(("size", "count"), [(5, 3), (40, 90), (90, 40), (4, 0)])
def test_a_triangle_over_rows_is_a_root_of_both(size: int, count: int) -> None:
    rng = np.random.default_rng(size)
    own, below = rng.uniform(0.0, 2.0, size), rng.standard_normal((count, size))
    own[-1] = 0.0
    found = triangle_over(own, below)
    assert np.array_equal(found, np.triu(found))
    assert found.T @ found == pytest.approx(np.diag(own**2) + below.T @ below, rel=1e-12, abs=1e-12)


def test_an_update_leaves_its_input_alone() -> None:
    factors, mean = gaussian.factorise(covariance(5, 5, 0.0, 2)), np.ones(5)
    copies = factors.upper.copy(), factors.diagonal.copy()
    gaussian.condition(factors, mean, np.arange(5.0)[None], np.ones(1), np.array([0.1]))
    assert np.array_equal(factors.upper, copies[0])
    assert np.array_equal(factors.diagonal, copies[1])
    assert np.array_equal(mean, np.ones(5))


def test_variances_agree_with_the_root_and_are_never_negative() -> None:
    matrix = covariance(30, 4, 6.0, 5)
    factors = gaussian.factorise(matrix)
    rows = np.vstack([np.random.default_rng(1).standard_normal((20, 30)), np.linalg.svd(matrix)[2][-10:]])
    found = gaussian.variances(factors, rows)
    root = gaussian.root(factors)
    assert np.all(found >= 0)
    assert found == pytest.approx(np.sum((rows @ root) ** 2, axis=1))


def test_new_variables_are_independent_of_the_old() -> None:
    matrix = covariance(3, 3, 0.0, 8)
    wider = product(gaussian.extend(gaussian.factorise(matrix), np.array([2.0, 0.0])))
    expected = np.zeros((5, 5))
    expected[:3, :3], expected[3, 3] = matrix, 2.0
    assert np.abs(wider - expected).max() < 1e-14
