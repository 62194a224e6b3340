"""Chebyshev series against numpy's, and the largest ratio against a lattice, a closed form, and hostile cases."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import chebyshev as twin

from axiscal.exceptions import ShapeError
from axiscal.numerics import Array
from axiscal.numerics.chebyshev import coefficients, maximise_ratio, node_count, nodes, resampled, roots


def sampled(*functions: np.polynomial.Polynomial, count: int) -> Array:
    """Return the values of polynomials at the nodes, one in a row."""
    return np.stack([f(nodes(count)) for f in functions])


def polynomial(*roots_at: float) -> np.polynomial.Polynomial:
    """Return the monic polynomial with these roots."""
    return np.polynomial.Polynomial.fromroots(roots_at)


@pytest.mark.parametrize("count", [1, 2, 7, 17, 40])
def test_nodes_are_the_roots_of_a_chebyshev_polynomial(count: int) -> None:
    assert (np.diff(nodes(count)) > 0).all()
    np.testing.assert_allclose(twin.chebval(nodes(count), [0.0] * count + [1.0]), 0.0, atol=1e-13)


@pytest.mark.parametrize("count", [1, 2, 7, 17, 40])
def test_coefficients_and_values_agree_with_numpy(count: int) -> None:
    rng = np.random.default_rng(count)
    series = rng.normal(size=(5, count))
    values = np.stack([twin.chebval(nodes(count), c) for c in series])
    np.testing.assert_allclose(coefficients(values), series, atol=1e-13)
    np.testing.assert_allclose(resampled(values, 50), twin.chebval(nodes(50), series.T), atol=1e-12)


@pytest.mark.parametrize(("degree", "phase"), [(0, 0.5), (3, 1.0), (6, 2.0), (6, 12.0)])
def test_node_count_holds_sines_to_rounding(degree: int, phase: float) -> None:
    count = node_count(degree, phase)
    x = np.linspace(-1, 1, 500)

    def wave(at: Array) -> Array:
        return np.asarray(at**degree * np.cos(phase / 2 * at + 0.3))

    found = twin.chebval(x, coefficients(wave(nodes(count))[None])[0])
    np.testing.assert_allclose(found, wave(x), atol=5e-15)
    coarse = twin.chebval(x, coefficients(wave(nodes(count // 2))[None])[0])
    assert np.abs(coarse - wave(x)).max() > 1e-12
    assert node_count(degree) == degree + 1


@pytest.mark.parametrize("lead", [0.0, 1e-300, 1e-17, 1e-15, 1e-12, 1e-6, 1.0])
@pytest.mark.parametrize("degree", [1, 2, 5, 10, 30])
def test_roots_survive_leading_coefficients_of_any_size(degree: int, lead: float) -> None:
    rng = np.random.default_rng(degree)
    true = np.sort(rng.uniform(-1, 1, (20, min(degree, 5))), axis=1)
    series = np.zeros((20, degree + 1))
    for row, at in zip(series, true, strict=True):
        row[: len(at) + 1] = twin.chebfromroots(at)
        row[len(at) + 1 :] = lead * np.abs(row).max() * rng.normal(size=degree - len(at))
    found = roots(series)
    assert found.shape == (20, degree)
    for row, at in zip(series, found, strict=True):
        expected = twin.chebroots(np.trim_zeros(np.where(np.abs(row) < 1e-20, 0.0, row), "b"))
        for root in expected[(np.abs(expected.imag) < 1e-9) & (np.abs(expected.real) <= 1)]:
            nearest = at[np.abs(at - root).argmin()]
            assert abs(twin.chebval(nearest, row)) < 1e-12 * np.abs(row).sum()


def test_roots_of_nothing() -> None:
    assert roots(np.ones((3, 1))).shape == (3, 0)
    assert np.isfinite(roots(np.zeros((2, 6)))).all()
    with pytest.raises(ShapeError):
        roots(np.array([[1.0, np.nan, 2.0]]))


def test_largest_ratio_of_a_closed_form() -> None:
    """(1 + x)/(1 + (x - a)²/b²) is largest where (x + 1)² = (1 + a)² + b²."""
    a, b = np.array([-0.5, 0.2, 0.7]), np.array([0.3, 0.5, 1e-3])
    x = nodes(3)
    position, value = maximise_ratio(np.tile(1 + x, (3, 1)), 1 + ((x - a[:, None]) / b[:, None]) ** 2)
    expected = np.hypot(1 + a, b) - 1
    np.testing.assert_allclose(position, expected, atol=1e-9)
    np.testing.assert_allclose(value, (1 + expected) / (1 + ((expected - a) / b) ** 2), rtol=1e-10)


@pytest.mark.parametrize(("p", "q"), [(6, 6), (6, 4), (3, 8), (1, 6), (0, 6), (6, 0), (1, 0), (0, 1), (0, 0), (16, 16)])
def test_no_lattice_point_beats_the_largest_ratio(p: int, q: int) -> None:
    rng = np.random.default_rng(p + 100 * q)
    above, below = rng.normal(size=(40, p + 1)), rng.normal(size=(40, q + 1))
    x = np.linspace(-1, 1, 20001)
    lattice = twin.chebval(x, below.T)
    below[:, 0] += 0.05 * np.ptp(lattice, axis=1) - np.minimum(lattice.min(axis=1), 0) + 0.01
    ratio = twin.chebval(x, above.T) / twin.chebval(x, below.T)
    forms = [np.array(twin.chebval(nodes(len(c)), c), dtype=np.float64) for c in (above.T, below.T)]
    position, value = maximise_ratio(*forms)
    scale = np.abs(ratio).max(axis=1)
    assert (np.abs(position) <= 1).all()
    assert (value >= ratio.max(axis=1) - 1e-12 * scale).all()
    claimed = [twin.chebval(at, a) / twin.chebval(at, b) for at, a, b in zip(position, above, below, strict=True)]
    np.testing.assert_allclose(value, claimed, atol=1e-12 * scale.max())


def test_largest_ratio_does_not_depend_on_scales() -> None:
    rng = np.random.default_rng(0)
    above, below = rng.uniform(0, 1, (8, 7)), rng.uniform(1, 2, (8, 7))
    position, value = maximise_ratio(above, below)
    scale = 10.0 ** rng.uniform(-200, 90, (8, 1)), 10.0 ** rng.uniform(-90, 90, (8, 1))
    other_position, other_value = maximise_ratio(above * scale[0], below * scale[1])
    np.testing.assert_allclose(other_position, position, atol=1e-7)
    np.testing.assert_allclose(other_value, value * (scale[0] / scale[1])[:, 0], rtol=1e-12)


def test_ends_flats_and_double_roots() -> None:
    """Rising, falling, constant, zero, an even pair of peaks, and a saddle, in one batch."""
    one, x = np.polynomial.Polynomial([1.0]), np.polynomial.Polynomial([0.0, 1.0])
    above = sampled(2 + x, 2 - x, 3 * one, 0 * one, 2 - polynomial(0.5, 0.5, -0.5, -0.5), 1 + x**3, count=7)
    position, value = maximise_ratio(above, np.ones((6, 7)))
    assert position[0] == 1
    assert position[1] == -1
    np.testing.assert_allclose(np.abs(position[4]), 0.5, atol=1e-7)
    assert position[5] == 1
    np.testing.assert_allclose(value, [3, 3, 3, 0, 2, 2], rtol=1e-14)


def test_what_has_no_largest_ratio_is_refused() -> None:
    fine = np.ones((1, 3))
    for above, below in ((np.full((1, 3), np.nan), fine), (fine, np.array([[1.0, 0.0, 1.0]])), (fine, -fine)):
        with pytest.raises(ShapeError):
            maximise_ratio(above, below)
