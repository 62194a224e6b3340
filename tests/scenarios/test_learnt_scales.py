"""A sample of `make trust`: with priors that are wrong by three, learnt scales make bands that hold."""

from __future__ import annotations

import pytest

from benchmarks.trust.virtual import covered, gross


@pytest.mark.parametrize("wrong", [1 / 3, 3.0])
def test_bands_hold_when_the_prior_is_wrong_by_three_and_the_report_says_so(wrong: float) -> None:
    found = covered("one-axis", wrong, 25)
    assert found.curves > 0.9
    assert found.tcp > 0.88
    assert found.misfit > 0.7


def test_one_gross_error_among_thirty_readings_is_found() -> None:
    moved = gross(50e-6, 8)
    assert moved.rejected == 1.0
    assert moved.typical < 0.25
    assert moved.naive > 5.0
