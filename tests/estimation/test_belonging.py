"""Which of several priors foretells readings, and their mixture: against scipy and against draws."""

from __future__ import annotations

import numpy as np
from scipy.stats import multivariate_normal

from axiscal.estimation.data_equation import (
    DataEquation,
    data_equation,
    log_evidence,
    moments_of,
    shares_of,
)
from axiscal.estimation.promise.problem import Inherited
from axiscal.numerics import Array
from tests.generators.campaigns import drawn, mixed


def _prior(rng: np.random.Generator, size: int) -> Inherited:
    root = rng.standard_normal((size, size))
    return Inherited(rng.standard_normal(size), root @ root.T)


def test_shares_are_those_of_the_densities() -> None:
    rng = np.random.default_rng(4)
    data = DataEquation(rng.standard_normal((3, 4)), rng.standard_normal(3))
    priors, weights = [_prior(rng, 4) for _ in range(3)], np.array([0.5, 0.3, 0.2])
    densities = [
        multivariate_normal(data.rows @ p.mean, data.rows @ p.covariance @ data.rows.T + np.eye(3)).pdf(data.values)
        for p in priors
    ]
    odds = weights * densities
    np.testing.assert_allclose(shares_of(data, priors, weights), odds / odds.sum(), rtol=1e-10)
    difference = log_evidence(data, priors[0]) - log_evidence(data, priors[1])
    np.testing.assert_allclose(difference, np.log(densities[0] / densities[1]), rtol=1e-9)


def test_moments_of_a_mixture_are_those_of_its_draws() -> None:
    rng = np.random.default_rng(5)
    parts, shares = [_prior(rng, 2) for _ in range(2)], np.array([0.7, 0.3])
    draws = np.vstack([rng.multivariate_normal(*p, size=int(200_000 * s)) for p, s in zip(parts, shares, strict=True)])
    found = moments_of(parts, shares)
    np.testing.assert_allclose(found.mean, draws.mean(axis=0), atol=0.02)
    np.testing.assert_allclose(found.covariance, np.cov(draws.T), rtol=0.03, atol=0.03)


def _posterior(prior: Array, data: DataEquation) -> tuple[Array, Array]:
    gain = prior @ data.rows.T @ np.linalg.inv(data.rows @ prior @ data.rows.T + np.eye(len(data.values)))
    return gain @ data.values, prior - gain @ data.rows @ prior


def test_a_data_equation_and_a_prior_make_the_belief_that_readings_make() -> None:
    case = mixed()
    readings = drawn(case)
    known, size = case.knowledge.read(readings).belief, case.errors.size
    data = data_equation(case.observation, readings)
    mean, covariance = _posterior(case.errors.prior_covariance(), data)
    scale = np.sqrt(np.diagonal(case.errors.prior_covariance()))
    np.testing.assert_allclose(mean / scale, known.mean[:size] / scale, atol=1e-6)
    correlated = (covariance - known.covariance[:size, :size]) / scale[:, None] / scale
    np.testing.assert_allclose(correlated, 0.0, atol=1e-6)


def test_a_squeezed_equation_says_the_same() -> None:
    rng = np.random.default_rng(6)
    data = DataEquation(rng.standard_normal((9, 3)), rng.standard_normal(9))
    assert data.squeezed.rows.shape == (3, 3)
    for whole, few in zip(_posterior(np.eye(3), data), _posterior(np.eye(3), data.squeezed), strict=True):
        np.testing.assert_allclose(whole, few, atol=1e-12)
