"""What a spline leaves of a curve between its knots, against drawn curves and another interpolation."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.special import gamma, kv

from axiscal.error_model.prior import between_knots
from axiscal.numerics import Array
from axiscal.numerics.gaussian import unique_root

KNOTS, POINTS, CURVES = 21, 12, 4000


def correlation(distance: Array, smoothness: float) -> Array:
    """Return the Matérn correlation of any smoothness, by Bessel functions."""
    scaled = np.sqrt(2 * smoothness) * np.maximum(distance, 1e-9)
    result: Array = 2 ** (1 - smoothness) / gamma(smoothness) * scaled**smoothness * kv(smoothness, scaled)
    return result


@pytest.mark.parametrize("smoothness", [0.5, 1.5, 2.5])
@pytest.mark.parametrize("spacing", [0.25, 0.5, 0.93, 3.0])
def test_it_is_what_a_natural_spline_through_drawn_curves_leaves(spacing: float, smoothness: float) -> None:
    at = np.arange((KNOTS - 1) * POINTS + 1) / POINTS
    covariance = correlation(spacing * np.abs(at[:, None] - at), smoothness)
    draws = np.random.default_rng(1).standard_normal((CURVES, len(at)))
    curves = draws @ unique_root(covariance).T
    spline = CubicSpline(at[::POINTS], curves[:, ::POINTS], axis=1, bc_type="natural")
    left = float(np.sqrt(np.mean((curves - spline(at)) ** 2)))
    assert between_knots(spacing, smoothness) == pytest.approx(left, rel=0.03)


def test_of_what_is_as_long_as_two_intervals_a_twentieth_is_left() -> None:
    assert between_knots(0.5, 2.5) == pytest.approx(0.05, abs=0.003)
    assert between_knots(1e-3, 2.5) < 1e-3
    assert between_knots(1e3, 2.5) == between_knots(20.0, 2.5) > 1.0
