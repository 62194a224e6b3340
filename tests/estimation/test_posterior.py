"""The posterior is the mixture that the equations say, it covers what it promises, and names bad readings."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from axiscal.estimation.promise.posterior import Posterior, sorted_out
from axiscal.measurement.reading import Reading
from axiscal_core.draws import draws, mode, weighed
from axiscal_core.unknowns import space_of
from tests.generators.dense_posterior import Dense, degrees_of, mixture
from tests.generators.problems import asked, case_of, readings_of, stated

NOISE = 0.5e-6


@cache
def _readings(count: int) -> tuple[Reading, ...]:
    return tuple(readings_of(case_of("axis"), count, 6))


def _of(readings: tuple[Reading, ...] | list[Reading]) -> Posterior:
    return sorted_out(stated(case_of("axis"), readings)).posterior()


def _off(readings: tuple[Reading, ...], by: dict[int, float]) -> list[Reading]:
    """Return readings with some of them off by so many noises."""
    return [replace(r, value=r.value + by.get(i, 0.0) * NOISE) for i, r in enumerate(readings)]


@pytest.mark.parametrize(("kind", "count"), [("axis", 12), ("plate", 9)])
def test_moments_and_odds_are_those_of_the_equations(kind: str, count: int) -> None:
    """Mean, covariance, degrees of freedom, residuals and odds over the same draws and weights."""
    problem = asked(kind, count, 3)
    every = range(count)
    volume = np.diag(np.linspace(1.0, 2.0, problem.answered))
    found = sorted_out(problem, sure=every).posterior(volume=volume)
    space = space_of(problem)
    over = weighed(space, draws(space, mode(space)))
    dense = Dense(problem)
    parts = [dense.counted(theta) for theta in over.thetas]
    mean, covariance = mixture(parts, over.weights)
    stds = np.sqrt(np.diagonal(covariance))
    np.testing.assert_allclose((found.mean - mean) / stds, 0, atol=1e-4)
    np.testing.assert_allclose((found.covariance - covariance) / np.outer(stds, stds), 0, atol=1e-4)
    for number, size in enumerate(problem.sizes.of):  # root mean squares, and geometric means of lengths
        log = over.thetas[:, number]
        mean_of = np.exp(over.weights @ log) if size.kind == "length" else np.sqrt(over.weights @ np.exp(2 * log))
        assert [found.sizes[size.kind, owner] for owner in size.owners] == pytest.approx([mean_of] * len(size.owners))
    assert found.degrees == pytest.approx(degrees_of(parts, over.weights, volume), rel=1e-3)
    stated, given = np.zeros(len(problem.sizes)), space.given(np.zeros(len(problem.sizes)))
    assert given is not None
    proposed = draws(space, mode(space)).log_proposal[-1]
    more = np.exp(given.value - proposed - over.log_evidence) / len(over.every)
    thetas, weights = np.vstack([over.thetas, stated]), np.append(over.weights, more) / (1 + more)
    for reading in (0, count - 1):
        mine, left = problem.reading == reading, found.left_out[reading]
        expected, spread = mixture([dense.expected(theta, reading) for theta in over.thetas], over.weights)
        np.testing.assert_allclose(left.residual, problem.values[mine] - expected, rtol=1e-3, atol=1e-3)
        np.testing.assert_allclose(left.covariance, spread, rtol=1e-3, atol=1e-3 * np.abs(spread).max())
        assert np.exp(left.log_odds) == pytest.approx(dense.odds(thetas, weights, reading), rel=1e-3)
    assert found.effective == pytest.approx(over.effective)


def test_a_sure_reading_stays() -> None:
    """However far it is off, and the readings do not agree then."""
    readings = _off(_readings(24), {7: 200.0})
    found = sorted_out(stated(case_of("axis"), readings), sure=(7,)).posterior()
    assert 7 not in found.bad
    assert found.left_out[7].log_odds > 0
    assert found.left_out[7].z > 3


def test_a_reading_that_is_never_used_changes_nothing() -> None:
    readings = _readings(12)
    one, other = (
        sorted_out(stated(case_of("axis"), _off(readings, {5: by})), never=(5,)).posterior() for by in (0.0, 500.0)
    )
    np.testing.assert_array_equal(one.mean, other.mean)
    np.testing.assert_array_equal(one.covariance, other.covariance)


@pytest.mark.parametrize("count", [1, 2, 3, 24])
def test_good_readings_however_few_leave_an_answer_and_none_of_them_is_bad(count: int) -> None:
    """Finite; two readings teach no size."""
    found = _of(_readings(count))
    stds = np.sqrt(np.diagonal(found.covariance))
    assert np.all(np.isfinite(found.mean))
    assert np.linalg.eigvalsh(found.covariance / np.outer(stds, stds)).min() > -1e-9
    assert not found.bad
    assert len(found.left_out) == count
    assert found.effective >= 10 or count < 3
    assert (set(found.sizes.values()) == {1.0}) == (count < 3)


@pytest.mark.parametrize("slip", [8e-6, 20e-6])
def test_a_second_reading_at_its_place_tells_a_slip_from_a_detail(slip: float) -> None:
    case = case_of("axis")
    right = readings_of(case, 24, 4)
    wrong = replace(right[7], value=right[7].value + slip)
    alone, again = (sorted_out(stated(case, [*right[:7], wrong, *right[8:], *more])) for more in ([], [right[7]]))
    assert ([*alone.bad], len(alone.judged) == 1) == ([7], False)
    assert ([*again.bad], len(again.judged) == 1) == ([7], True)
