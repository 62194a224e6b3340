"""The mode is a maximum, and weighed draws have the moments of the posterior of sizes."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import norm

from axiscal.estimate.draws import Draws, Weighed, draws, mode, weighed
from axiscal.estimate.problem import Problem
from axiscal.estimate.room import space_of
from axiscal.estimate.sizes import Sizes
from axiscal.estimate.spaces import Space
from axiscal.estimate.unknowns import Unknowns
from axiscal.numerics import Array
from tests.generators.problems import asked, sized


def _density(space: Space, x: Array) -> float:
    found = space.given(space.problem.sizes.at(x)[0])
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
    found = [minimize(lambda x: -_density(space, x), start, method="Nelder-Mead", tol=1e-6) for start in starts]
    highest = -min(each.fun for each in found)
    assert highest - 0.05 < best.value <= highest + 1e-6


def test_covariance_of_the_mode_is_that_of_information() -> None:
    """From the curvature that differences of the density show, where the information is near it: many readings."""
    space = Unknowns(_problem(("std", "noise"), 120))
    best, step = mode(space), 0.02
    axes = step * np.eye(2)
    curvature = np.array(
        [
            [
                sum(i * j * _density(space, best.x + i * a + j * b) for i in (1, -1) for j in (1, -1)) / (4 * step**2)
                for a in axes
            ]
            for b in axes
        ]
    )
    np.testing.assert_allclose(best.covariance, -np.linalg.inv(curvature), rtol=0.3, atol=0.02)


def _by_grid(space: Space) -> tuple[Array, Array]:
    """Return mean and covariance of θ by the sum over a grid of x."""
    k = len(space.problem.sizes)
    along = np.linspace(-4.5, 4.5, 181 if k == 1 else 61)
    x = np.stack(np.meshgrid(*[along] * k, indexing="ij"), axis=-1).reshape(-1, k)
    logs = np.array([_density(space, each) for each in x])
    weights = np.exp(logs - logs.max())
    weights /= weights.sum()
    theta = space.problem.sizes.at(x)[0]
    mean = weights @ theta
    return mean, (weights[:, None] * (theta - mean)).T @ (theta - mean)


@pytest.mark.parametrize("kinds", [("noise",), ("rest",), ("std", "noise"), ("length", "noise"), ("drift", "rest")])
@pytest.mark.parametrize("count", [3, 24])
def test_weighed_draws_have_the_moments_of_a_grid(kinds: tuple[str, ...], count: int) -> None:
    """Mean within a fifth of a standard deviation, standard deviations within three tenths, as 64 draws can."""
    space = space_of(_problem(kinds, count))
    found = weighed(space, draws(space, mode(space)))
    mean = found.weights @ found.thetas
    spread = (found.weights[:, None] * (found.thetas - mean)).T @ (found.thetas - mean)
    wanted, covariance = _by_grid(space)
    stds = np.sqrt(np.diagonal(covariance))
    np.testing.assert_allclose((mean - wanted) / stds, 0, atol=0.2)
    np.testing.assert_allclose(np.sqrt(np.diagonal(spread)) / stds, 1, atol=0.3)


def _weighed_of(space: Space, drawn: Draws) -> Weighed:
    return weighed(space, drawn)


def test_a_size_of_which_readings_say_nothing_keeps_its_prior() -> None:
    """All draws count alike then, but for what separates a normal from its own approximation."""
    problem = _problem(("noise", "std")).only(np.zeros(30, dtype=bool))
    space = space_of(problem)
    found = _weighed_of(space, draws(space, mode(space)))
    assert found.effective > 50
    x = norm.ppf(0.75)
    quartile = problem.sizes.at(np.full(2, x))[0]
    for j in range(2):
        assert found.weights[found.thetas[:, j] > quartile[j]].sum() == pytest.approx(0.25, abs=0.08)


def test_the_same_readings_have_the_same_draws() -> None:
    first, second = (_drawn_anew() for _ in range(2))
    np.testing.assert_array_equal(first.thetas, second.thetas)
    np.testing.assert_array_equal(first.weights, second.weights)


def _drawn_anew() -> Weighed:
    space = space_of(sized(asked("axis", 20, 3), ("std", "rest", "noise")))
    return weighed(space, draws(space, mode(space)))


@pytest.mark.parametrize("kind", ["axis", "plate", "two set-ups"])
def test_enough_draws_count(kind: str) -> None:
    """The effective number of 64 draws of all sizes, and what it is made of."""
    space = space_of(asked(kind, 24, 2))
    drawn = draws(space, mode(space))
    found = weighed(space, drawn)
    assert found.effective == pytest.approx(1 / np.sum(found.weights**2))
    assert found.weights.sum() == pytest.approx(1.0)
    assert len(found.given) == len(found.weights) <= len(drawn.x) == 64
    assert found.effective >= 10


def test_fixed_sizes_need_one_draw() -> None:
    space = space_of(_problem(()))
    found = weighed(space, draws(space, mode(space)))
    assert found.thetas.shape == (1, 0)
    assert found.weights.tolist() == [1.0]
    assert found.effective == 1.0
    assert len(Sizes(())) == 0


def test_the_proposal_is_a_density() -> None:
    """The mean of φ(x) over the proposal is one: what draws of the prior weigh against it, at random points of it."""
    space = space_of(_problem(("std", "noise")))
    best = mode(space)
    drawn = draws(space, best, 4096)
    assert np.mean(np.exp(-drawn.log_proposal)) == pytest.approx(1.0, abs=0.1)
