"""What wears off, against the same machine in one normal of all that there is, conditioned densely."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.estimation.promise.problem import Inherited
from axiscal.numerics import Array
from axiscal.ports.fleet.wearing import Wearing

SIZE, READ = 7, 4


def _covariance(rng: np.random.Generator, rank: int = SIZE) -> Array:
    root = rng.standard_normal((SIZE, rank)) * np.array([1e-6] * 4 + [1e-5] * 3)[:, None]
    return np.asarray(root @ root.T)


def _after(
    mean: Array, own: Array, common: Array, rows: Array, values: Array, rho: float, renewed: Array
) -> tuple[Inherited, Inherited]:
    """Return what is known of the errors on the day of the campaign, and of those a time later.

    The state is μ, d, what comes anew of what ages, and of what was renewed, one behind the other.
    """
    zero = np.zeros((SIZE, SIZE))
    prior = np.block(
        [
            [common, zero, zero, zero],
            [zero, own, zero, zero],
            [zero, zero, own, zero],
            [zero, zero, zero, own],
        ]
    )
    start = np.concatenate([mean, np.zeros(3 * SIZE)])
    seen = rows @ np.hstack([np.eye(SIZE), np.eye(SIZE), zero, zero])
    gain = prior @ seen.T @ np.linalg.inv(seen @ prior @ seen.T + 1e-14 * np.eye(READ))
    state, left = start + gain @ (values - seen @ start), prior - gain @ seen @ prior
    ages, new = np.diag(1.0 - renewed), np.diag(renewed)
    then = np.hstack([np.eye(SIZE), np.eye(SIZE), zero, zero])
    later = np.hstack([np.eye(SIZE), rho * ages, np.sqrt(1 - rho**2) * ages, new])
    return (
        Inherited(then @ state, then @ left @ then.T),
        Inherited(later @ state, later @ left @ later.T),
    )


@pytest.mark.parametrize("rank", [SIZE, 2])
def test_what_is_left_is_that_of_one_normal_of_all(rank: int) -> None:
    """Of two values of ρ: each alone, and both by their moments.  rank : of what all sisters have in common"""
    rng = np.random.default_rng(rank)
    own, common, mean = _covariance(rng), _covariance(rng, rank), 1e-6 * rng.standard_normal(SIZE)
    rows, renewed = rng.standard_normal((READ, SIZE)), np.array([0, 1, 0, 0, 1, 0, 0], dtype=float)
    values = 1e-5 * rng.standard_normal(READ)
    shares, weights = (0.9, 0.4), np.array([0.7, 0.3])
    each = [_after(mean, own, common, rows, values, rho, renewed) for rho in shares]
    worn = Wearing(mean, own, common).worn(each[0][0])
    fresh = renewed > 0
    for rho, (_, true) in zip(shares, each, strict=True):
        found = worn.left(rho, renewed=fresh)
        np.testing.assert_allclose(found.mean, true.mean, rtol=1e-8, atol=1e-14)
        np.testing.assert_allclose(found.covariance, true.covariance, rtol=1e-7, atol=1e-20)
    mixed = sum(
        w * (true.covariance + np.outer(true.mean, true.mean)) for w, (_, true) in zip(weights, each, strict=True)
    )
    middle = sum(w * true.mean for w, (_, true) in zip(weights, each, strict=True))
    found = worn.left(float(weights @ shares), float(weights @ np.square(shares)), fresh)
    np.testing.assert_allclose(found.mean, middle, rtol=1e-8, atol=1e-14)
    np.testing.assert_allclose(found.covariance, mixed - np.outer(middle, middle), rtol=1e-7, atol=1e-20)


def test_without_a_type_all_of_it_wears_off() -> None:
    rng = np.random.default_rng(3)
    stated, found = _covariance(rng), Inherited(rng.standard_normal(SIZE), 0.1 * _covariance(rng))
    left = Wearing(np.zeros(SIZE), stated, np.zeros((SIZE, SIZE))).worn(found).left(0.9)
    np.testing.assert_allclose(left.mean, 0.9 * found.mean)
    np.testing.assert_allclose(left.covariance, 0.81 * found.covariance + 0.19 * stated)
