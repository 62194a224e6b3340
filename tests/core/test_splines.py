"""Splines against scipy, against 50-digit arithmetic, and against published numbers."""

from __future__ import annotations

import dataclasses
import json
from itertools import pairwise
from pathlib import Path
from typing import Any

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
    even_knots,
    quadrature,
    spacing_limit,
)
from tests.generators.splines import bending

mpmath = pytest.importorskip("mpmath")  # untyped: Any
GOLDEN = Path(__file__).resolve().parents[1] / "golden"
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
def test_natural_rows_agree_with_scipy(n: int, decades: float, order: int) -> None:
    knots = uneven_knots(n, n, decades)
    t = positions(knots, n)
    expected = CubicSpline(knots, np.eye(n), bc_type="natural")(t, order)
    assert relative(NaturalSpline(knots).rows(t, order), expected) < 1e-12


@pytest.mark.parametrize(("decades", "order"), SCIPY_HOLDS)
@pytest.mark.parametrize("n", [3, 4, 7, 40])
def test_cyclic_rows_agree_with_scipy(n: int, decades: float, order: int) -> None:
    knots = uneven_knots(n, n, decades)
    t = positions(knots, n)
    values = np.vstack([np.eye(n - 1), np.eye(n - 1)[:1]])
    expected = CubicSpline(knots, values, bc_type="periodic")(t, order, extrapolate=False)
    assert relative(CyclicSpline(knots).rows(t, order), expected) < 1e-12


def exact_second(spline: NaturalSpline | CyclicSpline) -> Any:
    """Return S'' at the knots from the control values, solved in 50 digits from the float knots: (n, size)."""
    t = [mpmath.mpf(float(x)) for x in spline.knots]
    size, cyclic = spline.size, isinstance(spline, CyclicSpline)
    h = [b - a for a, b in pairwise(t)]
    system, load = mpmath.zeros(size), mpmath.zeros(size)
    for i in range(size):
        if not cyclic and i in (0, size - 1):
            system[i, i] = 1
            continue
        before, after, j, k = h[i - 1], h[i], (i - 1) % size, (i + 1) % size
        for column, value in ((j, before), (i, 2 * (before + after)), (k, after)):
            system[i, column] += value
        for column, value in ((j, 6 / before), (i, -6 / before - 6 / after), (k, 6 / after)):
            load[i, column] += value
    inner = system**-1 * load
    out = mpmath.zeros(len(t), size)
    for i in range(len(t)):
        for j in range(size):
            out[i, j] = inner[i % size, j]
    return out


def exact_moments(spline: NaturalSpline | CyclicSpline) -> tuple[Array, Array]:
    """Return Gram and bending energy in 50 digits: Simpson's rule is exact for S''², 5 Gauss points for S²."""
    second = exact_second(spline)
    t = [mpmath.mpf(float(x)) for x in spline.knots]
    size = spline.size
    gauss = [(mpmath.mpf(x), w) for x, w in mpmath_legendre()]
    gram, energy = mpmath.zeros(size), mpmath.zeros(size)
    for i in range(len(t) - 1):
        h = t[i + 1] - t[i]
        for x, w in gauss:
            b = (x + 1) / 2
            a = 1 - b
            row = mpmath.zeros(1, size)
            for j in range(size):
                bend = (a**3 - a) * second[i, j] + (b**3 - b) * second[i + 1, j]
                row[j] = a * (j == i % size) + b * (j == (i + 1) % size) + h**2 / 6 * bend
            curve = a * second[i, :] + b * second[i + 1, :]
            gram += row.T * row * (w * h / 2)
            energy += curve.T * curve * (w * h / 2)
    return np.array(gram.tolist(), dtype=float), np.array(energy.tolist(), dtype=float)


def mpmath_legendre() -> list[tuple[Any, Any]]:
    """Return the five Gauss-Legendre points and weights in the working precision."""
    points = []
    root = 2 * mpmath.sqrt(mpmath.mpf(10) / 7)
    for x2, w in ((5 - root, 322 + 13 * mpmath.sqrt(70)), (5 + root, 322 - 13 * mpmath.sqrt(70))):
        x = mpmath.sqrt(x2) / 3
        points += [(x, w / 900), (-x, w / 900)]
    return [*points, (mpmath.mpf(0), mpmath.mpf(128) / 225)]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kind", [NaturalSpline, CyclicSpline])
def test_rows_and_moments_agree_with_fifty_digits(kind: type[NaturalSpline | CyclicSpline], seed: int) -> None:
    with mpmath.workdps(50):
        spline = kind(uneven_knots(9, seed))
        second = np.array(exact_second(spline).tolist(), dtype=float)
        gram, energy = exact_moments(spline)
    assert relative(spline.second, second) < 1e-13
    for found, expected in ((spline.gram(), gram), (bending(spline), energy)):
        scale = np.sqrt(np.diag(expected))
        np.testing.assert_allclose(found / np.outer(scale, scale), expected / np.outer(scale, scale), atol=1e-12)


def test_natural_spline_agrees_with_the_published_example() -> None:
    """1/(1 + x²) on six knots: Young & Gregory, A Survey of Numerical Mathematics, vol. 1, 6.8 (numbers as in GSL)."""
    case = json.loads((GOLDEN / "spline_natural_6knots.json").read_text(encoding="utf-8"))
    spline = NaturalSpline(case["knots_t"])
    values, tolerance = np.array(case["knots_a"]), case["tolerance_abs"]
    np.testing.assert_allclose(spline.rows(case["t"]) @ values, case["S"], atol=tolerance)
    np.testing.assert_allclose(spline.rows(case["t"], 1) @ values, case["dS"], atol=tolerance)
    integral = [np.append(np.array(case["knots_t"])[np.array(case["knots_t"]) < t], t) for t in case["t"][1:]]
    found = [weight @ (spline.rows(node) @ values) for node, weight in (quadrature(NaturalSpline(k)) for k in integral)]
    np.testing.assert_allclose(found, case["integral_from_first_t"][1:], atol=tolerance)


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


