"""Readings of a coarse display, against exact integrals and against the coverage that rounded readings leave."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm

from axiscal.estimation.inference.odd_readings import Fitted, sited, sites
from axiscal.measurement.reading import Reading
from benchmarks.trust.displays import held
from tests.generators.one_axis import observed, readings_at

_CURVE = 10.0


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
