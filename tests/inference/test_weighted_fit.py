"""The weighted estimate of all readings at once against plain conditioning, and the weights of Student-t noise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

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
