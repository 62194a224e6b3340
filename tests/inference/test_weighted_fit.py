"""The weighted estimate of all readings at once against plain conditioning, and the weights of Student-t noise."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from axiscal.description.campaign import read_campaign
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.history import path
from axiscal.inference.outliers import FREEDOM, verdict
from axiscal.inference.weighted_fit import Fitted
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import seen, visited_by
from axiscal.numerics import Array
from tests.generators.campaigns import drawn, mixed


def _conditioned(problem: Case, readings: list[Reading], weights: Array) -> tuple[Array, Array]:
    """What the readings minus their estimate are, and the variance of the estimate, by the road the belief takes."""
    observation = visited_by(problem.observation, readings)
    rows, variances, values, reading = seen(observation, readings)
    noise = variances / weights[reading]
    signal = rows @ observation.prior_covariance() @ rows.T
    gain = np.linalg.solve(signal + np.diag(noise), signal).T
    return values - gain @ values, np.diag(signal - gain @ signal)


def test_left_and_spread_are_those_of_conditioning_on_all_readings() -> None:
    problem = mixed()
    readings = drawn(problem)
    weights = np.random.default_rng(1).uniform(0.1, 1.0, len(readings))
    fitted = Fitted.of(problem.observation, readings)
    fitted.weigh(weights)
    left, spread = _conditioned(problem, readings, weights)
    assert fitted.left == pytest.approx(left, abs=1e-11)
    assert fitted.spread == pytest.approx(spread, rel=1e-5)


def test_a_reading_surprises_as_the_estimate_without_it_says() -> None:
    problem = mixed()
    readings = [r for r in drawn(problem) if r.setup == "probe"]
    fitted = Fitted.of(problem.observation, readings)
    fitted.weigh(np.ones(len(readings)))
    for i in (0, 5, 11):
        alone = np.ones(len(readings))
        alone[i] = 1e-12
        left, spread = _conditioned(problem, readings, alone)
        expected = left[i] / np.sqrt(spread[i] + fitted.noise[i])
        assert fitted.surprise[i] == pytest.approx(expected, rel=1e-4)
        without = fitted.without(i)
        others = np.arange(len(readings)) != i
        assert without.left[others] == pytest.approx(left[others], abs=1e-11)
        assert without.spread[others] == pytest.approx(spread[others], rel=1e-4)


def test_the_weights_are_those_of_student_t_noise() -> None:
    problem = mixed()
    readings = drawn(problem)
    found = verdict(problem.observation, readings)
    assert not any(doubt.rejected for doubt in found.doubts)
    left, spread = _conditioned(problem, readings, np.array(found.weights))
    noise = Fitted.of(problem.observation, readings).noise
    counts = np.array([len(reading.values) for reading in readings])
    total = np.add.reduceat((left**2 + spread) / noise, np.cumsum(counts) - counts)
    expected = np.minimum((FREEDOM + counts) / (FREEDOM + total), 1.0)
    assert np.array(found.weights) == pytest.approx(expected, abs=2e-3)


def test_the_history_ends_where_the_estimate_does() -> None:
    """Two bad readings amid the others are known from the first one on."""
    case = mixed()
    readings = drawn(case)
    readings[4] = replace(readings[4], value=readings[4].value + 90e-6)
    readings[6] = replace(readings[6], value=readings[6].value + 0.1)
    known = concluded(case, readings)
    assert {doubt.reading for doubt in known.outliers if doubt.rejected} == {4, 6}
    moments = path(known)
    assert moments[5].accuracy.rms == pytest.approx(moments[4].accuracy.rms, rel=1e-9)
    assert moments[-1].accuracy.rms == pytest.approx(known.accuracy.rms, rel=1e-9)
    assert moments[-1].seconds == pytest.approx(known.seconds)


def test_readings_taken_out_one_after_the_other_leave_what_conditioning_on_the_others_says() -> None:
    """In any order, and whichever of them was asked for before: what one column becomes follows from the way here."""
    problem = mixed()
    readings = [r for r in drawn(problem) if r.setup == "probe"]
    fitted = Fitted.of(problem.observation, readings)
    fitted.weigh(np.ones(len(readings)))
    fitted.without(11)
    less = fitted.without(0).without(5)
    less.without(3)
    weights = np.ones(len(readings))
    weights[[0, 5, 11]] = 1e-12
    left, spread = _conditioned(problem, readings, weights)
    for without in (less.without(11), fitted.without(11).without(5).without(0)):
        others = weights == 1.0
        assert without.left[others] == pytest.approx(left[others], abs=1e-11)
        assert without.spread[others] == pytest.approx(spread[others], rel=1e-4)


def test_numbers_with_nothing_in_common_are_estimated_as_if_they_had() -> None:
    """Three blocks against the same features turned, which leaves no nought: one block, and the same products."""
    rng = np.random.default_rng(3)
    features = np.zeros((60, 12))
    for numbers, unknowns in ((slice(0, 25), [0, 3, 7]), (slice(25, 45), [1, 2, 8, 11]), (slice(45, 58), [4, 5, 9])):
        features[numbers, unknowns] = rng.standard_normal((numbers.stop - numbers.start, len(unknowns)))
    order, noise, values = rng.permutation(60), rng.uniform(0.5, 2.0, 60), rng.standard_normal(60)
    turned = features @ np.linalg.qr(rng.standard_normal((12, 12)))[0]
    weights = rng.uniform(0.1, 1.0, 60)
    apart, whole = (Fitted(each[order], noise, values, np.arange(60)) for each in (features, turned))
    for each in (apart, whole):
        each.weigh(weights)
    assert apart.left == pytest.approx(whole.left, rel=1e-10, abs=1e-12)
    assert apart.spread == pytest.approx(whole.spread, rel=1e-10, abs=1e-14)
    assert apart.without(4).without(9).surprise == pytest.approx(whole.without(4).without(9).surprise, rel=1e-9)


_MANY = """chain = "w-b-X-t"
[axes.X]
travel = ["0 mm", "1000 mm"]
[errors]
EXX = { std = "10 um", knots = 100 }
"""
_LASER = """machine = "many.machine.toml"
[target]
readings = 1
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
moves = ["X"]
"""


def test_many_bad_readings_are_found_in_less_memory_than_a_table_of_all_pairs(tmp_path: Path) -> None:
    """Explanations once held an inverse of the unknowns each: gigabytes with 1,000 unknowns and 10,000 readings."""
    (tmp_path / "many.machine.toml").write_text(_MANY, encoding="utf-8")
    (tmp_path / "many.toml").write_text(_LASER, encoding="utf-8")
    case, rng, count = Case(read_campaign(tmp_path / "many.toml")), np.random.default_rng(7), 1800
    at, bad = rng.random(count).tolist(), set(range(0, count, 50))
    shown = [(6e-6 * np.sin(9 * x) + 0.5e-6 * rng.standard_normal() + 40e-6 * (i in bad)) for i, x in enumerate(at)]
    readings = [Reading("laser", (x,), (1,), float(value)) for x, value in zip(at, shown, strict=True)]
    tracemalloc.start()
    found = verdict(case.observation, readings)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert {doubt.reading for doubt in found.doubts if doubt.rejected} == bad
    assert peak < 8 * count**2
