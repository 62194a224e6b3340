"""Averages over scales: draws against integrals, and what they add to a band against the same written out on a grid."""

from __future__ import annotations

import numpy as np
import pytest
from axiscal.inference.evidence import Evidence
from axiscal.inference.fit import fit
from axiscal.inference.mixture import mixture
from axiscal.inference.scales import Scale, log_prior_precision

from axiscal.error_model.prior import between_knots
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from tests.generators.one_axis import observed


def test_draws_give_the_moments_of_a_density_that_is_no_normal() -> None:
    """A Gumbel density of a logarithm, skewed: E[exp(2θ)] by summing over a fine grid."""

    def density(logs: Array) -> float:
        return float(logs[0] - np.exp(logs[0]) - logs[0] ** 2 / 8)

    grid = np.linspace(-12, 6, 20001)
    best = float(grid[np.argmax([density(np.array([x])) for x in grid])])
    curvature = np.array([[np.exp(best) + 0.25]])
    found = mixture(density, np.array([best]), curvature, np.array([[0.25]]), 1)
    heights = np.exp(grid - np.exp(grid) - grid**2 / 8)
    expected = float(np.sum(heights * np.exp(2 * grid)) / np.sum(heights))
    assert found.mean_square(0) == pytest.approx(expected, rel=0.15)
    assert found.whole == pytest.approx(float(np.log(np.sum(heights) * (grid[1] - grid[0]))), abs=0.05)
    assert found.size > 60
    assert found.weights.sum() == pytest.approx(1.0)


@pytest.mark.long
def test_how_probable_readings_are_at_any_scales_is_the_mean_over_draws_from_their_prior() -> None:
    observation = observed('noise = "1 um"')
    scales = (Scale("std", "EXX", 10e-6), Scale("noise", "it", 1e-6))
    readings = _read(observation, 12)
    found, evidence = fit(observation, readings, scales), Evidence(observation, readings, scales)
    covariance = np.linalg.inv(log_prior_precision(scales))
    drawn = np.random.default_rng(0).multivariate_normal(np.zeros(2), covariance, 20_000)
    logs = np.array([evidence.log_likelihood(each) for each in drawn])
    assert found.averaged == pytest.approx(logs.max() + np.log(np.mean(np.exp(logs - logs.max()))), abs=0.1)


def test_where_the_readings_say_nothing_the_draws_are_as_wide_as_the_prior() -> None:
    found = mixture(lambda logs: -0.5 * float(logs @ logs) / 4, np.zeros(1), np.array([[1e-6]]), np.array([[0.25]]), 1)
    mean = float(found.weights @ found.logs[:, 0])
    assert float(found.weights @ (found.logs[:, 0] - mean) ** 2) == pytest.approx(4.0, rel=0.3)


def test_draws_do_not_turn_with_the_last_digits_of_a_curvature() -> None:
    """Thirty scales, most of which curve alike: another rounding of the curvature leaves every draw where it was."""
    rng, size = np.random.default_rng(4), 30
    prior = np.eye(size) + 0.5
    curvature = prior + np.diag([30.0, 20.0, *[1.0] * (size - 2)])
    rounded = rng.normal(size=(size, size)) * 1e-10
    both = [
        mixture(lambda logs: -0.5 * float(logs @ curvature @ logs), np.zeros(size), each, prior, 100)
        for each in (curvature, curvature + rounded + rounded.T)
    ]
    assert both[1].logs == pytest.approx(both[0].logs, abs=1e-7)
    assert both[0].size > 0.4 * len(both[0].logs)


def _read(observation: Observation, count: int) -> list[Reading]:
    rng = np.random.default_rng(2)
    places = np.linspace(0.03, 0.97, count)
    return [Reading("it", (float(x),), (1,), 12e-6 * np.sin(5 * x) + 1e-6 * rng.standard_normal()) for x in places]


def test_the_band_is_that_of_all_scales_on_a_grid() -> None:
    """One scale open, the std: mean and covariance for each of many values, weighed by likelihood times prior."""
    observation = observed('noise = "1 um"\nunknowns = {}')
    readings = _read(observation, 7)
    scales = (Scale("std", "EXX", 10e-6),)
    found = fit(observation, readings, scales)
    rows = observation.errors.functions[0].basis.rows(np.array([r.pose[0] for r in readings]))
    y, prior = np.array([r.value for r in readings]), observation.errors.functions[0].covariance

    def posterior(factor: float) -> tuple[float, Array, Array]:
        covariance = factor**2 * prior
        inverse = np.linalg.inv(rows @ covariance @ rows.T + 1e-12 * np.eye(7))
        gain = covariance @ rows.T @ inverse
        height = -0.5 * y @ inverse @ y + 0.5 * np.linalg.slogdet(inverse)[1]
        return float(height), gain @ y, covariance - gain @ rows @ covariance

    grid = np.linspace(-4, 5, 721)
    each = [posterior(float(np.exp(x))) for x in grid]
    heights = np.array([h for h, _, _ in each]) - 0.5 * grid**2 * log_prior_precision(scales)[0, 0]
    weights = np.exp(heights - heights.max())
    weights /= weights.sum()
    best = int(np.argmax(heights))
    centre = each[best][1]
    whole = sum(w * (c + np.outer(m - centre, m - centre)) for w, (_, m, c) in zip(weights, each, strict=True))
    added = found.widening.factor @ found.widening.factor.T
    total = np.trace(each[best][2]) + np.trace(added)
    assert found.scales.factors[0] == pytest.approx(np.exp(grid[best]), rel=0.02)
    assert total == pytest.approx(np.trace(whole), rel=0.1)
    assert total > 1.1 * np.trace(each[best][2])


def test_a_curve_whose_length_was_learnt_has_detail_between_its_knots() -> None:
    """Readings as far apart as the knots lie on the spline, so that no rest is learnt; the draws say how long it is."""
    observation = observed('noise = "0.5 um"\nunknowns = {}')
    function = observation.errors.functions[0]
    rng = np.random.default_rng(3)
    values = 10e-6 * rng.standard_normal(len(function.basis.knots))
    readings = [Reading("it", (float(x),), (1,), float(y)) for x, y in zip(function.basis.knots, values, strict=True)]
    scales = (Scale("std", "EXX", 10e-6), Scale("length", "EXX", 0.2), Scale("rest", "EXX", 0.5e-6))
    found = fit(observation, readings, scales)
    spacing = float(function.basis.knots[1] - function.basis.knots[0])
    parts = list(found.possible.parts())
    least = [10e-6 * np.exp(logs[0]) * between_knots(spacing / (0.2 * np.exp(logs[1])), 2.5) for logs, _ in parts]
    rest = [0.5e-6 * np.exp(logs[2]) for logs, _ in parts]
    wanted = sum(w * max(one, other) ** 2 for (_, w), one, other in zip(parts, least, rest, strict=True))
    assert found.widening.rests["EXX"] == pytest.approx(float(np.sqrt(wanted)), rel=1e-9)
    assert found.widening.rests["EXX"] > 2 * 0.5e-6 * found.scales.factors[2]
