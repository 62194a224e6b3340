"""What is used again of an earlier estimation, and what is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from axiscal.estimation.estimate import concluded, estimated
from axiscal.promise.agreement import NOTHING_READ
from tests.generators.campaigns import drawn, mixed


def test_without_a_new_reading_nothing_is_estimated_anew() -> None:
    case = mixed()
    readings = drawn(case, 6)
    known = estimated(case, readings)
    assert estimated(case, tuple(readings), known) is known


def test_an_estimation_of_other_readings_is_not_used() -> None:
    """One that was taken back, and one whose value is another one."""
    case = mixed()
    readings = drawn(case, 8)
    fresh = estimated(case, readings[:6])
    other = [replace(readings[0], value=readings[0].value + 5e-6), *readings[1:6]]
    for before in (estimated(case, readings), estimated(case, other), estimated(mixed(), readings[:5])):
        found = estimated(case, readings[:6], before)
        assert found.stated is case
        assert len(found.readings) == 6
        np.testing.assert_array_equal(found.knowledge.belief.mean, fresh.knowledge.belief.mean)


def test_nothing_read_is_the_prior() -> None:
    case = mixed()
    for known in (estimated(case, ()), concluded(case, ())):
        assert (known.readings, known.outliers, known.posterior) == ((), (), None)
        assert known.agreement == NOTHING_READ
        np.testing.assert_array_equal(known.knowledge.belief.covariance, case.prior.covariance)
        assert known.accuracy == case.yardstick.measure(case.prior)


def test_what_is_known_does_not_depend_on_whether_more_readings_follow() -> None:
    """Nor on whether they came one by one."""
    case = mixed()
    readings = drawn(case, 16)
    readings[9] = replace(readings[9], value=readings[9].value + 200e-6)
    at_the_end, meanwhile, later = concluded(case, readings), estimated(case, readings), estimated(case, readings[:15])
    for other in (meanwhile, estimated(case, readings, later)):
        np.testing.assert_array_equal(other.banded.knowledge.belief.mean, at_the_end.banded.knowledge.belief.mean)
        covariances = [each.banded.knowledge.belief.covariance for each in (other, at_the_end)]
        np.testing.assert_array_equal(*covariances)
        assert other.accuracy == at_the_end.accuracy
        assert other.agreement == at_the_end.agreement
        assert other.outliers == at_the_end.outliers
    assert [doubt.reading for doubt in at_the_end.outliers] == [9]
