"""Readings of a coarse display or within bounds, against exact integrals, weighted draws, and coverage."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm

from axiscal.estimation.case import Case
from axiscal.estimation.intervals import at_precisions, sited, sites
from axiscal.estimation.promise.problem import problem
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal_core.problem import Problem
from axiscal_core.spaces import turned
from axiscal_core.theta import Sizes
from tests.generators.campaigns import built_in
from tests.generators.one_axis import observed, readings_at
from tests.generators.texts import campaign_text, setup_text

_CURVE = 10.0


def rows_of(posed: Problem) -> Array:
    stated = np.zeros(0)
    return turned(posed, posed.rows, stated, [curves.roots(stated) for curves in posed.curves])


def normal(observation: Observation, readings: list[Reading]) -> Sequence[Reading]:
    """Return readings with normal ones in the place of coarse ones."""
    posed = problem(observation, readings, Sizes(()), usual=False)
    return sited(posed, rows_of(posed), observation.setups, readings)


@pytest.mark.parametrize(("step", "shown"), [(1.0, 0.3), (8.0, 24.0), (40.0, -40.0), (100.0, 0.0)])
def test_one_interval_leaves_mean_and_variance_of_the_exact_posterior(step: float, shown: float) -> None:
    given = np.array([[1.0 + step**2 / 12], [shown], [step], [1.0]])
    (value,), (variance,) = sites(np.array([[_CURVE]]), *given)
    precision = 1 / _CURVE**2 + 1 / variance
    mean = value / variance / precision

    def density(truth: float) -> float:
        return float(
            (norm.cdf(shown + step / 2 - truth) - norm.cdf(shown - step / 2 - truth)) * norm.pdf(truth / _CURVE)
        )

    ends = (-8 * _CURVE, 8 * _CURVE)
    whole, first, second = (quad(lambda t, k=k: t**k * density(t), *ends, limit=200)[0] for k in range(3))
    assert mean == pytest.approx(first / whole, rel=1e-3, abs=1e-6 * step)
    assert 1 / precision == pytest.approx(second / whole - (first / whole) ** 2, rel=1e-3)


def test_only_readings_of_a_coarse_display_are_changed() -> None:
    fine, coarse = observed('resolution = "1 um"'), observed('resolution = "20 um"')
    readings = readings_at((0.1, 0.1, 0.3, 0.6), 20e-6)
    assert normal(fine, readings) == readings
    changed = normal(coarse, [*readings, Reading("it", (0.4,), (1,), 20e-6, std=1e-6)])
    assert changed[-1].value == 20e-6
    assert all(abs(new.value - old.value) < 20e-6 and new.std for new, old in zip(changed, readings, strict=False))


def test_of_each_interval_the_estimate_has_the_mean_and_the_variance_that_all_others_leave() -> None:
    """The fixed point itself: numbers without their own site, cut by their interval, by numerical integration."""
    coarse = observed('resolution = "20 um"')
    at, rng = (0.1, 0.12, 0.3, 0.33, 0.6, 0.8), np.random.default_rng(4)
    shown = 20e-6 * rng.integers(-1, 3, len(at))
    readings = [replace(each, value=float(value)) for each, value in zip(readings_at(at, 0.0), shown, strict=True)]
    readings[4] = replace(readings[4], std=1e-6)
    posed, setup = problem(coarse, readings, Sizes(()), usual=False), coarse.setups[0]
    before, features = posed.values * posed.noise, posed.noise[:, None] * rows_of(posed)
    changed, scatter = normal(coarse, readings), setup.scatter
    values = before + np.array([new.value - old.value for new, old in zip(changed, readings, strict=True)])
    precisions = np.array([(each.std or np.nan) ** -2 for each in changed])
    mean, variance = at_precisions(features, values, precisions)
    assert changed[4] == readings[4]
    assert len({each.std for each in changed}) > 3
    z = np.linspace(-8, 8, 4001)
    for number in (0, 1, 2, 3, 5):
        cavity = 1 / (1 / variance[number] - precisions[number])
        centre = cavity * (mean[number] / variance[number] - precisions[number] * values[number])
        truth = centre + np.sqrt(cavity) * z
        ends = (before[number] + half for half in (10e-6, -10e-6))
        density = norm.pdf(z) * -np.diff([norm.cdf((end - truth) / scatter) for end in ends], axis=0)[0]
        whole, first, second = (np.trapezoid(z**k * density, z) for k in range(3))
        assert (mean[number] - centre) / np.sqrt(cavity) == pytest.approx(first / whole, abs=1e-3)
        assert variance[number] / cavity == pytest.approx(second / whole - (first / whole) ** 2, rel=2e-3)


def test_readings_that_agree_in_coarse_steps_do_not_make_the_step_finer() -> None:
    """Else no scatter is left about the intervals, and two of neighbouring steps at one place have no answer."""
    for step, times in (("0.1 um", 0.1), ("5 um", 1.0)):
        laser = setup_text("laser", "interferometer", direction="x", resolution=step)
        case = Case(built_in(campaign_text("one-axis", laser, target={"readings": 9})))
        (before,), (after,) = (each.description.setups for each in (case, case.rescaled({("noise", "laser"): 0.1})))
        assert after.noise == pytest.approx(times * before.noise)