def test_third_derivative_is_that_of_the_interval_on_the_right() -> None:
    spline = NaturalSpline(np.array([0.0, 1.0, 2.5, 4.0]))
    np.testing.assert_array_equal(spline.rows([1.0, 2.5, 4.0], 3), spline.rows([1.2, 3.0, 3.9], 3))


def test_turns_count_modulo_the_turn() -> None:
    spline = CyclicSpline(np.array([0.0, 0.25, 0.75, 1.0]))
    t = np.array([0.0, 0.1, 0.25, 0.6, 0.875])
    for order in ORDERS:
        for turns in (-3, 1, 2):
            np.testing.assert_allclose(spline.rows(t + turns, order), spline.rows(t, order), atol=1e-11)
    np.testing.assert_array_equal(spline.rows(1.0, 3), spline.rows(0.0, 3))
    np.testing.assert_allclose(spline.rows(-1e-300), spline.rows(0.0), atol=1e-15)


def test_cyclic_spline_of_two_values() -> None:
    """The smallest cyclic spline: between its two values it is the cubic step 3 s² - 2 s³."""
    s = np.linspace(0, 0.999, 7)
    np.testing.assert_allclose(
        CyclicSpline(np.array([0.0, 1.0, 2.0])).rows(s) @ [0.0, 1.0], 3 * s**2 - 2 * s**3, atol=1e-15
    )


def test_constant_is_one_everywhere() -> None:
    constant = Constant(-1.0, 3.0)
    np.testing.assert_array_equal(constant.rows([-9.0, 0.0, 8.0]), np.ones((3, 1)))
    for order in (1, 2, 3):
        assert not constant.rows([0.0], order).any()
    np.testing.assert_allclose(constant.gram(), [[4.0]], rtol=1e-15)


@pytest.mark.parametrize(
    "spline",
    [NaturalSpline(np.array([0, 1, 5])), CyclicSpline(np.array([0, 2, 3, 7])), Constant(2.0, 5.0)],
    ids=["natural", "cyclic", "1"],
)
def test_quadrature_is_exact_to_degree_nine_per_interval(spline: Spline) -> None:
    node, weight = quadrature(spline)
    knots = spline.knots
    np.testing.assert_allclose(weight.sum(), knots[-1] - knots[0], rtol=1e-14)
    degree = 1 if isinstance(spline, Constant) else 9
    np.testing.assert_allclose(
        weight @ node**degree, (knots[-1] ** (degree + 1) - knots[0] ** (degree + 1)) / (degree + 1), rtol=1e-13
    )


def test_nothing_can_be_changed() -> None:
    own = np.array([0.0, 1.0, 2.0])
    spline = NaturalSpline(own)
    own[1] = 1.5
    assert spline.knots[1] == 1.0
    for array in (spline.knots, spline.second):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        spline.knots = own  # type: ignore[misc]


@pytest.mark.parametrize("kind", [NaturalSpline, CyclicSpline])
@pytest.mark.parametrize(
    "knots", [[], [0.0], [[0.0, 1.0, 2.0]], [0.0, 1.0, 1.0], [0.0, 2.0, 1.0], [0.0, np.nan, 2.0], [0.0, 1.0, np.inf]]
)
def test_bad_knots_are_refused(kind: type[NaturalSpline | CyclicSpline], knots: list[float]) -> None:
    with pytest.raises(InputError):
        kind(np.array(knots))


def test_knots_too_few_or_too_close_are_refused() -> None:
    with pytest.raises(InputError, match="at least 3"):
        CyclicSpline(np.array([0.0, 1.0]))
    with pytest.raises(InputError, match="overflows"):
        NaturalSpline(np.array([0.0, 1e-200, 2e-200]))
    with pytest.raises(InputError, match="Give 2 or more"):
        even_knots(0.0, 1.0, 1)
    with pytest.raises(InputError):
        Constant(1.0, 1.0)


@pytest.mark.parametrize("spline", [NaturalSpline(np.arange(3.0)), CyclicSpline(np.arange(3.0)), Constant()])
def test_bad_positions_are_refused(spline: Spline) -> None:
    for t in (np.nan, np.inf, [[0.0, 1.0]]):
        with pytest.raises(InputError):
            spline.rows(t)
    for order in (-1, 4):
        with pytest.raises(InputError):
            spline.rows(0.0, order)


def test_the_widest_spacing_of_a_sine() -> None:
    """A sine of amplitude A and wavelength λ: band 2 A, curvature A (2π/λ)² → 0.5513 λ (B&H eq. 15)."""
    amplitude, wavelength = 3e-6, 0.04
    limit = spacing_limit(2 * amplitude, amplitude * (2 * np.pi / wavelength) ** 2)
    assert limit / wavelength == pytest.approx(np.sqrt(12) / (2 * np.pi))
    for width, curvature in ((0.0, 1.0), (1.0, 0.0), (-1.0, 1.0), (np.nan, 1.0), (1.0, np.inf)):
        with pytest.raises(InputError):
            spacing_limit(width, curvature)
