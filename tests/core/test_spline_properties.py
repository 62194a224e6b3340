"""What a cubic spline must be, whatever its knots."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from axiscal.numerics import Array
from axiscal_core.splines import CyclicSpline, NaturalSpline

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


@given(uneven(), st.integers(1, 11))
def test_cyclic_spline_does_not_care_where_the_turn_begins(knots: Array, shift: int) -> None:
    spline, size = CyclicSpline(knots), len(knots) - 1
    first, turn = shift % size, knots[-1] - knots[0]
    turned = CyclicSpline(np.r_[knots[first:-1], knots[: first + 1] + turn])
    t = inner(knots)
    rows = spline.rows(t)
    np.testing.assert_allclose(np.roll(turned.rows(t), first, axis=1), rows, atol=1e-8 * np.abs(rows).max())
