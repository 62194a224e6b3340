"""θ = f q(x) is Student-t of four degrees where x is standard normal."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import norm
from scipy.stats import t as student

from axiscal.description.sizes import Size, Sizes

mpmath = pytest.importorskip("mpmath")  # untyped: Any

ONE = Sizes((Size("std", ("EXX",), 1.0),))
NEAR = 3.0
"""|x| up to which θ of spread one is not cut: q(3) is 6.6."""


@given(st.floats(-NEAR, NEAR))
def test_theta_is_the_quantile_of_four_degrees(x: float) -> None:
    theta, _ = ONE.at(np.array([x]))
    # scipy takes the share of nearly one half to 1e-16 only, and its own quantile there to 1e-8
    assert theta[0] == pytest.approx(np.sign(x) * student.isf(norm.sf(abs(x)), 4), rel=1e-9, abs=1e-7)


def test_near_the_median_theta_is_a_line() -> None:
    """θ = x φ(0)/f(0): a digit lost in a difference would show."""
    x = np.array([1e-7, 1e-6, 1e-5, 1e-4])
    np.testing.assert_allclose(ONE.at(x)[0], x * norm.pdf(0) / student.pdf(0, 4), rtol=1e-7)


@given(st.floats(-NEAR + 0.01, NEAR - 0.01))
def test_slope_is_that_of_differences(x: float) -> None:
    step = 1e-3
    above, below = (ONE.at(np.array([x + sign * step]))[0][0] for sign in (1, -1))
    assert ONE.at(np.array([x]))[1][0] == pytest.approx((above - below) / (2 * step), rel=1e-5)


@pytest.mark.parametrize("x", [2.0, 5.0, 8.0, 12.0, 20.0])
def test_tails_are_right_to_many_digits(x: float) -> None:
    """The share beyond θ, an integral with forty digits, is that beyond x."""
    small = Sizes((Size("std", ("EXX",), 1e-30),))
    with mpmath.workdps(40):
        q = mpmath.mpf(float(small.at(np.array([x]))[0][0])) / mpmath.mpf(1e-30)
        # with t = q/r the integral from q to infinity becomes one from nought to one
        beyond = mpmath.quad(lambda r: mpmath.mpf(3) / 8 * (1 + (q / r) ** 2 / 4) ** -2.5 * q / r**2, [0, 0.5, 1])
        wanted = mpmath.erfc(mpmath.mpf(x) / mpmath.sqrt(2)) / 2
        assert abs(beyond / wanted - 1) < 1e-10


def test_sides_mirror_each_other_and_nought_is_nought() -> None:
    x = np.linspace(0, NEAR, 50)
    np.testing.assert_allclose(ONE.at(-x)[0], -ONE.at(x)[0], rtol=1e-14)
    assert ONE.at(np.zeros(1))[0][0] == 0.0


def test_spread_scales_and_far_out_nothing_overflows() -> None:
    several = Sizes((Size("std", ("EXX", "EYY"), 0.5), Size("noise", ("laser",), 2.0)))
    theta, slope = several.at(np.array([[1.0, 1.0], [40.0, -40.0]]))
    np.testing.assert_allclose(theta[0], np.array([0.5, 2.0]) * student.ppf(norm.cdf(1.0), 4), rtol=1e-9)
    assert theta[1].tolist() == [7.0, -7.0]
    assert slope[1].tolist() == [0.0, 0.0]


def test_a_size_is_found_by_kind_and_owner() -> None:
    several = Sizes((Size("std", ("EXX", "EYY"), 0.5), Size("noise", ("laser",), 2.0)))
    assert several.indices("std", ["EYY", "EZZ", "EXX"]).tolist() == [0, -1, 0]
    assert several.index("noise", "EXX") == -1
