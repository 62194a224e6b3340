"""The two rooms of one likelihood beside each other, beside differences, and beside the dense formula."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import norm

import axiscal_core as ac
from axiscal_core import draws, rigid
from axiscal_core.numbers import Numbers
from axiscal_core.posing import posed
from axiscal_core.problem import Problem
from axiscal_core.unknowns import Unknowns
from tests.core.strangers import Warm, mill


def _problem(seed: int) -> tuple[Problem, ac.Array]:
    """Return lasers and a level of noises of their own on two axes, and sizes to look at."""
    rng = np.random.default_rng(seed)
    seen = [Warm("x", "X", along="x"), ac.Laser("y", "Y", noise="2 um", along="y"), ac.Level("c", "X", about="z")]
    case = ac.Case(mill().stated, seen)
    places = ac.Places([*"xyc"] * 6, rng.uniform(0, 0.4, (18, 2)), rng.choice([-1, 1], (18, 2)))
    problem = posed(case, ac.Readings.simulated(case, places, seed), None)
    return problem, rng.normal(0, 0.4, len(problem.sizes))


@pytest.mark.parametrize("seed", range(3))
def test_what_each_source_leaves_adds_up_to_the_variance(seed: int) -> None:
    problem, theta = _problem(seed)
    figures = np.random.default_rng(seed).normal(size=(4, problem.answered))
    answers = []
    for room in (Numbers(problem), Unknowns(problem)):
        given = room.given(theta)
        assert given is not None
        posterior, sources = given.posterior(), given.sources(figures)
        assert problem.type_b.any()
        assert sum(part.sum() for part in sources) == pytest.approx(
            np.einsum("fi,ij,fj", figures, posterior.covariance, figures), rel=1e-8
        )
        std = np.sqrt(np.diagonal(posterior.covariance))
        gained = problem.mean + given._moved(given.weighted[:, None])[:, 0]
        assert posterior.mean / std == pytest.approx(gained / std, abs=1e-4)
        answers.append([posterior.mean / std, posterior.covariance / std / std[:, None], given.density, *sources])
    for one, other in zip(*answers, strict=True):
        assert one == pytest.approx(other, rel=1e-6, abs=1e-6)


def test_turns_are_those_of_scipy() -> None:
    rng = np.random.default_rng(1)
    vectors, angles = rng.normal(size=(9, 3)), rng.uniform(-4, 4, 9)
    for unit in np.eye(3):
        asked = Rotation.from_rotvec(angles[:, None] * unit)
        assert rigid.turned_about(unit, angles) == pytest.approx(asked.as_matrix())
    assert rigid.turned(vectors, vectors[::-1]) == pytest.approx(Rotation.from_rotvec(vectors[::-1]).apply(vectors))


def test_halves_have_their_own_widths() -> None:
    """The share of a normal of two halves below a point is 2 w₀ Φ(x/w₀) / (w₀ + w₁), and so on above its mode."""
    points, (low, high) = np.linspace(-3, 3, 61)[:, None], (0.7, 2.0)
    found = draws._halved(points, np.array([[low], [high]]))
    below = 2 * low * norm.cdf(found / low) / (low + high)
    above = 1 - 2 * high * norm.sf(found / high) / (low + high)
    assert np.where(found < 0, below, above) == pytest.approx(norm.cdf(points), abs=1e-9)
