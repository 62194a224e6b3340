"""The belief against 80 digits, NIST's data, and what it promises: any order, frozen, never a silent fault."""

from __future__ import annotations

import dataclasses
import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import chi2

from axiscal.estimation.belief import Belief, Innovations
from axiscal.exceptions import CovarianceError, ShapeError
from axiscal.numerics import Array
from axiscal.numerics.cubic import NaturalSpline, even_knots
from tests.certify import least_squares, models
from tests.certify.belief import CASES, LIMITS, exact, judged

mpmath = pytest.importorskip("mpmath")  # untyped: Any
GOLDEN = Path(__file__).resolve().parents[1] / "golden"


@pytest.mark.long
@pytest.mark.parametrize(("case", "limit"), list(zip(CASES, LIMITS, strict=True)))
def test_five_thousand_updates_keep_their_digits(case: tuple[float, float], limit: float) -> None:
    """A million: `python -m tests.certify.belief`."""
    verdict = judged(*case, updates=5000)
    assert verdict.error < min(limit, 1e-9)
    assert verdict.mean < 1e-3
    assert verdict.bad == 0


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


def test_any_order_gives_the_same_posterior() -> None:
    belief, rows, values, variances = _campaign(1000, 4)
    reference = belief.update(rows, values, variances)
    rng = np.random.default_rng(5)
    for _ in range(20):
        order = rng.permutation(1000)
        shuffled = belief.update(rows[order], values[order], variances[order])
        assert _apart(shuffled, reference, rows[:50]) < 1e-10


def test_one_by_one_in_pieces_and_at_once_are_equal() -> None:
    belief, rows, values, variances = _campaign(60, 6)
    whole = belief.update(rows, values, variances)
    pieces = belief
    for part in (slice(0, 1), slice(1, 20), slice(20, 20), slice(20, 60)):
        pieces = pieces.update(rows[part], values[part], variances[part])
    assert _apart(pieces, whole, rows) < 1e-10


def test_sequential_is_the_batch_formula() -> None:
    """B&H eq. 31-33: one gain for the vector of all readings."""
    belief, rows, values, variances = _campaign(30, 7)
    c = belief.covariance
    gain = np.linalg.solve(rows @ c @ rows.T + np.diag(variances), rows @ c).T
    found = belief.update(rows, values, variances)
    assert np.abs(found.mean - gain @ values).max() < 1e-10 * np.abs(found.mean).max()
    assert np.abs(found.covariance - (c - gain @ rows @ c)).max() < 1e-10 * np.abs(found.covariance).max()


@pytest.mark.long
@pytest.mark.parametrize("decades", range(0, 13, 2))
@pytest.mark.parametrize("size", [3, 30])
def test_random_models_agree_with_eighty_digits(size: int, decades: int) -> None:
    """Rows whose directions differ in information by that many decades; flat enough a prior to feel all of them."""
    rng = np.random.default_rng(size + decades)
    left, right = (np.linalg.qr(rng.standard_normal((n, size)))[0] for n in (2 * size, size))
    rows = left * 10 ** (-np.linspace(0, decades / 2, size)) @ right.T
    prior, variance = 10 ** rng.uniform(-1, 1, size), 10.0 ** -(decades + 2)
    values = rows @ rng.standard_normal(size) + np.sqrt(variance) * rng.standard_normal(2 * size)
    probes = np.vstack([rows[:size], right.T, np.eye(size)])
    mean, std = exact(prior, rows, values, np.ones(2 * size, dtype=int), variance, probes)
    found = Belief(np.zeros(size), np.diag(prior)).update(rows, values, variance).predict(probes)
    assert np.max(np.abs(found.std / std - 1)) < 1e-8
    assert np.max(np.abs(found.mean - mean) / np.maximum(np.abs(mean), std)) < 1e-8


def test_what_nobody_read_keeps_its_prior() -> None:
    """Never a small standard deviation for a direction that was not observed."""
    belief, unseen = Belief(np.zeros(2), np.eye(2) * 1e-2**2), np.array([1.0, -1.0])
    after = belief
    for _ in range(5):
        after = after.update(np.ones((2000, 2)), np.zeros(2000), 1e-14)
    assert after.predict(unseen).std[0] == pytest.approx(np.sqrt(2) * 1e-2, rel=1e-7)


def _reference(name: str) -> Any:
    return json.loads((GOLDEN / name).read_text())


@pytest.mark.parametrize("flat", [1e8, 1e10])
@pytest.mark.parametrize("step", [1, -1])
def test_nist_norris_with_a_flat_prior(flat: float, step: int) -> None:
    data = _reference("nist_norris.json")
    x, y = np.array(data["x"])[::step], np.array(data["y"])[::step]
    found = Belief(np.zeros(2), flat**2 * np.eye(2)).update(np.stack([np.ones_like(x), x], axis=1), y, 1.0)
    residual = y - np.stack([np.ones_like(x), x], axis=1) @ found.mean
    s = np.sqrt(residual @ residual / (len(x) - 2))
    assert found.mean == pytest.approx(data["certified_c"], rel=1e-9)
    assert s * np.sqrt(np.diagonal(found.covariance)) == pytest.approx(data["certified_sd"], rel=1e-9)
    assert residual @ residual == pytest.approx(data["residual_sum_of_squares"], rel=1e-12)
    assert found.covariance == pytest.approx(np.array(data["unit_noise_cov"]), rel=1e-8)


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


def test_predicted_variance_reduction_is_the_achieved_one() -> None:
    """ΔJ = gᵀCWCg / (σ² + gᵀCg) before the reading, tr(WC) − tr(WC') after it, at 1000 poses."""
    belief, rows, values, variances = _campaign(20, 8)
    belief = belief.update(rows, values, variances)
    _, poses, _, noise = _campaign(1000, 9)
    weight = np.kron(np.eye(2), NaturalSpline(even_knots(0.0, 1.0, 9)).gram())
    c = belief.covariance
    for row, variance in zip(poses, noise, strict=True):
        promised = row @ c @ weight @ c @ row / (variance + row @ c @ row)
        after = belief.update(row, 0.0, variance).covariance
        achieved = np.trace(weight @ c) - np.trace(weight @ after)
        assert achieved > 0
        assert abs(achieved - promised) < 1e-10 * np.trace(weight @ c)


def surprises(belief: Belief, rows: Array, values: Array, variances: Array) -> Innovations:
    """Return the innovations of readings, each at its turn."""
    return belief.update_many(rows, values, variances, variances, np.arange(len(rows))).innovations


def test_innovations_tell_a_bad_reading_from_a_good_one() -> None:
    belief, rows, values, variances = _campaign(40, 10)
    good = surprises(belief, rows, values, variances)
    assert 1e-3 < chi2.sf(np.sum((good.value / good.std) ** 2), 40) < 1 - 1e-3
    values[17] += 20e-6
    bad = surprises(belief, rows, values, variances)
    assert abs(bad.value[17] / bad.std[17]) > 6
    assert chi2.sf(np.sum((bad.value / bad.std) ** 2), 40) < 1e-6
    assert bad.value[:17] == pytest.approx(good.value[:17], rel=1e-12)


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


def test_a_belief_keeps_no_hold_on_what_it_was_made_from() -> None:
    mean, covariance = np.zeros(2), np.eye(2)
    belief = Belief(mean, covariance)
    mean[0], covariance[0, 0] = 7.0, 7.0
    assert belief.mean[0] == 0.0
    assert belief.covariance[0, 0] == 1.0
    mean[1] = 8.0  # the caller's own arrays stay writeable


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
