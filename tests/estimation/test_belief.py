"""The belief against 80 digits, NIST's data, and what it promises: any order, frozen, never a silent fault."""

from __future__ import annotations

import dataclasses
import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from axiscal.estimation.belief import Belief, Innovations
from axiscal.exceptions import CovarianceError, ShapeError
from axiscal.numerics import Array
from axiscal_core.splines import NaturalSpline, even_knots
from tests.certify import least_squares, models
from tests.certify.belief import CASES, judged

GOLDEN = Path(__file__).resolve().parents[1] / "golden"


@pytest.mark.long
@pytest.mark.parametrize("updates", [1, 63, 64, 1000])
def test_the_reference_is_reached_from_the_first_reading_on(updates: int) -> None:
    verdict = judged(*CASES[1], updates=updates, seed=updates)
    assert verdict.error < 1e-12
    assert verdict.mean < 1e-9


def _smooth_prior(positions: Array) -> Array:
    distance = np.abs(positions[:, None] - positions) / 0.3
    return 4e-12 * (1 + distance + distance**2 / 3) * np.exp(-distance)


def _campaign(readings: int, seed: int) -> tuple[Belief, Array, Array, Array]:
    """Return a smooth prior of two stacked splines, and readings of their sum."""
    rng = np.random.default_rng(seed)
    spline = NaturalSpline(even_knots(0.0, 1.0, 9))
    covariance = np.kron(np.eye(2), _smooth_prior(spline.knots))
    belief = Belief(np.zeros(18), covariance)
    rows = np.hstack([spline.rows(rng.random(readings)), spline.rows(rng.random(readings))])
    variances = (0.3e-6 * rng.uniform(0.5, 2.0, readings)) ** 2
    values = rows @ belief.sample(rng, 1)[0] + np.sqrt(variances) * rng.standard_normal(readings)
    return belief, rows, values, variances


def _apart(first: Belief, second: Belief, probes: Array) -> float:
    """Return the largest relative difference of coefficients and predicted sums, in standard deviations."""
    rows = np.vstack([np.eye(first.size), probes])
    a, b = first.predict(rows), second.predict(rows)
    return float(max(np.max(np.abs(a.std / b.std - 1)), np.max(np.abs(a.mean - b.mean) / b.std)))


def _reference(name: str) -> Any:
    return json.loads((GOLDEN / name).read_text())


def test_gum_thermometer_calibration() -> None:
    """JCGM 100 H.3, to the digits that are printed there."""
    data = _reference("gum_h3.json")
    rows = np.stack([np.ones(11), np.array(data["t_degC"]) - 20.0], axis=1)
    y = np.array(data["b_degC"])
    found = Belief(np.zeros(2), 1e12 * np.eye(2)).update(rows, y, 1.0)
    residual = y - rows @ found.mean
    s = np.sqrt(residual @ residual / 9)
    u = s * np.sqrt(np.diagonal(found.covariance))
    at_30 = found.predict(np.array([1.0, 10.0]))
    assert found.mean == pytest.approx([data["y1"], data["y2"]], abs=6e-5)
    assert u == pytest.approx([data["u_y1"], data["u_y2"]], abs=6e-5)
    assert s == pytest.approx(data["s"], abs=6e-5)
    assert s**2 * found.covariance[0, 1] / u[0] / u[1] == pytest.approx(data["correlation"], abs=6e-3)
    assert at_30.mean[0] == pytest.approx(data["b30"], abs=6e-5)
    assert s * at_30.std[0] == pytest.approx(data["u_b30"], abs=6e-5)


def surprises(belief: Belief, rows: Array, values: Array, variances: Array) -> Innovations:
    """Return the innovations of readings, each at its turn."""
    return belief.update_many(rows, values, variances, variances, np.arange(len(rows))).innovations


def test_innovations_are_readings_minus_predictions() -> None:
    belief, rows, values, variances = _campaign(3, 11)
    first = belief.update(rows[:2], values[:2], variances[:2])
    before, found = first.predict(rows[2]), surprises(first, rows[2:], values[2:], variances[2:])
    assert found.value == pytest.approx(values[2] - before.mean)
    assert found.std == pytest.approx(np.sqrt(before.std**2 + variances[2]))
    assert found.degrees == 1
    assert found.chi_square == pytest.approx(float(found.value[0] / found.std[0]) ** 2)


def test_a_belief_is_frozen() -> None:
    belief, rows, values, variances = _campaign(3, 12)
    mean, covariance = belief.mean.copy(), belief.covariance
    after = belief.update(rows, values, variances)
    assert np.array_equal(belief.mean, mean)
    assert np.array_equal(belief.covariance, covariance)
    for one in (belief, after, after.extended([1.0])):
        with pytest.raises(dataclasses.FrozenInstanceError):
            one.mean = mean  # type: ignore[misc]
        for array in (one.mean, one.factor):
            with pytest.raises(ValueError, match="read-only"):
                array[0] = 1.0


def test_extended_and_updated_belief_equals_one_with_all_variables() -> None:
    belief, rows, values, variances = _campaign(10, 13)
    wide = np.hstack([rows, np.eye(10)[:, :2]])
    covariance = np.zeros((20, 20))
    covariance[:18, :18] = belief.covariance
    covariance[[18, 19], [18, 19]] = 1e-12, 4e-12
    grown = belief.extended([1e-12, 4e-12]).update(wide, values, variances)
    direct = Belief(np.zeros(20), covariance).update(wide, values, variances)
    assert _apart(grown, direct, wide) < 1e-10


def test_equal_readings_without_end_leave_no_variance_that_is_not_positive() -> None:
    """Variances so small that they are denormal numbers."""
    belief = Belief(np.zeros(3), 1e-303 * np.eye(3))
    for _ in range(20):
        belief = belief.update(np.tile(np.eye(3), (100, 1)), np.zeros(300), 1e-306)
    assert np.all(np.diagonal(belief.covariance) < np.finfo(np.float64).tiny)
    assert belief.predict(np.eye(3)).std == pytest.approx(np.full(3, np.sqrt(1e-306 / 2000)), rel=1e-3)


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
