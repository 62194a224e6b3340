"""The belief against NIST's data, and what it promises: any order, frozen, never a silent fault."""

from __future__ import annotations

import dataclasses
import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from axiscal.estimation.belief import Belief
from axiscal.exceptions import CovarianceError, ShapeError
from axiscal.numerics import Array
from tests.generators.known import told


def test_a_belief_is_frozen() -> None:
    mean = np.array([1.0, -2.0])
    belief = Belief(mean, np.eye(2))
    after = told(belief, np.ones((3, 2)), np.arange(3.0), 0.1)
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
        belief = told(belief, np.tile(np.eye(3), (100, 1)), np.zeros(300), 1e-306)
    assert np.all(np.diagonal(belief.covariance) < np.finfo(np.float64).tiny)
    std = np.linalg.norm(belief.factor, axis=1)
    assert std == pytest.approx(np.full(3, np.sqrt(1e-306 / 2000)), rel=1e-3, abs=0.0)


@pytest.mark.parametrize(
    ("rows", "value", "variance"),
    [([1.0, 1.0], np.nan, 1.0), ([np.inf, 0.0], 1.0, 1.0), ([1e200, 1.0], 1.0, 1.0), ([1.0, 1.0], 1.0, -1.0)],
)
def test_bad_readings_end_in_a_failure_of_ours(rows: list[float], value: float, variance: float) -> None:
    belief = Belief(np.zeros(2), np.eye(2))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ShapeError):
            told(belief, np.array([rows]), np.array([value]), variance)


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
    for variances in ([-1.0], [np.nan], 1.0, [[1.0]]):
        with pytest.raises(ShapeError):
            belief.extended(variances)


DIGITS = {"longley": 10.0, "wampler1": 9.0, "wampler2": 11.0, "filip": 7.0}
"""Correct digits asked for. NumPy's QR of the readings alone has 10.9, 9.3, 12.6 and about 7."""
FLAT = 1e13
"""Prior standard deviation of what a column adds to the readings, in norms of the readings: any value from 1e12 to
1e16 would do; below, the prior pulls Filip's coefficients, of which the smallest direction is 1e-10 of the largest."""
_DATA = Path(__file__).resolve().parents[1] / "golden" / "nist_strd.json"


def digits(name: str) -> tuple[float, float]:
    """Return the correct digits of coefficients and of their standard deviations (infinite: none certified).

    Their score: log relative error, LRE = -log10 max |found / certified - 1|.
    """
    data: dict[str, Any] = json.loads(_DATA.read_text())[name]
    certified, read = np.array(data["certified"], dtype=float), np.array(data["y"], dtype=float)
    rows = _rows(data, len(certified))
    prior = np.diag((FLAT * np.linalg.norm(read) / np.linalg.norm(rows, axis=0)) ** 2)
    ones, order = np.ones(len(read)), np.arange(len(read), dtype=np.intp)
    found = Belief(np.zeros(len(certified)), prior).update_many(rows, read, ones, ones, order).belief
    residual = read - rows @ found.mean
    scale = float(np.sqrt(residual @ residual / (len(read) - len(certified))))
    if "certified_sd" not in data:
        return _correct(found.mean, certified), np.inf
    return _correct(found.mean, certified), _correct(
        scale * np.sqrt(np.diagonal(found.covariance)), np.array(data["certified_sd"])
    )


def _rows(data: dict[str, Any], size: int) -> Array:
    """Return the columns that are stated, or the powers of x."""
    if "columns" in data:
        return np.array(data["columns"], dtype=float).T
    return np.array(data["x"], dtype=float)[:, None] ** np.arange(size)


def _correct(found: Array, certified: Array) -> float:
    return float(-np.log10(max(float(np.max(np.abs(found / certified - 1))), 1e-15)))


@pytest.mark.parametrize("name", DIGITS)
def test_a_reference_regression_keeps_the_digits_asked_for(name: str) -> None:
    coefficients, deviations = digits(name)
    assert coefficients >= DIGITS[name]
    assert deviations >= DIGITS[name]
