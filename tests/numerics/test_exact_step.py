"""The search along lines: the paper's sequence, hostile functions, groups, and proofs that nothing is left out."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from axiscal.exceptions import ShapeError
from axiscal.numerics import Array
from axiscal.numerics.chebyshev import node_count
from axiscal.numerics.cubic import NaturalSpline, even_knots
from axiscal.numerics.exact_step import Forms, gain_forms, maximise_along

SEQUENCE = [6.86244, 5.29228, 3.73376, 2.21355, 1.07741, 0.62000, 0.19634, 0.09769, 0.07641, 0.06404]
"""J after each reading: one natural spline, 7 knots on 0 … 10, C₀ = I, σ² = 0.01; computed independently."""


def counted(above: Callable[[Array], Array], below: Callable[[Array], Array]) -> tuple[Forms, list[int]]:
    """Return the forms of two functions of the position alone, and a list that counts their evaluations."""
    calls = [0]

    def forms(t: Array, owner: NDArray[np.intp]) -> tuple[Array, Array]:
        assert t.shape[0] == len(owner)
        calls[0] += t.size
        return above(t), below(t)

    return forms, calls


def spline_forms(spline: NaturalSpline, factor: Array, variance: float) -> Forms:
    """Return the forms of one joint under the paper's criterion."""
    weighted = np.linalg.cholesky(spline.gram()).T @ factor

    def forms(t: Array, owner: NDArray[np.intp]) -> tuple[Array, Array]:
        n, d = gain_forms(spline.rows(t.ravel()), factor, weighted, variance)
        return n.reshape(t.shape), d.reshape(t.shape)

    return forms


def test_ten_readings_reduce_the_criterion_as_published() -> None:
    spline = NaturalSpline(even_knots(0, 10, 7))
    covariance: Array = np.eye(7)
    gram = spline.gram()
    criterion = [float(np.trace(gram @ covariance))]
    for expected in SEQUENCE:
        forms = spline_forms(spline, np.asarray(np.linalg.cholesky(covariance), dtype=np.float64), 0.01)
        position, gain = maximise_along(forms, spline.knots[:-1], spline.knots[1:], 7)
        row = spline.rows(position[gain.argmax()])[0]
        covariance -= np.outer(covariance @ row, covariance @ row) / (0.01 + row @ covariance @ row)
        covariance = (covariance + covariance.T) / 2
        criterion.append(float(np.trace(gram @ covariance)))
        assert criterion[-2] - gain.max() == pytest.approx(criterion[-1], rel=1e-10)
        assert criterion[-1] == pytest.approx(expected, abs=1e-5)


def test_gain_forms_are_the_quadratic_forms() -> None:
    rng = np.random.default_rng(1)
    factor, root, rows = rng.normal(size=(5, 3)), rng.normal(size=(4, 5)), rng.normal(size=(9, 5))
    above, below = gain_forms(rows, factor, root @ factor, 0.25)
    covariance, weight = factor @ factor.T, root.T @ root
    np.testing.assert_allclose(above, np.diag(rows @ covariance @ weight @ covariance @ rows.T), rtol=1e-12)
    np.testing.assert_allclose(below, 0.25 + np.diag(rows @ covariance @ rows.T), rtol=1e-12)
    variances = np.arange(1.0, 10.0)
    shifted = gain_forms(rows, factor, root @ factor, variances)[1]
    np.testing.assert_allclose(shifted - below, variances - 0.25, atol=1e-12)


@pytest.mark.parametrize("width", [1e-1, 1e-3, 1e-6, 1e-9])
def test_a_needle_of_a_peak_is_found(width: float) -> None:
    """1/(1 + ((t - a)/w)²): the denominator spans up to eighteen decades; halving makes it tame."""
    forms, calls = counted(np.ones_like, lambda t: 1 + ((t - 0.3456) / width) ** 2)
    position, value = maximise_along(forms, np.array([0.0]), np.array([1.0]), 3)
    assert abs(position[0] - 0.3456) <= 1e-6 * width + 1e-16
    assert value[0] == pytest.approx(1.0, rel=1e-12)
    assert calls[0] < 1000


