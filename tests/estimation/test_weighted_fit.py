"""The estimate of all readings at once against plain conditioning, and the history of a campaign with bad ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import path
from axiscal.estimation.intervals import Fitted
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import seen, visited_by
from axiscal.numerics import Array
from tests.generators.campaigns import drawn, mixed


def _conditioned(problem: Case, readings: list[Reading], precisions: Array) -> tuple[Array, Array]:
    """The estimate of the readings, and its variance, by the road the belief takes."""
    observation = visited_by(problem.observation, readings)
    rows, _, values, _ = seen(observation, readings)
    signal = rows @ observation.prior_covariance() @ rows.T
    gain = np.linalg.solve(signal + np.diag(1 / precisions), signal).T
    return gain @ values, np.diag(signal - gain @ signal)


def test_mean_and_variance_are_those_of_conditioning_on_all_readings() -> None:
    problem = mixed()
    readings = drawn(problem)
    fitted = Fitted.of(problem.observation, readings)
    variances = seen(visited_by(problem.observation, readings), readings).variances
    assert fitted.noise == pytest.approx(variances, rel=1e-9, abs=0)
    precisions = np.random.default_rng(1).uniform(0.1, 1.0, len(fitted.noise)) / fitted.noise
    found, spread = fitted.estimate(fitted.values, precisions)
    expected, variance = _conditioned(problem, readings, precisions)
    assert found == pytest.approx(expected, abs=1e-11)
    assert spread == pytest.approx(variance, rel=1e-5, abs=0)


def test_the_history_ends_where_the_estimate_does() -> None:
    """Two bad readings amid the others are known from the first one on."""
    case = mixed()
    readings = drawn(case)
    readings[4] = replace(readings[4], value=readings[4].value + 90e-6)
    readings[6] = replace(readings[6], value=readings[6].value + 0.1)
    known = concluded(case, readings)
    assert {doubt.reading for doubt in known.outliers} == {4, 6}
    moments = path(known)
    assert moments[5].accuracy.rms == pytest.approx(moments[4].accuracy.rms, rel=1e-9)
    assert moments[-1].accuracy == known.accuracy
    assert moments[-1].seconds == pytest.approx(known.timed.seconds)
