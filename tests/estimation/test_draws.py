"""The mode is a maximum, and weighed draws have the moments of the posterior of sizes."""

from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import minimize

from axiscal.numerics import Array
from axiscal_core.draws import draws, mode, weighed
from axiscal_core.problem import Problem
from axiscal_core.unknowns import Space, space_of
from tests.generators.problems import asked, sized


def _density(space: Space, x: Array) -> float:
    found = space.given(space.problem.sizes.theta(x)[0])
    assert found is not None
    return found.value - 0.5 * float(x @ x)


@cache
def _problem(kinds: tuple[str, ...], count: int = 30, seed: int = 4) -> Problem:
    return sized(asked("axis", count, seed), kinds)


@pytest.mark.parametrize("kinds", [("noise",), ("std", "noise"), ("std", "length", "rest", "drift", "noise")])
def test_the_mode_is_the_highest_of_several_climbs(kinds: tuple[str, ...]) -> None:
    """Nelder and Mead, who know no gradient, from five starts, find nothing that draws would mind."""
    space, rng = space_of(_problem(kinds)), np.random.default_rng(0)
    best = mode(space)
    assert best.value == pytest.approx(_density(space, best.x), abs=1e-9)
    starts = [best.x, *rng.standard_normal((4, len(best.x)))]

    def lost(x: Array) -> float:
        return -_density(space, x)

    found = [minimize(lost, np.asarray(start), method="Nelder-Mead", tol=1e-6) for start in starts]
    highest = -min(float(each.fun) for each in found)
    assert highest - 0.05 < best.value <= highest + 1e-6


def _by_grid(space: Space, taught: NDArray[np.intp]) -> tuple[Array, Array]:
    """Return mean and covariance of θ by the sum over a grid of x; sizes that are not taught stay as stated."""
    k = len(taught)
    if k == 0:
        return np.zeros(len(space.problem.sizes)), np.zeros((len(space.problem.sizes),) * 2)
    along = np.linspace(-4.5, 4.5, 181 if k == 1 else 61)
    points = np.stack(np.meshgrid(*[along] * k, indexing="ij"), axis=-1).reshape(-1, k)
    x = np.tile(space.problem.sizes.stated, (len(points), 1))
    x[:, taught] = points
    logs = np.array([_density(space, each) for each in x])
    weights = np.exp(logs - logs.max())
    weights /= weights.sum()
    theta = space.problem.sizes.theta(x)[0]
    mean = weights @ theta
    return mean, (weights[:, None] * (theta - mean)).T @ (theta - mean)


@pytest.mark.parametrize(("kinds", "count"), [(("noise",), 24), (("std", "noise"), 24), (("drift", "rest"), 3)])
def test_weighed_draws_have_the_moments_of_a_grid(kinds: tuple[str, ...], count: int) -> None:
    """Of three campaigns in the mean: means within a fifth of a standard deviation, these within three tenths."""
    apart, wide = list[float](), list[float]()
    for seed in (4, 5, 6):
        space = space_of(_problem(kinds, count, seed))
        best = mode(space)
        found = weighed(space, draws(space, best))
        taught = best.taught
        assert np.all(np.delete(found.thetas, taught, axis=1) == 0)
        assert len(taught) or count == 3
        mean = found.weights @ found.thetas
        spread = (found.weights[:, None] * (found.thetas - mean)).T @ (found.thetas - mean)
        wanted, covariance = _by_grid(space, taught)
        stds = np.sqrt(np.diagonal(covariance)[taught])
        apart.append(float(np.max(np.abs((mean - wanted)[taught] / stds), initial=0.0)))
        wide.append(float(np.max(np.abs(np.sqrt(np.diagonal(spread)[taught]) / stds - 1), initial=0.0)))
    assert np.mean(apart) < 0.2
    assert np.mean(wide) < 0.3
