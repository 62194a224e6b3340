"""What is used again of an earlier estimation, and what is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from axiscal.estimation.estimate import concluded, estimated
from axiscal.estimation.promise.agreement import NOTHING_READ
from tests.generators.campaigns import drawn, mixed


def test_nothing_read_is_the_prior() -> None:
    case = mixed()
    for known in (estimated(case, ()), concluded(case, ())):
        assert (known.readings, known.outliers, known.posterior) == ((), (), None)
        assert known.agreement == NOTHING_READ
        np.testing.assert_array_equal(known.knowledge.belief.covariance, case.prior.covariance)
        assert known.accuracy == case.yardstick.measure(case.prior)


def test_the_end_says_what_was_known_before_it() -> None:
    case = mixed()
    readings = drawn(case, 16)
    readings[9] = replace(readings[9], value=readings[9].value + 200e-6)
    known = estimated(case, readings)
    assert concluded(case, readings, known) is known
    assert concluded(case, readings).accuracy == known.accuracy
    assert [doubt.reading for doubt in known.outliers] == [9]
