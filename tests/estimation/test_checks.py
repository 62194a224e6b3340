"""Check readings against normal algebra written out, and against promises that are right and wrong."""

from __future__ import annotations

import numpy as np
import pytest
from axiscal.estimation.checks import checked
from scipy import stats

from axiscal.estimation.knowledge import Knowledge
from axiscal.inference.weighted_fit import Fitted
from tests.generators.laser_axis import CASE, machine, plus, read


def test_the_interval_is_that_of_a_chi_square_and_counts_every_fifth_reading() -> None:
    found = checked(CASE, read(machine(1), 30), 2e-6)
    assert found is not None
    assert found.count == 6
    square = (found.found / 2e-6) ** 2 * 6
    assert found.low == pytest.approx(2e-6 * np.sqrt(square / stats.chi2(6).ppf(0.975)))
    assert found.high == pytest.approx(2e-6 * np.sqrt(square / stats.chi2(6).ppf(0.025)))
    assert found.chance == pytest.approx(stats.chi2(6).sf(square))


def test_the_square_is_that_of_the_four_readings_that_cost_least_predicted_from_the_others() -> None:
    """Each that is kept out costs least of those that are left: found by estimating without each."""
    readings = read(machine(3), 20)
    found = checked(CASE, readings, 1.0)
    assert found is not None
    numbers = Fitted.of(CASE.observation, readings)
    covariance, kept_out = numbers.covariance(), list[int]()
    for _ in range(4):
        left = [i for i in range(20) if i not in kept_out]
        costs = [Knowledge.before(CASE.observation).read([readings[i] for i in left if i != out]) for out in left]
        rms = [CASE.yardstick.measure(each.belief).rms for each in costs]
        kept_out.append(left[int(np.argmin(rms))])
    others = [i for i in range(20) if i not in kept_out]
    shared = covariance[np.ix_(others, kept_out)]
    gain = np.linalg.solve(covariance[np.ix_(others, others)], shared).T  # an inverse loses five digits more
    errors = numbers.values[kept_out] - gain @ numbers.values[others]
    spread = covariance[np.ix_(kept_out, kept_out)] - gain @ shared
    assert found.found**2 * 4 == pytest.approx(float(errors @ np.linalg.solve(spread, errors)), rel=1e-6)


@pytest.mark.long
def test_promises_that_are_right_are_missed_by_chance_only() -> None:
    chances = [_chance(seed, 0.0) for seed in range(60)]
    assert sum(chance < 0.05 for chance in chances) <= 8
    assert 0.3 < float(np.mean(chances)) < 0.7


def test_noise_five_times_as_stated_is_shown_by_the_checks() -> None:
    assert sum(_chance(seed, 2.5e-6) < 0.05 for seed in range(10)) >= 9


def _chance(seed: int, noise: float) -> float:
    readings = read(machine(seed), 30)
    found = checked(CASE, plus(readings, noise * np.random.default_rng(seed).standard_normal(30)), 1e-6)
    assert found is not None
    return found.chance


def test_nine_readings_spare_none() -> None:
    assert checked(CASE, read(machine(1), 9), 1e-6) is None
