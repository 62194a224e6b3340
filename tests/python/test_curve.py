"""One curve in Python: its band and its next place, against a plain dense twin."""

import mpmath
import numpy as np
import pytest

import axiscal as ac
from axiscal.numerics import Array
from axiscal_core.splines import matern

NOISE = 0.3e-6


def plain_rms(covariance: Array, places: Array, spline: ac.NaturalSpline, at: Array) -> Array:
    """Return the mean variance over the travel after one reading at each of many places, (m,), by plain formulas."""
    grid = spline.rows(at)
    found = []
    for row in spline.rows(places):
        h = covariance @ row
        after = covariance - np.outer(h, h) / (NOISE**2 + row @ h)
        values = np.einsum("ij,jk,ik->i", grid, after, grid)
        found.append(np.sqrt(np.trapezoid(values, at) / (at[-1] - at[0])))
    return np.array(found)


def test_the_next_place_is_the_best_of_a_dense_grid() -> None:
    curve = ac.Curve([0.0, 0.6], std=10e-6, length=0.15)
    spline = ac.NaturalSpline(np.linspace(0, 0.6, 7))
    covariance = 1e-10 * matern(np.abs(spline.knots[:, None] - spline.knots) / 0.15)
    for _ in range(3):
        at, places = np.linspace(0, 0.6, 4001), np.linspace(0, 0.6, 1201)
        each = plain_rms(covariance, places, spline, at)
        place = curve.next(NOISE)
        curve = curve.read(place, 1e-6, NOISE)
        assert curve.rms == pytest.approx(float(plain_rms(covariance, np.array([place]), spline, at)[0]), rel=1e-6)
        assert curve.rms <= each.min() * (1 + 1e-6)
        row = spline.rows(place)[0]
        covariance = covariance - np.outer(covariance @ row, covariance @ row) / (NOISE**2 + row @ covariance @ row)


@pytest.mark.parametrize("noise", [1e-1, 1e-5, 1e-9])
def test_what_is_known_to_the_last_digit_is_right_and_a_next_place_is_found(noise: float) -> None:
    """Twenty readings against sixty digits, three of them where it was read before: variances fall by 1e18."""
    curve, digits = ac.Curve([0.0, 10.0], std=1.0), mpmath.MPContext()
    digits.dps = 60
    exact, grams = digits.matrix(np.eye(7).tolist()), digits.matrix(curve.spline.gram().tolist())
    mean, variance = digits.matrix(7, 1), digits.mpf(noise) ** 2
    for number in range(20):
        at = 5.0 if number % 6 == 5 else curve.next(noise)
        row = digits.matrix(curve.spline.rows(at)[0].tolist())
        gain = exact * row / (variance + (row.T * exact * row)[0])
        mean, exact = mean + gain * (np.sin(at) - (row.T * mean)[0]), exact - gain * (row.T * exact)
        curve = curve.read(at, np.sin(at), noise)
        expected = [float(exact[i, i]) for i in range(7)]
        np.testing.assert_allclose(np.diag(curve.known.covariance), expected, rtol=1e-12)
        np.testing.assert_allclose(curve.known.mean, np.array(mean.tolist(), dtype=float).ravel(), rtol=1e-10)
        total = sum(grams[i, j] * exact[i, j] for i in range(7) for j in range(7))
        assert pytest.approx(float(total), rel=1e-12) == curve.J


def test_a_curve_says_what_it_is() -> None:
    assert repr(ac.Curve(["0 mm", "600 mm"], std="10 um")).startswith("<Curve from 0 to 0.6, 7 control values, known")
    with pytest.raises(ac.InputError, match="'600 s' is no length"):
        ac.Curve(["0 mm", "600 s"], std="10 um")
    with pytest.raises(ac.InputError, match="outside the travel"):
        ac.Curve(["0 mm", "600 mm"], std="10 um")("601 mm")
