"""The estimate of all readings against plain conditioning: in parts, repeated, used again, with bad ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import axiscal as ac
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import path
from axiscal.estimation.intervals import Fitted
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import places_of, seen, times_of, visited
from axiscal.numerics import Array
from tests.generators.campaigns import drawn, mixed


def _opened(problem: Case, readings: list[Reading]) -> Observation:
    """The map with columns for what comes with the readings."""
    return visited(problem.observation, places_of(problem.observation.setups, readings), times_of(readings))


def _conditioned(problem: Case, readings: list[Reading], precisions: Array) -> tuple[Array, Array]:
    """The estimate of the readings, and its variance, by the road the belief takes."""
    observation = _opened(problem, readings)
    rows, _, values, _ = seen(observation, readings)
    signal = rows @ observation.prior_covariance() @ rows.T
    gain = np.linalg.solve(signal + np.diag(1 / precisions), signal).T
    return gain @ values, np.diag(signal - gain @ signal)


def test_mean_and_variance_are_those_of_conditioning_on_all_readings() -> None:
    problem = mixed()
    readings = drawn(problem)
    fitted = Fitted.expected(problem.observation, readings)
    variances = seen(_opened(problem, readings), readings).variances
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


NOISE, REST = 0.3e-6, 0.3e-6
"""Of one reading, and of EXX of the built-in machine of one axis: what no spline follows."""


def laser() -> ac.Observation:
    """Return a laser on one axis that is always come to from below."""
    setup = ac.Setup("laser", "interferometer", (1.0, 0.0, 0.0), (0,), (0.5,), NOISE, (), 600.0, 1.0, 3.0, (0.0,), "+")
    return ac.Observation(ac.ErrorModel(ac.load_machine("one-axis")), (setup,))


@pytest.mark.parametrize("one_by_one", [True, False])
def test_reading_one_place_400_times_leaves_the_rest(one_by_one: bool) -> None:
    """The spline there is known as by one reading whose noise is the rest, and a twentieth of the instrument's."""
    observation = laser()
    knowledge, errors = ac.Knowledge.before(observation), observation.errors
    row = errors.rows(np.array([[0.37]]), np.ones((1, 1)))[0, 0]
    prior = float(row @ errors.prior_covariance() @ row)
    if one_by_one:
        for _ in range(400):
            knowledge = knowledge.read([Reading("laser", (0.37,), (1,), 0.0)])
    else:
        knowledge = knowledge.read([Reading("laser", (0.37,), (1,), 0.0)] * 400)
    std = float(np.linalg.norm(row @ knowledge.belief.factor[: errors.size]))
    assert std == pytest.approx((1 / prior + 1 / (REST**2 + NOISE**2 / 400)) ** -0.5, rel=1e-6)
    assert f"{std * 1e6:.3f}" == "0.300"


def test_readings_in_two_parts_are_readings_at_once() -> None:
    """Cells, drifts and three values at once; what was known before stays as it was."""
    case = mixed()
    readings, before = drawn(case, 12), ac.Knowledge.before(case.observation)
    at_once, in_parts = before.read(readings), before.read(readings[:5]).read(readings[5:])
    assert at_once.observation.cells == in_parts.observation.cells
    spread = np.sqrt(np.diag(at_once.belief.covariance))
    np.testing.assert_array_less(np.abs(at_once.belief.mean - in_parts.belief.mean), 1e-8 * spread)
    assert before.observation is case.observation
    assert before.read([]).belief.size == case.observation.size
