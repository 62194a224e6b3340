"""What a cubic spline must be, whatever its knots."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.numerics import Array
from axiscal.numerics.cubic import CyclicSpline, NaturalSpline, even_knots, quadrature
from tests.generators.splines import bending

Kind = type[NaturalSpline | CyclicSpline]
kinds: st.SearchStrategy[Kind] = st.sampled_from([NaturalSpline, CyclicSpline])


@st.composite
def uneven(draw: st.DrawFn) -> Array:
    """Draw 3 to 12 knots with spacings up to 1e4 : 1, anywhere, in any unit."""
    spacings = draw(st.lists(st.floats(-4, 0), min_size=2, max_size=11))
    scale, start = 10.0 ** draw(st.floats(-3, 3)), draw(st.floats(-2, 2))
    knots: Array = scale * (start + np.cumsum(np.r_[0.0, 10.0 ** np.array(spacings)]))
    return knots


def inner(knots: Array, count: int = 5) -> Array:
    """Return positions inside every interval and at every knot but the last."""
    s = np.linspace(0, 1, count, endpoint=False)
    return (knots[:-1, None] + np.diff(knots)[:, None] * s).ravel()


@given(kinds, uneven())
def test_interpolates_its_control_values(kind: Kind, knots: Array) -> None:
    spline = kind(knots)
    np.testing.assert_array_equal(spline.rows(knots[: spline.size]), np.eye(spline.size))


@given(kinds, uneven(), st.integers(0, 2**32 - 1))
def test_linear_in_the_control_values(kind: Kind, knots: Array, seed: int) -> None:
    """The spline through a + λ b, solved on its own, is that of a plus λ times that of b."""
    spline = kind(knots)
    a, b = np.random.default_rng(seed).normal(size=(2, spline.size))
    rows = spline.rows(inner(knots))
    size = np.abs(rows).max()
    np.testing.assert_allclose(rows @ (a + 3 * b), rows @ a + 3 * (rows @ b), atol=1e-13 * size * spline.size)


@given(kinds, uneven())
def test_constants_are_followed_exactly(kind: Kind, knots: Array) -> None:
    rows = kind(knots).rows(inner(knots))
    np.testing.assert_allclose(rows.sum(axis=1), 1.0, atol=1e-12 * np.abs(rows).max())


@given(uneven())
def test_natural_spline_follows_straight_lines_everywhere(knots: Array) -> None:
    spline, length = NaturalSpline(knots), knots[-1] - knots[0]
    line = (knots - knots[0]) / length
    t = np.concatenate([inner(knots), knots[0] - [length, length / 9], knots[-1] + [0.0, length]])
    rows, slopes = spline.rows(t), spline.rows(t, 1)
    np.testing.assert_allclose(rows @ line, (t - knots[0]) / length, atol=1e-12 * np.abs(rows).max())
    np.testing.assert_allclose(slopes @ line, 1 / length, atol=1e-12 * np.abs(slopes).max())


@given(kinds, uneven(), st.integers(0, 2))
def test_value_slope_and_curvature_are_continuous_at_knots(kind: Kind, knots: Array, order: int) -> None:
    """The interval on the left, extended by its own power series, meets the interval on the right."""
    spline, h = kind(knots), np.diff(knots)[:-1, None]
    left = [spline.rows(knots[:-2], d) for d in range(4)]
    taylor = [
        left[0] + h * (left[1] + h / 2 * (left[2] + h / 3 * left[3])),
        left[1] + h * (left[2] + h / 2 * left[3]),
        left[2] + h * left[3],
    ]
    right = spline.rows(knots[1:-1], order)
    scale = (np.abs(left[0]) + np.abs(h * left[1]) + np.abs(h**2 * left[2]) + np.abs(h**3 * left[3])) / h**order
    assert (np.abs(taylor[order] - right) <= 1e-12 * (scale + np.abs(right)).max(axis=1, keepdims=True)).all()


@given(uneven(), st.integers(0, 2))
def test_cyclic_seam_is_no_seam(knots: Array, order: int) -> None:
    spline = CyclicSpline(knots)
    before = np.nextafter(knots[-1], knots[0])
    first, last = spline.rows(knots[0], order), spline.rows(before, order)
    steepest = np.abs(spline.rows(before, order + 1)).max() * (knots[-1] - before)
    assert np.abs(first - last).max() <= 2 * steepest + 1e-12 * np.abs(first).max()


@given(uneven(), st.integers(1, 11))
def test_cyclic_spline_does_not_care_where_the_turn_begins(knots: Array, shift: int) -> None:
    spline, size = CyclicSpline(knots), len(knots) - 1
    first, turn = shift % size, knots[-1] - knots[0]
    turned = CyclicSpline(np.r_[knots[first:-1], knots[: first + 1] + turn])
    t = inner(knots)
    rows = spline.rows(t)
    np.testing.assert_allclose(np.roll(turned.rows(t), first, axis=1), rows, atol=1e-8 * np.abs(rows).max())


@given(kinds, uneven())
def test_the_gram_equals_its_quadrature(kind: Kind, knots: Array) -> None:
    spline = kind(knots)
    node, weight = quadrature(spline)
    rows, gram = spline.rows(node), spline.gram()
    twin = rows.T @ (weight[:, None] * rows)
    scale = np.sqrt(np.diag(twin))
    np.testing.assert_allclose(gram, twin, atol=1e-11 * float(scale.max()) ** 2)
    assert (np.abs(gram - twin) <= 1e-7 * np.outer(scale, scale)).all()


@given(kinds, uneven())
def test_the_gram_is_symmetric_and_positive(kind: Kind, knots: Array) -> None:
    spline = kind(knots)
    gram = spline.gram()
    np.testing.assert_array_equal(gram, gram.T)
    assert np.linalg.eigvalsh(gram).min() >= -1e-14 * spline.size * np.abs(gram).max()


@given(uneven())
def test_straight_lines_do_not_bend(knots: Array) -> None:
    energy = bending(NaturalSpline(knots))
    for line in (np.ones_like(knots), (knots - knots[0]) / (knots[-1] - knots[0])):
        np.testing.assert_allclose(energy @ line, 0.0, atol=1e-12 * np.abs(energy).max())


@given(uneven(), st.integers(0, 2**32 - 1))
def test_natural_spline_bends_least(knots: Array, seed: int) -> None:
    """B&H eq. 12: a natural spline on more knots through the same points bends at least as much."""
    rng = np.random.default_rng(seed)
    coarse, fine = NaturalSpline(knots), NaturalSpline(np.sort(np.r_[knots, (knots[1:] + knots[:-1]) / 2]))
    a = rng.normal(size=coarse.size)
    followed = coarse.rows(fine.knots) @ a
    other = followed.copy()
    other[1::2] += rng.normal(size=len(knots) - 1) * np.abs(followed).max()
    least = a @ bending(coarse) @ a
    assert followed @ bending(fine) @ followed == pytest.approx(least, rel=1e-6)
    assert other @ bending(fine) @ other >= least * (1 - 1e-9)


def worst_error(spline: NaturalSpline | CyclicSpline, where: Array) -> float:
    """Return the largest error of the spline through a smooth periodic function."""
    values = np.exp(np.sin(2 * np.pi * spline.knots[: spline.size]))
    return float(np.abs(spline.rows(where) @ values - np.exp(np.sin(2 * np.pi * where))).max())


def test_cyclic_spline_converges_with_order_four() -> None:
    t = np.linspace(0, 1, 4001)
    errors = [worst_error(CyclicSpline(even_knots(0, 1, n + 1)), t) for n in (32, 64, 128)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert ((orders > 3.8) & (orders < 4.3)).all()


def test_natural_spline_converges_with_order_four_inside_and_two_at_its_ends() -> None:
    inside, ends = np.linspace(0.35, 0.65, 2001), np.linspace(0, 0.02, 2001)
    splines = [NaturalSpline(even_knots(0, 1, n + 1)) for n in (64, 128, 256)]
    for where, low, high in ((inside, 3.7, 4.4), (ends, 1.8, 2.2)):
        errors = np.array([worst_error(spline, where) for spline in splines])
        orders = np.log2(errors[:-1] / errors[1:])
        assert ((orders > low) & (orders < high)).all(), orders
