"""Sums of waves and polynomials from samples: against numpy's own polynomials and mpmath's derivatives."""

from __future__ import annotations

from collections.abc import Callable

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.numerics import Array
from axiscal.numerics.waves import Span, Waves

TURN = Span(-np.pi, np.pi, True)
STRETCH = Span(-0.3, 0.9, False)


def test_eight_harmonics_and_a_polynomial_of_the_eighth_degree_are_found_whole() -> None:
    amplitude, power = np.arange(1.0, 9), np.polynomial.Polynomial(np.linspace(-2, 3, 9))
    turned = Waves.of(lambda at: np.sum(amplitude * np.cos(np.arange(1, 9) * at + 0.3), axis=1)[None], [TURN])
    straight = Waves.of(lambda at: power(at[:, 0])[None], [STRETCH])
    angles, places = np.linspace(-4, 4, 101)[:, None], np.linspace(-0.3, 0.9, 101)[:, None]
    expected = np.sum(amplitude * np.cos(np.arange(1, 9) * angles + 0.3), axis=1)
    assert turned.at(angles)[0] == pytest.approx(expected, abs=1e-12)
    assert straight.at(places)[0] == pytest.approx(power(places[:, 0]), abs=1e-12)
    for order in (1, 2, 3):
        slope = power.deriv(order)(places[:, 0])
        assert straight.at(places, *[0] * order)[0] == pytest.approx(slope, rel=1e-9, abs=1e-9 * np.abs(slope).max())


def test_one_wave_more_than_are_held_is_not_found() -> None:
    ninth = Waves.of(lambda at: np.cos(9 * at).T, [TURN])
    assert np.abs(ninth.at(np.array([[0.2]])) - np.cos(1.8)).max() > 0.1


@given(
    at=st.tuples(st.floats(-3, 3), st.floats(-0.3, 0.9)),
    along=st.sampled_from([(), (0,), (1,), (0, 1), (0, 0), (1, 1, 1), (0, 1, 1)]),
)
def test_derivatives_of_two_coordinates_are_those_of_mpmath(at: tuple[float, float], along: tuple[int, ...]) -> None:
    def value(turn: mpmath.mpf, way: mpmath.mpf) -> mpmath.mpf:
        return mpmath.cos(3 * turn - 0.4) * (way**4 - 2 * way) + mpmath.sin(turn) * way**2

    found = Waves.of(_rows(value), [TURN, STRETCH])
    orders = (along.count(0), along.count(1))
    expected = float(mpmath.diff(value, at, orders)) if along else float(value(*map(mpmath.mpf, at)))
    assert found.at(np.array([at]), *along)[0, 0] == pytest.approx(expected, rel=1e-7, abs=1e-7)


@pytest.mark.parametrize("along", [(), (0,), (1,), (0, 0), (1, 1), (0, 1), (1, 1, 1), (0, 0, 0), (0, 1, 1)])
def test_no_derivative_is_larger_than_is_said(along: tuple[int, ...]) -> None:
    dice = np.random.default_rng(1)
    many = Waves((TURN, STRETCH), dice.standard_normal((50, 45)))
    grid = np.meshgrid(np.linspace(-np.pi, np.pi, 61), np.linspace(-0.3, 0.9, 61))
    reached = np.abs(many.at(np.stack([g.ravel() for g in grid], axis=1), *along)).max(axis=1)
    assert np.all(reached <= many.most(*along))


@pytest.mark.parametrize(("span", "most"), [(TURN, 8), (STRETCH, 8)])
@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_each_term_reaches_what_is_said_of_it(span: Span, most: int, order: int) -> None:
    """Markov's bound is reached at the ends of the stretch, a wave's own at its crests: nothing smaller would hold."""
    at = np.linspace(span.low, span.high, 200_001)
    reached = np.abs(span.basis(most, at, order)).max(axis=0)
    assert reached == pytest.approx(span.largest(most, order), rel=1e-6)


def _rows(value: Callable[..., mpmath.mpf]) -> Callable[[Array], Array]:
    """Return a function of one place as one of many places (m, 2) -> (1, m)."""

    def many(places: Array) -> Array:
        return np.array([[float(value(*map(mpmath.mpf, place))) for place in places]])

    return many
