"""Splines against scipy."""

from typing import Literal

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from axiscal.numerics import Array
from axiscal_core.refusals import InputError
from axiscal_core.splines import (
    Constant,
    CyclicSpline,
    NaturalSpline,
    Spline,
    gauss,
    spacing_limit,
)
from tests.generators.splines import bending

Kind = type[NaturalSpline | CyclicSpline]
ORDERS = (0, 1, 2, 3)
SCIPY_HOLDS = [(decades, order) for decades in (0.0, 1.0) for order in ORDERS] + [(4.0, 0), (4.0, 1)]
"""Where scipy itself holds 1e-12: it solves for slopes, so that S'' loses a digit per decade of uneven spacing."""


def uneven_knots(n: int, seed: int, decades: float = 4.0) -> Array:
    """Return knots whose spacings span the decades, the extremes included."""
    rng = np.random.default_rng(seed)
    exponent = rng.uniform(-decades, 0, n - 1)
    if n > 2:
        exponent[rng.permutation(n - 1)[:2]] = -decades, 0.0
    return np.cumsum(np.r_[rng.normal(), 10**exponent])


def positions(knots: Array, seed: int) -> Array:
    """Return positions inside, at the knots but the last, and half-way between knots."""
    inside = np.random.default_rng(seed).uniform(knots[0], knots[-1], 100)
    return np.concatenate([inside, knots[:-1], (knots[1:] + knots[:-1]) / 2])


def relative(found: Array, expected: Array) -> float:
    """Return the largest difference relative to the largest entry."""
    return float(np.abs(found - expected).max() / np.abs(expected).max())


@pytest.mark.parametrize(("decades", "order"), SCIPY_HOLDS)
@pytest.mark.parametrize("n", [3, 4, 7, 40])
@pytest.mark.parametrize("kind", [NaturalSpline, CyclicSpline])
def test_rows_agree_with_scipy(kind: Kind, n: int, decades: float, order: int) -> None:
    knots = uneven_knots(n, n, decades)
    t, spline = positions(knots, n), kind(knots)
    values = np.eye(spline.size)[np.arange(n) % spline.size]  # the last point of a cyclic one is its first
    ends: Literal["natural", "periodic"] = "natural" if kind is NaturalSpline else "periodic"
    expected = CubicSpline(knots, values, bc_type=ends)(t, order, extrapolate=False)
    assert relative(spline.rows(t, order), expected) < 1e-12


def test_two_knots_make_a_straight_line() -> None:
    line = NaturalSpline(np.array([1.0, 3.0]))
    np.testing.assert_allclose(line.rows([0.0, 1.0, 2.5, 5.0]) @ [2.0, 6.0], [0.0, 2.0, 5.0, 10.0], atol=1e-15)
    np.testing.assert_allclose(line.gram(), [[2 / 3, 1 / 3], [1 / 3, 2 / 3]], rtol=1e-15)
    assert not bending(line).any()


def test_natural_spline_goes_on_straight() -> None:
    spline = NaturalSpline(np.array([0.0, 1.0, 1.5, 4.0]))
    for end, beyond in ((0.0, [-2.0, -0.5]), (4.0, [4.5, 9.0])):
        expected = spline.rows(end) + np.subtract(beyond, end)[:, None] * spline.rows(end, 1)
        np.testing.assert_allclose(spline.rows(beyond), expected, atol=1e-14)
        np.testing.assert_array_equal(spline.rows(beyond, 1), np.repeat(spline.rows(end, 1), 2, axis=0))
        assert not spline.rows(beyond, 2).any()
        assert not spline.rows(beyond, 3).any()


def test_turns_count_modulo_the_turn() -> None:
    spline = CyclicSpline(np.array([0.0, 0.25, 0.75, 1.0]))
    t = np.array([0.0, 0.1, 0.25, 0.6, 0.875])
    for order in ORDERS:
        for turns in (-3, 1, 2):
            np.testing.assert_allclose(spline.rows(t + turns, order), spline.rows(t, order), atol=1e-11)
    np.testing.assert_array_equal(spline.rows(1.0, 3), spline.rows(0.0, 3))
    np.testing.assert_allclose(spline.rows(-1e-300), spline.rows(0.0), atol=1e-15)


@pytest.mark.parametrize(
    "spline",
    [NaturalSpline(np.array([0, 1, 5])), CyclicSpline(np.array([0, 2, 3, 7])), Constant(2.0, 5.0)],
    ids=["natural", "cyclic", "1"],
)
def test_quadrature_is_exact_to_degree_nine_per_interval(spline: Spline) -> None:
    node, weight = (each.ravel() for each in gauss(spline.knots, 5))
    knots = spline.knots
    np.testing.assert_allclose(weight.sum(), knots[-1] - knots[0], rtol=1e-14)
    degree = 1 if isinstance(spline, Constant) else 9
    np.testing.assert_allclose(
        weight @ node**degree, (knots[-1] ** (degree + 1) - knots[0] ** (degree + 1)) / (degree + 1), rtol=1e-13
    )


def test_the_widest_spacing_of_a_sine() -> None:
    """A sine of amplitude A and wavelength λ: band 2 A, curvature A (2π/λ)² → 0.5513 λ (B&H eq. 15)."""
    amplitude, wavelength = 3e-6, 0.04
    limit = spacing_limit(2 * amplitude, amplitude * (2 * np.pi / wavelength) ** 2)
    assert limit / wavelength == pytest.approx(np.sqrt(12) / (2 * np.pi))
    for width, curvature in ((0.0, 1.0), (1.0, 0.0), (-1.0, 1.0), (np.nan, 1.0), (1.0, np.inf)):
        with pytest.raises(InputError):
            spacing_limit(width, curvature)


@pytest.mark.parametrize("kind", [NaturalSpline, CyclicSpline])
@pytest.mark.parametrize("knots", [[], [0.0], [[0.0, 1.0, 2.0]], [0.0, 1.0, 1.0], [0.0, np.nan, 2.0]])
def test_bad_knots_are_refused(kind: type[NaturalSpline | CyclicSpline], knots: list[float]) -> None:
    with pytest.raises(InputError):
        kind(np.array(knots))
