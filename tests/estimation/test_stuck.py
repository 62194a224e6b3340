"""An instrument that is stuck is weighed as the dense density says, and named; what a coarse display repeats is not."""

from collections.abc import Sequence
from dataclasses import replace
from math import log

import numpy as np
import pytest

from axiscal.campaign.agreement_words import acceptance, agreement_words, change_words
from axiscal.estimation.estimate import estimated
from axiscal.estimation.promise.mistake import Sought
from axiscal.estimation.promise.slip import Repeats, step_shown, stuck
from axiscal.measurement.reading import Reading
from axiscal.record.accepted import put_right
from axiscal_core.draws import sized as weighed
from tests.generators.dense_posterior import Dense, log_density
from tests.generators.foreign_axis import DIAL, LASER, foreign_case, foreign_readings, named
from tests.generators.problems import asked, sized


def _shown(readings: Sequence[Reading], step: float) -> list[Reading]:
    """Return what a display of a step shows, m."""
    return [replace(each, value=round(each.value / step) * step) for each in readings]


def _stuck(readings: Sequence[Reading], first: int) -> list[Reading]:
    """Return readings of an instrument that shows the same from the one of index `first` on."""
    return [replace(each, value=readings[min(i, first)].value) for i, each in enumerate(readings)]


def test_the_odds_of_exact_sizes_are_those_of_the_dense_density() -> None:
    problem, again, step = sized(asked("axis", 9, 5), ()), np.array([3, 4, 5, 6]), 2e-8
    some = np.isin(problem.reading, again)
    causes = problem.type_b[:, problem.judging]
    covariance = Dense(problem).covariance(np.zeros(len(problem.sizes))) + causes @ causes.T
    zero = np.zeros(len(problem.values))
    whole = log_density(problem.values, zero, covariance)
    rest = log_density(problem.values[~some], zero[~some], covariance[np.ix_(~some, ~some)])
    density = whole - rest - 0.5 * len(again) * log(2 * np.pi)
    odds = log(0.01 / 7) - density - float(np.sum(np.log(step / problem.noise[some])))
    repeated = Repeats((0,), again, log(7.0), {0: step})
    (suspect,) = stuck(Sought.of(problem), [repeated])
    found = suspect.weighed(weighed(problem).log_evidence)
    assert found.mistake[2:4] == ((0,), 3)
    assert found.mistake.log_odds == pytest.approx(odds, abs=0.05)


@pytest.mark.parametrize("setup", [DIAL, LASER], ids=["dial", "laser"])
def test_a_stuck_instrument_is_named_from_its_first_repeat_on_and_accepted(setup: str) -> None:
    readings = _stuck(_shown(foreign_readings(setup, 18, 3, 20e-6), 1e-6), 8)
    known = estimated(foreign_case(setup), readings)
    assert named(known) == [("stuck", 9)]
    assert "If the instrument is stuck" in agreement_words(known)
    accepted = acceptance(known.agreement.explained[0], known)
    assert put_right(readings, accepted) == readings[:9]
    assert (
        change_words(accepted)
        == f'values of "{readings[0].setup}" that repeat the one before, from reading 10 on, are left out'
    )
    assert not estimated(foreign_case(setup), readings[:9]).agreement.explained


def test_a_probe_that_repeats_each_third_value_is_named() -> None:
    right = _shown(foreign_readings(LASER, 28, 1), 1e-7)
    readings = [replace(each, value=right[i - 1].value) if i % 3 == 2 else each for i, each in enumerate(right)]
    assert ("stuck", 2) in named(estimated(foreign_case(LASER), readings))


def test_somebody_who_vouches_for_equal_values_is_believed() -> None:
    readings = _stuck(_shown(foreign_readings(LASER, 18, 3), 1e-6), 8)
    known = estimated(foreign_case(LASER), [replace(each, accepted=True) for each in readings])
    assert "stuck" not in {name for name, _ in named(known)}


@pytest.mark.parametrize(
    ("values", "step"),
    [
        ([12.4], 0.2), ([5.0], 1.0), ([0.0], 1.0), ([-31.0, 12.0, 25.0], 1.0), ([1.3, 12.4, 14.9], 0.1),
        ([2.5, 5.1, 7.6, 12.7], 2.5), ([2.54, 7.62, 10.16], 2.54), ([0.123456789, 0.987654321, 5.55544433], 0.0),
    ],
)  # fmt: skip
def test_the_step_of_a_display_is_its_last_digit_or_what_its_values_are_multiples_of(
    values: list[float], step: float
) -> None:
    assert step_shown(np.array(values) * 1e-6, 1e-6) == pytest.approx(step * 1e-6)


def test_readings_none_of_which_is_used_are_no_agreement_and_leave_no_uncertainty() -> None:
    """They were taken for readings that nothing contradicts, and the machine was called measured."""
    readings = [replace(each, value=0.9 + 0.1 * i) for i, each in enumerate(foreign_readings(LASER, 9, 3))]
    known = estimated(foreign_case(LASER), readings)
    assert (known.agreement.count, known.agreement.withheld) == (0, True)
    assert agreement_words(known).startswith("0 of 9 readings are used: ")
