"""The search along a line: the paper's sequence, needles, flat ratios, ends; its nodes against numpy's series."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import chebyshev

from axiscal.numerics import Array
from axiscal.numerics.cubic import NaturalSpline, even_knots
from axiscal.numerics.line import largest_along, node_count, nodes
from tests.generators.forms import gain_forms


@pytest.mark.parametrize("count", [1, 2, 7, 17, 40])
def test_nodes_are_the_roots_of_a_chebyshev_polynomial(count: int) -> None:
    assert (np.diff(nodes(count)) > 0).all()
    np.testing.assert_allclose(chebyshev.chebval(nodes(count), [0.0] * count + [1.0]), 0.0, atol=1e-13)


@pytest.mark.parametrize(("degree", "phase"), [(0, 0.5), (3, 1.0), (6, 2.0), (6, 12.0)])
def test_node_count_holds_sines_to_rounding(degree: int, phase: float) -> None:
    count = node_count(degree, phase)
    x = np.linspace(-1, 1, 500)

    def wave(at: Array) -> Array:
        return np.asarray(at**degree * np.cos(phase / 2 * at + 0.3))

    def followed(count: int) -> Array:
        return np.asarray(chebyshev.chebval(x, chebyshev.chebfit(nodes(count), wave(nodes(count)), count - 1)))

    np.testing.assert_allclose(followed(count), wave(x), atol=1e-14)
    assert np.abs(followed(count // 2) - wave(x)).max() > 1e-12
    assert node_count(degree) == degree + 1


SEQUENCE = [6.86244, 5.29228, 3.73376, 2.21355, 1.07741, 0.62000, 0.19634, 0.09769, 0.07641, 0.06404]
"""J after each reading: one natural spline, 7 knots on 0 … 10, C₀ = I, σ² = 0.01; computed independently."""


def test_ten_readings_reduce_the_criterion_as_published() -> None:
    spline, covariance = NaturalSpline(even_knots(0, 10, 7)), np.eye(7)
    gram, root = spline.gram(), np.linalg.cholesky(spline.gram()).T
    for expected in SEQUENCE:
        factor: Array = np.asarray(np.linalg.cholesky(covariance), dtype=np.float64)

        def forms(places: Array, factor: Array = factor) -> tuple[Array, Array]:
            return gain_forms(spline.rows(places[:, 0]), factor, root @ factor, 0.01)

        before = float(np.trace(gram @ covariance))
        place, gain = largest_along(forms, np.column_stack([spline.knots[:-1], spline.knots[1:]]), 7)
        row = spline.rows(place)[0]
        covariance = covariance - np.outer(covariance @ row, covariance @ row) / (0.01 + row @ covariance @ row)
        covariance = (covariance + covariance.T) / 2
        after = float(np.trace(gram @ covariance))
        assert before - gain == pytest.approx(after, rel=1e-10)
        assert after == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize("width", [1e-1, 1e-3, 1e-6, 1e-9])
def test_a_needle_of_a_peak_is_found(width: float) -> None:
    """1/(1 + ((t − a)/w)²): the denominator spans up to eighteen decades; halving makes it tame."""

    def forms(places: Array) -> tuple[Array, Array]:
        return np.ones(len(places)), 1 + ((places[:, 0] - 0.3456) / width) ** 2

    place, ratio = largest_along(forms, np.array([[0.0, 1.0]]), 3)
    assert abs(place - 0.3456) <= 1e-6 * width + 1e-16
    assert ratio == pytest.approx(1.0, rel=1e-12)


def test_the_ratio_is_that_at_its_place_between_the_breaks() -> None:
    def forms(places: Array) -> tuple[Array, Array]:
        return 1 + places[:, 0], 1 + places[:, 0] ** 2

    place, ratio = largest_along(forms, np.array([[-3.0, -1.0], [-1.0, 3.0]]), 3)
    assert place == pytest.approx(np.sqrt(2) - 1, abs=1e-7)
    assert ratio == (1 + place) / (1 + place**2)
    assert largest_along(forms, np.array([[1.0, 2.0], [2.0, 3.0]]), 3)[0] == 1.0


def test_a_flat_ratio() -> None:
    def forms(places: Array) -> tuple[Array, Array]:
        return 2 * (1 + places[:, 0] ** 2), 1 + places[:, 0] ** 2

    assert largest_along(forms, np.array([[0.0, 1.0], [1.0, 2.0]]), 3)[1] == pytest.approx(2.0, rel=1e-15)
