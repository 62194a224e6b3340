"""What repeats, steps or tilts, against sines, quadrature and the cyclic spline of one period."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import quad

from axiscal.numerics import Array
from axiscal_core.splines import Repeated, Segments


@pytest.mark.parametrize("waves", [1, 2, 4])
def test_eight_values_a_wave_follow_a_sine_within_a_thousandth_or_so(waves: int) -> None:
    spline, at = Repeated(-0.1, 0.5, 0.05, 8 * waves), np.linspace(-0.1, 0.5, 1001)
    control = np.cos(2 * np.pi * waves * spline.control_positions / 0.05 + 0.3)
    assert spline.rows(at) @ control == pytest.approx(np.cos(2 * np.pi * waves * at / 0.05 + 0.3), abs=1.2e-3)


@pytest.mark.parametrize("spline", [Repeated(0.0, 0.23, 0.05, 16), Segments(0.0, 1.0, (0.3, 0.7), 0.05)])
def test_rows_sum_to_one_and_their_integrals_are_those_of_quadrature(spline: Repeated | Segments) -> None:
    at = np.linspace(0, spline.knots[-1], 300)
    assert spline.rows(at).sum(axis=1) == pytest.approx(np.ones(300), abs=1e-12)
    for i, j in ((0, 0), (0, 1), (1, 2)):
        integral = quad(_product(spline, i, j), 0, spline.knots[-1], points=spline.knots[1:-1], limit=300)[0]
        assert spline.gram()[i, j] == pytest.approx(integral, abs=1e-10)


def _product(spline: Repeated | Segments, i: int, j: int) -> Callable[[float], float]:
    def product(t: float) -> float:
        row: Array = spline.rows(t)[0]
        return float(row[i] * row[j])

    return product


def test_between_breaks_a_derivative_is_that_of_the_value() -> None:
    for spline in (Repeated(0.0, 0.23, 0.05, 8), Segments(0.0, 1.0, (0.3, 0.7), 0.05)):
        middle = (spline.knots[1:] + spline.knots[:-1]) / 2
        slope = (spline.rows(middle + 1e-7) - spline.rows(middle - 1e-7)) / 2e-7
        assert spline.rows(middle, 1) == pytest.approx(slope, rel=1e-5, abs=1e-4)