def test_too_few_nodes_are_noticed_and_mended() -> None:
    forms, _ = counted(lambda t: 2 + np.sin(7 * t), lambda t: 2 + np.cos(5 * t))
    left, right = np.arange(4.0), np.arange(1.0, 5.0)
    lattice = np.linspace(0, 4, 400001)
    best = float(((2 + np.sin(7 * lattice)) / (2 + np.cos(5 * lattice))).max())
    for count in (5, node_count(0, 7.0)):
        _, value = maximise_along(forms, left, right, count)
        assert value.max() == pytest.approx(best, rel=1e-9)
        assert value.max() >= best


def test_every_group_gets_its_own_best() -> None:
    """Many lines at once give what each line gives alone, whatever the scale of its neighbours."""
    spline = NaturalSpline(even_knots(0, 1, 6))
    rng = np.random.default_rng(3)
    factors = [10.0 ** rng.uniform(-3, 3) * rng.normal(size=(6, 6)) for _ in range(5)]
    alone = [spline_forms(spline, factor, 0.1) for factor in factors]
    group = np.repeat(np.arange(5), 5)

    def forms(t: Array, owner: NDArray[np.intp]) -> tuple[Array, Array]:
        pairs = [alone[group[k]](t[i : i + 1], owner[i : i + 1]) for i, k in enumerate(owner)]
        return np.concatenate([n for n, _ in pairs]), np.concatenate([d for _, d in pairs])

    position, value = maximise_along(forms, np.tile(spline.knots[:-1], 5), np.tile(spline.knots[1:], 5), 7, group)
    for k, single in enumerate(alone):
        where, gain = maximise_along(single, spline.knots[:-1], spline.knots[1:], 7)
        mine = value[group == k]
        assert mine.max() == pytest.approx(gain.max(), rel=1e-12)
        assert position[group == k][mine.argmax()] == pytest.approx(where[gain.argmax()], abs=1e-6)


def test_values_are_those_at_the_positions() -> None:
    forms, _ = counted(lambda t: 1 + np.cos(t) ** 2, lambda t: 1 + t**2)
    position, value = maximise_along(forms, np.array([-3.0, -1.0, 1.0]), np.array([-1.0, 1.0, 3.0]), 12)
    np.testing.assert_array_equal(value, (1 + np.cos(position) ** 2) / (1 + position**2))
    assert (np.array([-3.0, -1.0, 1.0]) <= position).all()
    assert (position <= np.array([-1.0, 1.0, 3.0])).all()


def test_a_flat_ratio_and_an_empty_search() -> None:
    forms, calls = counted(lambda t: 2 * (1 + t**2), lambda t: 1 + t**2)
    _, value = maximise_along(forms, np.array([0.0, 1.0]), np.array([1.0, 2.0]), 3)
    np.testing.assert_allclose(value, 2.0, rtol=1e-15)
    assert calls[0] < 100
    position, value = maximise_along(forms, np.zeros(0), np.zeros(0), 3)
    assert position.shape == value.shape == (0,)


def test_an_interval_of_no_length() -> None:
    forms, _ = counted(lambda t: 1 + t, lambda t: 1 + 1e9 * t**2)
    position, value = maximise_along(forms, np.array([0.5]), np.array([0.5]), 3)
    assert position[0] == 0.5
    assert value[0] == 1.5 / (1 + 0.25e9)


def test_forms_that_are_no_ratio_are_refused() -> None:
    for bad in (counted(np.ones_like, lambda t: t - 0.5), counted(lambda t: np.full_like(t, np.inf), np.ones_like)):
        with pytest.raises(ShapeError):
            maximise_along(bad[0], np.array([0.0]), np.array([1.0]), 4)


def test_a_needle_beside_zero_that_no_halving_reaches_ends_at_the_best_node() -> None:
    """Between 0 and 1e-30 there are more floats than sixty halvings can tell apart; the end of an interval is there."""
    forms, calls = counted(np.ones_like, lambda t: np.abs(t - 1e-30) + 1e-200)
    position, value = maximise_along(forms, np.array([-1.0]), np.array([1.0]), 5)
    assert position[0] == 0.0
    assert value[0] == pytest.approx(1e30)
    assert calls[0] < 2000  # places at which the forms are evaluated
