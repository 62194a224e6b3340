"""What draws come to piece by piece: weights, readings left out, mixtures and details, by their definitions."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from axiscal.estimation.promise.posterior import Drawn, _may_be_a_detail, sorted_out
from axiscal.numerics import Array
from axiscal_core import left_out as left_out_of
from axiscal_core.draws import Mode, Weighed, draws, mode, weighed
from axiscal_core.left_out import LeftOut, left_out
from axiscal_core.problem import Problem
from axiscal_core.spaces import Given
from axiscal_core.theta import Size, Sizes
from axiscal_core.unknowns import Space, space_of
from tests.generators.dense_posterior import Dense, mixture
from tests.generators.problems import asked, case_of, readings_of, sized, stated


@cache
def _learnt() -> tuple[Problem, Space, Mode[Given]]:
    """Return thirty readings that teach two sizes, with their mode."""
    problem = sized(asked("axis", 30, 4), ("std", "noise"))
    space = space_of(problem)
    best = mode(space)
    assert len(best.taught) == 2
    return problem, space, best


def test_weights_are_likelihood_over_proposal_none_above_the_root_of_their_number_times_the_mean() -> None:
    problem, space, best = _learnt()
    drawn = draws(space, replace(best, covariance=25 * best.covariance))  # far too wide: one draw has too much
    dense = Dense(problem)
    logs = np.array([dense.log_likelihood(theta) for theta in drawn.thetas]) - drawn.log_proposal[:-1]
    raw = np.exp(logs - logs.max())
    cut = np.minimum(raw, raw.mean() * 8)
    assert np.any(cut < raw)
    found = weighed(space, drawn)
    np.testing.assert_allclose(found.every, cut / cut.sum(), rtol=1e-4, atol=1e-9)
    assert found.weights.sum() == pytest.approx(1.0)
    assert len(found.weights) == np.sum(found.every > 1e-6)
    assert found.log_evidence == pytest.approx(float(np.log(np.mean(np.exp(logs - logs.max()))) + logs.max()), abs=1e-4)
    stated = dense.log_likelihood(np.zeros(len(problem.sizes))) - drawn.log_proposal[-1]
    assert found.log_stated == pytest.approx(stated - np.log(64) - found.log_evidence, abs=1e-4)


def _of_three_draws() -> tuple[Problem, Weighed[Given]]:
    """Return a dozen readings, one of them far off, and three draws of two sizes, the second one the heaviest."""
    problem = sized(asked("axis", 12, 3), ("std", "noise"))
    problem = replace(problem, values=problem.values + 60.0 * (problem.reading == 4))
    space, thetas = space_of(problem), np.array([[-0.4, 0.2], [0.1, 0.1], [0.3, -0.2]])
    given = tuple(each for theta in thetas if (each := space.given(theta)) is not None)
    found = weighed(space, draws(space, mode(space)))
    return problem, replace(found, thetas=thetas, weights=np.array([0.3, 0.5, 0.2]), given=given)


def test_of_many_readings_the_heaviest_draw_judges_and_all_of_them_those_that_it_suspects(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    problem, found = _of_three_draws()
    every = left_out(problem, found)
    monkeypatch.setattr(left_out_of, "MOST_NUMBERS", 11)
    many, dense = left_out(problem, found), Dense(problem)
    left = {index: (problem.values[index], *dense.expected(found.thetas[1], index)) for index in many}
    suspected = [i for i, (value, mean, covariance) in left.items() if abs(value - mean) > 3 * covariance[0, 0] ** 0.5]
    assert 4 in suspected
    assert len(suspected) < 12
    for index, each in many.items():
        mean, covariance = dense.expected(found.thetas[1], index)
        if index in suspected:
            mean, covariance = mixture([dense.expected(theta, index) for theta in found.thetas], found.weights)
            assert each.log_odds == pytest.approx(every[index].log_odds)
        np.testing.assert_allclose(each.covariance, covariance, rtol=1e-3)
        np.testing.assert_allclose(each.residual, problem.values[problem.reading == index] - mean, rtol=1e-3, atol=1e-3)
        assert each.z == pytest.approx(abs(each.residual[0]) / each.covariance[0, 0] ** 0.5)


@pytest.mark.parametrize("slip", [8e-6, 20e-6])
def test_a_second_reading_at_its_place_tells_a_slip_from_a_detail(slip: float) -> None:
    case = case_of("axis")
    right = readings_of(case, 24, 4)
    wrong = replace(right[7], value=right[7].value + slip)
    alone, again = (sorted_out(stated(case, [*right[:7], wrong, *right[8:], *more])) for more in ([], [right[7]]))
    assert ([*alone.bad], alone.with_details is None) == ([7], False)
    assert ([*again.bad], again.with_details is None) == ([7], True)


THETAS = np.log(np.array([[0.5, 1.0, 2.0], [1.0, 2.0, 2.0], [4.0, 3.0, 1.0]]))
WEIGHTS = np.array([0.005, 0.5, 0.495])


def _told(thetas: Array, weights: Array) -> Drawn:
    """Return draws of a curve's size, a noise and a length."""
    of = Size("std", ("EXX", "EYX"), 1.0), Size("noise", ("laser",), 1.0), Size("length", ("EXX",), 1.0)
    return Drawn(cast("Problem", SimpleNamespace(sizes=Sizes(of))), thetas, weights)


def test_of_an_error_so_much_is_there_with_99_percent() -> None:
    """Below 1.0 are 0.5 %, so that 1 % of the draws are no smaller than 1.0; noises and lengths do not count."""
    expected = 1.0 / float(WEIGHTS @ np.array([0.25, 1.0, 16.0])) ** 0.5
    assert _told(THETAS, WEIGHTS).surely == pytest.approx(expected)
    assert _told(THETAS, WEIGHTS / 2).surely == pytest.approx(expected)  # of two that count one half each
    more = np.array([0.02, 0.5, 0.48])
    assert _told(THETAS, more).surely == pytest.approx(0.5 / float(more @ np.array([0.25, 1.0, 16.0])) ** 0.5)
    assert _told(0.0 * THETAS, WEIGHTS).surely == 1.0
    assert _told(THETAS * [0.0, 1.0, 1.0], WEIGHTS).surely == 1.0  # noise and length alone are in doubt


def test_a_detail_is_no_larger_than_two_stated_sizes_of_the_curves() -> None:
    problem, _, _ = _learnt()
    (curves,), index = problem.curves, 7
    row = problem.rows[problem.reading == index][:, curves.columns[0]]
    root = curves.roots(np.zeros(len(problem.sizes)))[0]
    size = float(np.sqrt(row @ root @ root.T @ row.T)[0, 0])
    for times, may in ((1.99, True), (2.01, False)):
        left = LeftOut(np.array([-times * size]), np.eye(1), 0.0, 0.0)
        assert _may_be_a_detail(problem, index, left) == may
