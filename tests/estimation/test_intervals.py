"""Readings of a coarse display or within bounds, against exact integrals, weighted draws, and coverage."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm

from axiscal.errors.prior import matern52
from axiscal.estimation.inference.intervals import Fitted, Sites, sited, sites
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.gaussian import lower_root
from benchmarks.trust.displays import held
from tests.generators.one_axis import observed, readings_at

_CURVE = 10.0
_AT = np.array([0.0, 0.15, 0.3, 0.5, 0.5, 0.75, 0.9, 0.9])
_DRAWS = 200_000


def _root() -> Array:
    return _CURVE * lower_root(matern52(np.abs(_AT[:, None] - _AT) / 0.2) + 1e-9 * np.eye(len(_AT)))


def _by_sites(root: Array, found: Sites) -> tuple[Array, Array]:
    covariance = np.linalg.inv(np.eye(root.shape[1]) + (root.T / found.variances) @ root)
    mean = root @ covariance @ (root.T @ (found.values / found.variances))
    return mean, np.sqrt(np.diag(root @ covariance @ root.T))


@pytest.mark.parametrize(("step", "shown"), [(1.0, 0.3), (8.0, 24.0), (40.0, -40.0), (100.0, 0.0)])
def test_one_interval_leaves_mean_and_variance_of_the_exact_posterior(step: float, shown: float) -> None:
    fitted = Fitted(np.array([[_CURVE]]), np.array([1.0 + step**2 / 12]), np.array([shown]), np.array([0]))
    found = sites(fitted, np.array([step]), np.array([1.0]))
    precision = 1 / _CURVE**2 + 1 / found.variances[0]
    mean = found.values[0] / found.variances[0] / precision

    def density(truth: float) -> float:
        return float(
            (norm.cdf(shown + step / 2 - truth) - norm.cdf(shown - step / 2 - truth)) * norm.pdf(truth / _CURVE)
        )

    ends = (-8 * _CURVE, 8 * _CURVE)
    whole, first, second = (quad(lambda t, k=k: t**k * density(t), *ends, limit=200)[0] for k in range(3))
    assert mean == pytest.approx(first / whole, rel=1e-3, abs=1e-6 * step)
    assert 1 / precision == pytest.approx(second / whole - (first / whole) ** 2, rel=1e-3)


@pytest.mark.parametrize("step", [10.0, 20.0, 33.0])
def test_intervals_keep_the_band_where_a_variance_of_a_twelfth_does_not(step: float) -> None:
    assert held(step, 60, "interval") > 0.925
    assert step == 10.0 or held(step, 60, "variance") < 0.91


def test_only_readings_of_a_coarse_display_are_changed() -> None:
    fine, coarse = observed('resolution = "1 um"'), observed('resolution = "20 um"')
    readings = readings_at((0.1, 0.1, 0.3, 0.6), 20e-6)
    assert sited(fine, readings) == readings
    changed = sited(coarse, [*readings, Reading("it", (0.4,), (1,), 20e-6, std=1e-6)])
    assert changed[-1].value == 20e-6
    assert all(abs(new.value - old.value) < 20e-6 and new.std for new, old in zip(changed, readings, strict=False))


@pytest.mark.parametrize("bound", [3.0, 6.0, 12.0])
def test_bounded_readings_leave_what_many_weighted_draws_leave(bound: float) -> None:
    rng, root = np.random.default_rng(5), _root()
    truth = root @ rng.standard_normal(len(_AT))
    shown = truth + rng.standard_normal(len(_AT)) + bound * rng.uniform(-1, 1, len(_AT))
    noise, steps = np.full(len(_AT), 1 + bound**2 / 3), np.full(len(_AT), 2 * bound)
    mean, std = _by_sites(root, sites(Fitted(root, noise, shown, np.arange(len(_AT))), steps, np.ones(len(_AT))))
    loose = np.linalg.inv(np.eye(len(_AT)) + (root.T / (2 * noise)) @ root)  # draws come from a wider normal
    white = rng.standard_normal((_DRAWS, len(_AT)))
    drawn = loose @ root.T @ (shown / (2 * noise)) + white @ lower_root(loose).T
    draws = drawn @ root.T
    inside = norm.cdf(shown + bound - draws) - norm.cdf(shown - bound - draws)
    weights = np.exp(0.5 * np.sum(white**2 - drawn**2, axis=1)) * np.prod(inside, axis=1)
    weights /= weights.sum()
    assert 1 / np.sum(weights**2) > 500
    exact = weights @ draws
    spread = np.sqrt(weights @ (draws - exact) ** 2)
    assert np.max(np.abs(mean - exact) / spread) < 0.15
    assert std == pytest.approx(spread, rel=0.15)  # where two intervals meet the density is not normal: 12 %
