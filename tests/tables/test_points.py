"""Where the points of a table are: against what is asked of them, said again in exact fractions."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.machine import machine_from_text
from axiscal.numerics import Array
from axiscal.tables.sampling import SAMPLES, closest, points
from axiscal_core.machine import Machine
from tests.generators.texts import machine_text


def model(start: int, stop: int, knots: int = 4) -> Machine:
    """Return the errors of a linear axis from and to so many mm."""
    return machine_from_text(f"""
chain = "w-b-X-t"
[axes.X]
travel = ["{start} mm", "{stop} mm"]
[errors]
EXX = {{ std = "10 um", length = "{stop - start} mm", knots = {knots} }}
EYX = {{ std = "10 um", length = "{stop - start} mm", knots = 3 }}
""")  # fmt: skip


@given(st.integers(-500, 500), st.integers(20, 900), st.integers(1, 40), st.integers(2, 140))
def test_points_on_multiples_cover_the_travel_with_as_few_steps_as_fit(
    start: int, length: int, multiple: int, most: int
) -> None:
    stop = start + length
    at = points(model(start, stop), 0, most=most, multiple=multiple * 1e-3)
    steps = np.diff(at) * 1e3
    exact = [Fraction(round(float(x) * 1e6), 1000) for x in at]
    assert all(x % multiple == 0 for x in exact)
    assert steps == pytest.approx(steps[0])
    assert exact[0] <= start < exact[0] + multiple
    assert exact[-1] >= stop
    assert len(exact) < 3 or exact[-2] < stop
    step, limit = round(float(steps[0])), max(min(12, most - 1), 1)
    assert step * limit >= stop - exact[0]
    assert (step - multiple) * limit < stop - exact[0]


TURN = machine_text("w-C'-b-t", {"C": (0, 360)}, {"EXC": 'std = "10 um", knots = 12'})


@pytest.mark.parametrize(
    ("multiple", "most", "step"), [(10, 129, 10), (10, 20, 20), (10, 13, 30), (7.2, 129, 14.4), (180, 129, 180)]
)
def test_points_of_a_whole_turn_are_multiples_that_divide_it(multiple: float, most: int, step: float) -> None:
    """The finest of 48 intervals and fewer that fit."""
    axis = machine_from_text(TURN)
    assert axis.axes[0].cyclic
    at = np.degrees(points(axis, 0, most=most, multiple=float(np.radians(multiple))))
    assert at == pytest.approx(np.arange(0.0, 360.0 + step / 2, step))


def farthest(curves: Array, at: Array, chosen: Array) -> float:
    """Return how far lines through points of curves are from them."""
    return max(float(np.max(np.abs(c - np.interp(at, chosen, np.interp(chosen, at, c))))) for c in curves)


@given(st.integers(0, 10_000), st.integers(2, 14), st.integers(0, 4))
def test_points_anywhere_are_no_more_keep_both_ends_and_are_never_farther(seed: int, count: int, inner: int) -> None:
    rng, at = np.random.default_rng(seed), np.linspace(-0.1, 0.4, SAMPLES)
    kinks = np.sort(rng.uniform(-0.1, 0.4, inner))
    curves = 1e-5 * np.stack([np.abs(at - k) for k in (*kinks, 0.1)]).sum(axis=0) * np.array([[1.0], [-0.5]])
    curves = curves + 1e-6 * np.sin(9 * at)
    even = np.linspace(-0.1, 0.4, count)
    found = closest(curves, at, np.r_[kinks, kinks + 1e-12, -0.1, 0.4 - 1e-9], even)
    assert len(found) <= count
    assert (found[0], found[-1]) == (-0.1, 0.4)
    assert np.all(np.diff(found) > 1e-6)
    assert farthest(curves, at, found) <= farthest(curves, at, even) + 1e-18


def test_a_curve_of_lines_needs_no_more_points_than_its_kinks() -> None:
    at, knots = np.linspace(0.0, 1.0, SAMPLES), np.array([0.25, 0.5])
    curves = 1e-5 * (np.abs(at - 0.25) - np.abs(at - 0.5))[None]
    found = closest(curves, at, knots, np.linspace(0.0, 1.0, 8))
    assert found.tolist() == [0.0, 0.25, 0.5, 1.0]
    assert len(at) == 1025
    straight = closest(1e-5 * at[None], at, np.zeros(0), np.linspace(0.0, 1.0, 8))
    assert farthest(1e-5 * at[None], at, straight) < 1e-20
