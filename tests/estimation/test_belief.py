"""The belief against 80 digits, NIST's data, and what it promises: any order, frozen, never a silent fault."""

from __future__ import annotations

import dataclasses
import warnings
from typing import Any

import numpy as np
import pytest

from axiscal.estimation.belief import Belief
from axiscal.exceptions import CovarianceError, ShapeError
from axiscal.numerics import Array
from tests.certify import least_squares, models


def test_a_belief_is_frozen() -> None:
    mean = np.array([1.0, -2.0])
    belief = Belief(mean, np.eye(2))
    after = belief.update(np.ones((3, 2)), np.arange(3.0), 0.1)
    assert np.array_equal(belief.mean, mean)
    assert np.array_equal(belief.covariance, np.eye(2))
    for one in (belief, after, after.extended([1.0])):
        with pytest.raises(dataclasses.FrozenInstanceError):
            one.mean = mean  # type: ignore[misc]
        for array in (one.mean, one.factor):
            with pytest.raises(ValueError, match="read-only"):
                array[0] = 1.0


def test_equal_readings_without_end_leave_no_variance_that_is_not_positive() -> None:
    """Variances so small that they are denormal numbers."""
    belief = Belief(np.zeros(3), 1e-303 * np.eye(3))
    for _ in range(20):
        belief = belief.update(np.tile(np.eye(3), (100, 1)), np.zeros(300), 1e-306)
    assert np.all(np.diagonal(belief.covariance) < np.finfo(np.float64).tiny)
    assert belief.predict(np.eye(3)).std == pytest.approx(np.full(3, np.sqrt(1e-306 / 2000)), rel=1e-3, abs=0.0)


FAULTS: list[tuple[Any, Any, Any]] = [
    (np.ones((2, 3)), np.ones(2), 1.0),
    (np.ones((2, 2)), np.ones(3), 1.0),
    (np.ones((1, 2, 2)), np.ones(1), 1.0),
    (np.ones(2), [[1.0, 2.0]], 1.0),
    (np.ones(2), 1.0, 0.0),
    (np.ones(2), 1.0, -1.0),
    (np.ones(2), 1.0, np.nan),
    (np.ones(2), 1.0, np.inf),
    (np.ones(2), np.nan, 1.0),
    ([np.inf, 0.0], 1.0, 1.0),
    (np.ones((2, 2)), np.ones(2), [1.0, 1.0, 1.0]),
    ([1e200, 1.0], 1.0, 1.0),
]


@pytest.mark.parametrize(("rows", "values", "variances"), FAULTS)
def test_bad_readings_end_in_a_failure_of_ours(rows: Any, values: Any, variances: Any) -> None:
    belief = Belief(np.zeros(2), np.eye(2))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ShapeError):
            belief.update(rows, values, variances)


@pytest.mark.parametrize(
    ("mean", "covariance"),
    [(np.zeros(3), np.eye(2)), ([0.0, np.nan], np.eye(2)), (0.0, np.eye(1)), (np.zeros((2, 1)), np.eye(2))],
)
def test_bad_means_end_in_a_failure_of_ours(mean: Any, covariance: Array) -> None:
    with pytest.raises(ShapeError):
        Belief(mean, covariance)


def test_other_bad_input_ends_in_a_failure_of_ours() -> None:
    belief = Belief(np.zeros(2), np.eye(2))
    with pytest.raises(CovarianceError):
        Belief(np.zeros(2), -np.eye(2))
    for rows in (np.ones(3), np.full(2, np.nan), np.ones((1, 1, 2))):
        with pytest.raises(ShapeError):
            belief.predict(rows)
    for variances in ([-1.0], [np.nan], 1.0, [[1.0]]):
        with pytest.raises(ShapeError):
            belief.extended(variances)


@pytest.mark.parametrize("name", least_squares.DIGITS)
def test_a_reference_regression_keeps_the_digits_asked_for(name: str) -> None:
    coefficients, deviations = least_squares.digits(name)
    assert coefficients >= least_squares.DIGITS[name]
    assert deviations >= least_squares.DIGITS[name]


@pytest.mark.parametrize("seed", range(3))
def test_a_random_model_agrees_with_ball_arithmetic(seed: int) -> None:
    """500 of them: `make certify PART=models`."""
    pytest.importorskip("flint")
    assert models.error(models.random_model(np.random.default_rng(seed))) < models.LIMIT
