"""NIST's certified regressions, and random models against ball arithmetic."""

from __future__ import annotations

import numpy as np
import pytest

from tests.certify import least_squares, models


@pytest.mark.parametrize("name", least_squares.DIGITS)
def test_a_reference_regression_keeps_the_digits_asked_for(name: str) -> None:
    coefficients, deviations = least_squares.digits(name)
    assert coefficients >= least_squares.DIGITS[name]
    assert deviations >= least_squares.DIGITS[name]


@pytest.mark.parametrize("seed", range(6))
def test_a_random_model_agrees_with_ball_arithmetic(seed: int) -> None:
    """500 of them: `make certify PART=models`."""
    pytest.importorskip("flint")
    assert models.error(models.random_model(np.random.default_rng(seed))) < models.LIMIT
