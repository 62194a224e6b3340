"""A sample of the certified campaign (`python -m tests.certify` runs ten thousand), and the certifier's own check."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

from tests.certify.one_joint import SLACK, GainPolynomials, Problem, certified_best_gain
from tests.certify.one_joint_cases import best_position, judged, random_problem

CASES = 150
LIMIT = 1e-9


def problem(seed: int) -> Problem:
    """Return the random joint of this seed."""
    return random_problem(np.random.default_rng(seed))


@pytest.mark.long
def test_the_step_reaches_the_certified_gain(record_property: Callable[[str, object], None]) -> None:
    verdicts = [judged(problem(seed)) for seed in range(20_000, 20_000 + CASES)]
    record_property("certified one-joint cases", len(verdicts))
    assert max(v.deficit for v in verdicts) < LIMIT
    assert max(v.misstated for v in verdicts) < LIMIT
    assert len(verdicts) == CASES


@pytest.mark.parametrize("seed", range(8))
def test_the_certifier_needs_no_hint(seed: int) -> None:
    """From nothing it encloses the same best gain, and its own position reaches it."""
    polynomials = GainPolynomials(problem(seed))
    hinted = certified_best_gain(polynomials, best_position(problem(seed))[0])
    alone = certified_best_gain(polynomials)
    assert hinted.lower <= alone.lower * (1 + SLACK)
    assert alone.lower <= hinted.lower * (1 + SLACK)
    assert polynomials.gain(*alone.position).overlaps(alone.lower)


@pytest.mark.parametrize("seed", range(8))
def test_the_certifier_notices_a_poorer_position(seed: int) -> None:
    case = problem(seed)
    polynomials, (position, _) = GainPolynomials(case), best_position(case)
    middle = (case.knots[0] + case.knots[-1]) / 2
    poorer = position + 0.01 * (middle - position)
    best = certified_best_gain(polynomials, poorer)
    assert polynomials.gain_at(poorer) < best.lower * (1 - LIMIT)


def test_the_certifier_computes_the_gain_that_dense_algebra_gives() -> None:
    rng = np.random.default_rng(5)
    case = Problem(np.array([0.0, 1.0, 2.5, 3.0]), False, rng.normal(size=(4, 4)), np.eye(4), 0.5)
    for problem_ in (case, dataclasses.replace(case, cyclic=True, factor=np.eye(3), root=np.eye(3))):
        polynomials = GainPolynomials(problem_)
        covariance = problem_.factor @ problem_.factor.T
        for knot, row in zip(problem_.knots, np.eye(len(covariance)), strict=False):
            gain = row @ covariance @ covariance @ row / (0.5 + row @ covariance @ row)
            assert float(polynomials.gain_at(float(knot))) == pytest.approx(gain, rel=1e-12)
