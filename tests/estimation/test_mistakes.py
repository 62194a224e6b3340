"""Each mistake is as probable as the dense density of the readings without it says; what is named puts them right."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy import stats

from axiscal.estimation.promise.agreement import Agreement, agreement
from axiscal.estimation.promise.mistake import NAMED, Explained, Mistake, Sought, Suspect, Tried, explained
from axiscal.estimation.promise.slip import exchanges, larger_units, signs
from axiscal.numerics import Array
from axiscal_core.draws import sized as sized_of
from axiscal_core.problem import Problem
from tests.generators.dense_posterior import Dense, log_density
from tests.generators.problems import asked, sized

COUNTS = {"axis": 9, "two set-ups": 8}


@cache
def _exact(kind: str) -> Problem:
    """Return readings whose sizes are exact: what a few sizes tell is then what all do."""
    return sized(asked(kind, COUNTS[kind], 5), ())


class _Without:
    """What readings are without a mistake: values y' of density |det T| p(y'), or y of another covariance."""

    def __init__(self, problem: Problem) -> None:
        self.problem, self.nought = problem, np.zeros(len(problem.values))
        self.alone, self.judging = (each(np.zeros(0)) for each in (Dense(problem).covariance, Dense(problem).judging))

    def agrees(self, found: Suspect, values: Array) -> None:
        """Assert odds of 1 % before: at a few sizes with the causes of type B that judge, then without; and the tail.

        values : (m,) without the mistake
        """
        tried = found.weighed(sized_of(self.problem).log_evidence)
        for odds, wide in ((found.mistake.log_odds, self.judging), (tried.mistake.log_odds, self.alone)):
            gain = log_density(values, self.nought, wide) - log_density(self.problem.values, self.nought, wide)
            assert odds == pytest.approx(np.log(0.01) + gain, rel=1e-5, abs=1e-5)
        tail = stats.chi2(len(values)).sf(values @ np.linalg.inv(self.judging) @ values)
        assert tried.p == pytest.approx(tail, rel=1e-4, abs=1e-12)


@pytest.mark.parametrize("kind", COUNTS)
def test_other_values_are_as_probable_as_their_density(kind: str) -> None:
    """The wrong sign: |det T| = 1."""
    problem, expected = _exact(kind), dict[tuple[Mistake, tuple[int, ...], float], Array]()
    for setup in sorted(set(problem.setup.tolist())):
        expected["sign", (setup,), -1.0] = np.where(problem.setup == setup, -problem.values, problem.values)
    each = [*signs(Sought.of(problem))]
    found = {(one.mistake.mistake, one.mistake.setups, one.mistake.factor): one for one in each}
    assert found.keys() == expected.keys()
    for key, values in expected.items():
        _Without(problem).agrees(found[key], values)
        assert found[key].mistake.reading == -1


def test_two_set_ups_of_as_many_numbers_may_be_swapped() -> None:
    """Every other reading of the axis belongs to a second set-up, and then one of the first more than of the second."""
    problem = _exact("axis")
    both = replace(problem, setup=problem.reading % 2)
    assert not [*exchanges(Sought.of(both))]
    both = both.only(both.reading < 8)
    (swapped,) = exchanges(Sought.of(both))
    values = (both.values * both.noise).reshape(-1, 2)[:, ::-1].ravel() / both.noise
    _Without(both).agrees(swapped, values)
    assert (swapped.mistake.mistake, swapped.mistake.setups) == ("swapped", (0, 1))


def test_an_axis_that_counts_the_other_way_is_as_probable_as_its_covariance() -> None:
    problem = _exact("axis")
    other = replace(problem, rows=problem.rows * np.where(np.arange(problem.rows.shape[1]) % 2, 1.1, -0.7))
    found = Sought.of(problem).as_another(Explained("direction", 0.0, (), axes=("C",)), other)
    here, there = (log_density(each.values, np.zeros(9), Dense(each).judging(np.zeros(0))) for each in (problem, other))
    assert found.mistake.log_odds == pytest.approx(np.log(0.01) + there - here)
    assert found.make() is other


@pytest.mark.parametrize("factor", [1000.0, 0.001, 25.4, 1 / 25.4])
@pytest.mark.parametrize("since", [0, 1, 5])
def test_another_unit_divides_the_density_by_its_factor_for_each_number(factor: float, since: int) -> None:
    """Values drawn from the model and multiplied from a reading on: all of them at once, or from any later place."""
    problem, wide = _exact("axis"), _Without(_exact("axis")).judging
    drawn, nought = np.linalg.cholesky(wide) @ np.random.default_rng(2).standard_normal(9), np.zeros(9)
    off = replace(problem, values=np.where(problem.reading >= since, factor * drawn, drawn))
    tried = {(each.mistake.factor, each.mistake.reading): each for each in larger_units(off, sized_of(off))}
    gain = log_density(drawn, nought, wide) - log_density(off.values, nought, wide)
    log_det = -int(np.sum(problem.reading >= since)) * np.log(factor)
    places, tail = 1 if since == 0 else COUNTS["axis"] - 1, stats.chi2(9).sf(drawn @ np.linalg.inv(wide) @ drawn)
    found = tried[factor, since or -1]
    assert found.mistake.log_odds == pytest.approx(np.log(0.01 / places) + gain + log_det, rel=1e-5, abs=1e-5)
    assert found.p == pytest.approx(min(tail, 1 - tail), rel=1e-4, abs=1e-12)


def _explaining(log_odds: float, p: float = 1.0, setup: int = 0) -> Tried:
    return Tried(Explained("sign", log_odds, (setup,)), p)


@pytest.mark.parametrize(
    ("tried", "named"),
    [
        ([19.9], []),
        ([20.1], [20.1]),
        ([30.0, 1e6], [1e6]),
        ([1e5, 1e6], [1e6, 1e5]),
        ([4e4, 1e6], [1e6]),
    ],
)
def test_named_is_what_has_odds_of_twenty_beside_none_and_beside_the_best(
    tried: list[float], named: list[float]
) -> None:
    found = explained([_explaining(float(np.log(odds)), setup=setup) for setup, odds in enumerate(tried)])
    assert [each.odds for each in found] == pytest.approx(named)
    assert len(explained([_explaining(50.0), _explaining(51.0)])) == 1  # of one set-up
    assert not explained([_explaining(50.0, p=0.0004)])
    assert explained([_explaining(50.0, p=0.0006)])
    assert Explained("sign", 1e4, (0,)).odds == pytest.approx(np.exp(600.0))
    assert NAMED == 20


def _verdict(times: float, z: Array, left_out: int = 0) -> tuple[Agreement, float]:
    """Return the verdict on values drawn from the model, all of them so many times as large, and yᵀK⁻¹y."""
    problem = _exact("axis")
    covariance = _Without(problem).judging
    drawn = times * np.random.default_rng(3).standard_normal(len(problem.values))
    wider = replace(problem, values=np.linalg.cholesky(covariance) @ drawn)
    return agreement(wider, sized_of(wider), z, left_out), float(drawn @ drawn)


@pytest.mark.parametrize("times", [1.0, 1.5])
@pytest.mark.parametrize("largest", [0.5, 3.01, 3.9])
def test_agreement_is_the_smaller_of_both_tails_twice(times: float, largest: float) -> None:
    count = COUNTS["axis"]
    z = np.r_[np.full(count - 1, 0.4), largest]
    found, square = _verdict(times, z)
    tails = stats.chi2(count).sf(square), count * stats.chi2(1).sf(largest**2)
    assert found.p == pytest.approx(min(1.0, 2 * min(tails)), rel=1e-6)
    assert (found.count, found.agreeing) == (count, count - (largest > 3))
    assert found.c2 == pytest.approx(np.mean(z**2))


@pytest.mark.parametrize(("left_out", "counts"), [(0, False), (2, False), (3, True)])
def test_where_more_than_a_fifth_is_left_out_it_is_as_improbable_as_so_many_slips(left_out: int, counts: bool) -> None:
    count = COUNTS["axis"]
    plain, _ = _verdict(1.0, np.full(count, 0.4))
    found, _ = _verdict(1.0, np.full(count, 0.4), left_out)
    slips = stats.binom(count + left_out, 0.01).sf(left_out - 1)
    assert found.p == pytest.approx(min(plain.p, slips) if counts else plain.p)
    assert found.withheld == found.contradicts == (found.p < 0.001)


@pytest.mark.parametrize(
    ("c2", "count", "times"), [(1.2, 0, 1.0), (1.9, 12, 1.0), (2.1, 12, 2.1), (1.2, 8, 1.0), (0.5, 100, 1.0)]
)
def test_bands_grow_by_c2_where_its_root_is_above_one_by_two_standard_deviations(
    c2: float, count: int, times: float
) -> None:
    """The root of a mean of n squares of standard normals varies by 1/√(2n)."""
    assert Agreement(count, count, c2, 1.0).inflation == times
