"""The largest length of a sum of curves: enclosed, and found, as a dense grid finds it."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.numerics import Array
from axiscal.numerics.bernstein import BezierCurve, along, bernstein, steepest, uphill

GRID = {1: 4001, 2: 241, 3: 61}


def curves(generator: np.random.Generator, axes: int, degree: int, width: int = 4) -> list[BezierCurve]:
    """Return random curves of a few pieces that hang together."""
    found = []
    for _ in range(axes):
        edges = np.concatenate([[0.0], np.cumsum(generator.uniform(0.5, 2.0, 4))])
        control = generator.normal(size=(4, degree + 1, width))
        control[1:, 0] = control[:-1, -1]
        found.append(BezierCurve(edges[:-1], edges[1:], control))
    return found


def on_a_grid(fixed: Array, pieces: list[BezierCurve]) -> float:
    """Return the largest squared length on a dense grid, ends included."""
    total = fixed.reshape((1,) * len(pieces) + (-1,))
    for k, curve in enumerate(pieces):
        values = along(curve, np.linspace(curve.left[0], curve.right[-1], GRID[len(pieces)]))
        total = total + values.reshape((1,) * k + (-1,) + (1,) * (len(pieces) - k - 1) + values.shape[1:])
    return float(np.max(np.sum(total**2, axis=-1)))


@pytest.mark.parametrize("axes", [1, 2, 3])
@pytest.mark.parametrize("degree", [3, 4])
@pytest.mark.parametrize("seed", range(4))
def test_the_largest_is_enclosed(axes: int, degree: int, seed: int) -> None:
    generator = np.random.default_rng(seed)
    pieces, fixed = curves(generator, axes, degree), generator.normal(size=4)
    found, best = steepest(fixed, pieces, 0.0, 1e-3, 200_000), on_a_grid(fixed, pieces)
    assert found.lower <= found.upper <= found.lower * (1 + 2e-3)
    assert best <= found.upper
    assert found.lower >= best * (1 - 2e-3)
    assert lengths(fixed, pieces, found.places[:1])[0] == pytest.approx(found.lower, rel=1e-9)


def test_a_search_that_is_cut_short_still_encloses() -> None:
    generator = np.random.default_rng(0)
    pieces, fixed = curves(generator, 3, 3), generator.normal(size=4)
    best = on_a_grid(fixed, pieces)
    for boxes in (0, 1, 100, 3000):
        assert steepest(fixed, pieces, 0.0, 1e-6, boxes).upper >= best


def test_what_is_below_the_level_is_not_looked_at() -> None:
    generator = np.random.default_rng(1)
    pieces, fixed = curves(generator, 2, 3), generator.normal(size=4)
    best = on_a_grid(fixed, pieces)
    found = steepest(fixed, pieces, 10 * best, 1e-3, 200_000)
    assert best <= found.upper <= 10 * best * (1 + 1e-3)


def test_uphill_gains_and_stays_inside() -> None:
    generator = np.random.default_rng(2)
    pieces, fixed = curves(generator, 2, 3), generator.normal(size=4)
    low, high = np.zeros(2), np.array([curve.right[-1] for curve in pieces])
    begun = generator.uniform(low, high, (40, 2))
    before, ended = lengths(fixed, pieces, begun), uphill(fixed, pieces, begun)
    assert np.all(lengths(fixed, pieces, ended) >= before)
    assert lengths(fixed, pieces, ended).max() == pytest.approx(on_a_grid(fixed, pieces), rel=1e-3)
    assert np.all((low <= ended) & (ended <= high))


def test_uphill_finds_the_top_of_a_parabola() -> None:
    """(t − 1)² − 4 in [0, 2] is longest at t = 1; its Bernstein points are −3, −5, −3."""
    curve = BezierCurve(np.zeros(1), np.full(1, 2.0), np.array([[[-3.0], [-5.0], [-3.0]]]))
    assert uphill(np.zeros(1), [curve], np.array([[0.9]]))[0, 0] == pytest.approx(1.0, abs=1e-3)


def lengths(fixed: Array, pieces: list[BezierCurve], places: Array) -> Array:
    """Return the squared lengths at places (m, q)."""
    total = np.tile(fixed, (len(places), 1))
    for k, curve in enumerate(pieces):
        total += along(curve, places[:, k])
    result: Array = np.sum(total**2, axis=1)
    return result


def test_bernstein_polynomials_sum_to_one_and_hold_lines() -> None:
    t = np.linspace(0, 1, 11)
    for degree in (1, 3, 4):
        basis = bernstein(degree, t)
        np.testing.assert_allclose(basis.sum(axis=1), 1.0)
        np.testing.assert_allclose(basis @ np.linspace(2.0, 5.0, degree + 1), 2 + 3 * t)
