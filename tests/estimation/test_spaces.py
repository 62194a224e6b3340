"""Both rooms say what the equations say as they stand: value, gradient, information, answers, what is left out."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import gamma, kv

from axiscal.numerics import Array
from axiscal_core import unknowns
from axiscal_core.columns import Curves
from axiscal_core.numbers import Numbers
from axiscal_core.problem import Problem
from axiscal_core.spaces import Given, parts_of
from axiscal_core.unknowns import Space, Unknowns, space_of
from tests.generators.dense_posterior import Dense
from tests.generators.problems import KINDS, asked

COUNTS = {"axis": 14, "plate": 12, "five axes": 4, "two set-ups": 8}
_STEP = 1e-4


@cache
def _problem(kind: str, seed: int, stds: bool, inherits: bool) -> Problem:
    return asked(kind, COUNTS[kind], seed, stds, inherits)


@st.composite
def problems(draw: st.DrawFn, kinds: tuple[str, ...] = KINDS) -> tuple[Problem, Array]:
    """Return a problem and its sizes drawn from their prior."""
    kind, seed = draw(st.sampled_from(kinds)), draw(st.integers(0, 2))
    found = _problem(kind, seed, draw(st.booleans()), draw(st.booleans()))
    x = np.random.default_rng(draw(st.integers(0, 999))).standard_normal(len(found.sizes))
    return found, found.sizes.theta(x)[0]


def _both(problem: Problem) -> tuple[Space, Space]:
    return Numbers(problem), Unknowns(problem)


def _given(space: Space, theta: Array) -> Given:
    found = space.given(theta)
    assert found is not None
    return found


def _close(found: Array, wanted: Array, tolerance: float) -> None:
    """Assert that all entries agree to a share of the largest one."""
    assert np.shape(found) == np.shape(wanted)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=tolerance * (np.max(np.abs(wanted), initial=0) + 1e-300))


def _slopes(dense: Dense, theta: Array) -> list[Array]:
    """Return ∂K/∂θ by central differences."""
    steps = _STEP * np.eye(len(theta))
    return [(dense.covariance(theta + step) - dense.covariance(theta - step)) / (2 * _STEP) for step in steps]


def test_of_so_many_unknowns_the_room_is_that_of_the_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    """As of hundreds of set-ups, each with a few readings and as many unknowns of its own."""
    monkeypatch.setattr(unknowns, "MOST_NUMBERS", 5)
    problem = _problem("axis", 0, stds=True, inherits=False)
    numbers, columns = problem.rows.shape
    wide = problem.wider(np.ones((max(0, 2 * numbers - columns), numbers)))
    assert isinstance(space_of(wide), Numbers)
    assert isinstance(space_of(wide.only(np.arange(numbers) < 5)), Numbers)
    monkeypatch.setattr(unknowns, "_DEARER", columns)
    assert isinstance(space_of(wide), Unknowns)


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=5)
@given(st.data())
def test_value_gradient_and_information_are_those_of_the_equations(kind: str, data: st.DataObject) -> None:
    """log L, its central differences, and ½ tr K⁻¹∂K K⁻¹∂K."""
    problem, theta = data.draw(problems((kind,)))
    dense = Dense(problem)
    slopes, inverse = _slopes(dense, theta), np.linalg.inv(dense.covariance(theta))
    information = np.array([[0.5 * np.trace(inverse @ one @ inverse @ other) for other in slopes] for one in slopes])
    weighted = inverse @ problem.values
    gradient = np.array([0.5 * (weighted @ each @ weighted - np.trace(inverse @ each)) for each in slopes])
    for space in _both(problem):
        slope = _given(space, theta).slope()
        assert slope.value == pytest.approx(dense.log_likelihood(theta), abs=1e-5)
        _close(slope.gradient, gradient, 1e-5)
        _close(slope.information, information, 1e-5)


@settings(max_examples=20)
@given(problems())
def test_answers_are_those_of_the_equations(drawn: tuple[Problem, Array]) -> None:
    problem, theta = drawn
    mean, covariance = Dense(problem).unknowns(theta)
    stds = np.sqrt(np.diagonal(covariance))
    for space in _both(problem):
        answer = _given(space, theta).without_causes()
        np.testing.assert_allclose((answer.mean - mean) / stds, 0, atol=1e-4)
        np.testing.assert_allclose((answer.covariance - covariance) / np.outer(stds, stds), 0, atol=1e-4)


@settings(max_examples=12)
@given(problems())
def test_rests_of_cells_are_those_of_the_equations(drawn: tuple[Problem, Array]) -> None:
    """C Zᵀ K⁻¹ y of the columns of cells, turned back into rests."""
    problem, theta = drawn
    dense = Dense(problem)
    every = dense.prior_covariance(theta) @ problem.rows.T @ np.linalg.solve(dense.covariance(theta), problem.values)
    turn, start = np.zeros((len(problem.cells),) * 2), 0
    for root in problem.cell_roots:
        turn[start : start + len(root), start : start + len(root)] = root
        start += len(root)
    wanted = turn @ every[problem.first_cell : problem.first_cell + len(problem.cells)]
    for space in _both(problem):
        _close(_given(space, theta).cell_means(), wanted, 1e-5)


@settings(max_examples=8)
@given(problems())
def test_a_reading_left_out_is_left_out(drawn: tuple[Problem, Array]) -> None:
    """K⁻¹y and blocks of K⁻¹ say what the others expect of a reading, and how well."""
    problem, theta = drawn
    dense = Dense(problem)
    for space in _both(problem):
        given_here, every = _given(space, theta), parts_of(problem.reading)
        found = [one for part in every for one in zip(part, *given_here.left_out(part), strict=True)]
        assert len(found) == len(np.unique(problem.reading))
        for mine, weighted, block in found:
            mean, covariance = dense.expected(theta, int(problem.reading[mine[0]]))
            _close(np.linalg.inv(block), covariance, 1e-4)
            apart = problem.values[mine] - mean
            residual = np.linalg.inv(block) @ weighted
            np.testing.assert_allclose(residual, apart, atol=1e-4 * np.sqrt(np.diagonal(covariance).max()))


@pytest.mark.parametrize("smoothness", [1.5, 2.5])
@given(st.integers(0, 999))
@settings(max_examples=5)
def test_curves_have_the_prior_of_matern(smoothness: float, seed: int) -> None:
    """L Lᵀ = s² R(l), by Bessel functions, and M = L⁻¹ ∂(s² R)/∂log l L⁻ᵀ, by differences."""
    problem = _problem("axis", 0, False, False)
    (curves,) = problem.curves
    assert isinstance(curves, Curves)
    curves = replace(curves, smoothness=smoothness)
    theta = problem.sizes.theta(np.random.default_rng(seed).standard_normal(len(problem.sizes)))[0]
    (at,) = curves.length_at

    def covariance(by: float) -> Array:
        far = np.sqrt(2 * smoothness) * curves.apart[0] / (curves.lengths[0] * np.exp(theta[at] + by))
        far += 1e-12
        correlation = 2 ** (1 - smoothness) / gamma(smoothness) * far**smoothness * kv(smoothness, far)
        return np.asarray(curves.stds[0] ** 2 * correlation)

    root = curves.roots(theta)
    _close(root[0] @ root[0].T, covariance(0.0), 1e-8)
    slope = (covariance(1e-4) - covariance(-1e-4)) / 2e-4
    _close(root[0] @ curves.bends(theta, root)[0] @ root[0].T, slope, 1e-5)
