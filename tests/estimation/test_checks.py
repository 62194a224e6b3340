"""Check readings: z is that of a fit without them, U grows by their s and by nothing else, and a bad one is named."""

from dataclasses import replace

import numpy as np
import pytest

from axiscal.campaign.agreement_words import agreement_words
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import estimated
from axiscal.estimation.estimation import Estimation
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import places_of
from tests.generators.campaigns import on
from tests.generators.texts import machine_text, setup_text

MACHINE = machine_text("w-b-X-t", {"X": (0, 1000)}, {"EXX": 'std = "10 um", length = "200 mm", knots = 21'})
LASER = setup_text("laser", "interferometer", direction="x", noise="0.5 um", unknowns={"zero": "100 um"})
CASE = Case(on(MACHINE, LASER, target={"readings": 20}, usual="off", sure="exactly"))
EVEN = np.linspace(0.02, 0.98, 13)
DRAWN = np.array([0.131, 0.377, 0.528, 0.816])


def known(hidden: float = 0.0, slip: float = 0.0) -> Estimation:
    """Return what even places and four drawn ones make known of a sine.

    hidden : m, of an error with the period of the even places; slip : m, of the last drawn one
    """
    rng, at = np.random.default_rng(3), np.concatenate([EVEN, DRAWN])
    values = 8e-6 * np.sin(5 * at) + hidden * np.sin(2 * np.pi * (at - EVEN[0]) / (EVEN[1] - EVEN[0]))
    values += 0.5e-6 * rng.standard_normal(len(at))
    values[-1] += slip
    checks = np.arange(len(at)) >= len(EVEN)
    each = zip(at.tolist(), values.tolist(), checks.tolist(), strict=True)
    return estimated(CASE, [Reading("laser", (x,), (0,), value, check=check) for x, value, check in each])


def test_z_is_that_of_a_fit_without_the_reading() -> None:
    found = known()
    observation, places = CASE.observation, places_of(CASE.description.setups, found.readings)
    numbers = observation.numbers(places)
    rows, variances = numbers.rows, observation.variances(numbers)
    covariance = rows @ observation.prior_covariance() @ rows.T + np.diag(variances)
    values = np.array([reading.value for reading in found.readings])
    for check in found.checks.each:
        others = np.arange(len(values)) != check.reading
        gain = np.linalg.solve(covariance[np.ix_(others, others)], covariance[others, check.reading])
        left = covariance[check.reading, check.reading] - gain @ covariance[others, check.reading]
        away = abs(values[check.reading] - gain @ values[others]) / np.sqrt(left)
        assert check.z == pytest.approx(away, abs=0.01)  # rests of neighbouring cells go together by a little
    assert [check.reading for check in found.checks.each] == [13, 14, 15, 16]
    assert found.checks.s == pytest.approx(np.sqrt(np.mean([check.z**2 for check in found.checks.each])))


@pytest.mark.parametrize("hidden", [0.0, 4e-6])
def test_u_grows_by_s_where_it_is_above_one_and_the_mean_stays(hidden: float) -> None:
    """The same readings without the mark are the judge."""
    found = known(hidden)
    plain = estimated(CASE, [replace(reading, check=False) for reading in found.readings])
    assert found.posterior is not None
    s = found.checks.s or 0.0
    assert s > 3 if hidden else s < 1.5
    assert len(found.bad) < 2 or sum(not check.used for check in found.checks.each) == 2
    grown = max(found.agreement.inflation, max(1.0, s) ** 2)
    np.testing.assert_array_equal(found.printed.belief.mean, plain.printed.belief.mean)
    np.testing.assert_allclose(
        found.printed.belief.covariance * plain.agreement.inflation, grown * plain.printed.belief.covariance, rtol=1e-9
    )


def test_a_slip_of_a_check_is_a_bad_reading_and_widens_nothing() -> None:
    good, bad = known(), known(slip=200e-6)
    assert [doubt.reading for doubt in bad.outliers] == [16]
    assert (bad.checks.as_promised, len(bad.checks.each)) == (3, 4)
    assert bad.checks.s == pytest.approx(good.checks.s, rel=0.5)
    assert "checks: 3 of 4 as promised" in agreement_words(bad)
    assert "checks: 4 of 4 as promised, s = " in agreement_words(good)
