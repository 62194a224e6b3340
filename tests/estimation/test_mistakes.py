"""Each mistake is as probable as the dense density of the readings without it says; what is named puts them right."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy import stats
from scipy.special import logsumexp

from axiscal.estimation.promise.agreement import (
    NAMED,
    Agreement,
    Explained,
    Mistake,
    Tried,
    _against,
    _explained,
    _turned,
    _units,
    agreement,
)
from axiscal.numerics import Array
from axiscal_core.draws import Weighed
from axiscal_core.draws import sized as weighed_of
from axiscal_core.problem import Problem
from axiscal_core.unknowns import space_of
from tests.generators.dense_posterior import Dense, log_density
from tests.generators.problems import asked, sized

COUNTS = {"axis": 9, "two set-ups": 8}


@cache
def _learning(kind: str, sizes: tuple[str, ...] = ()) -> tuple[Problem, Weighed]:
    """Return readings with three draws of some sizes; without any, one draw has all the weight."""
    problem = sized(asked(kind, COUNTS[kind], 5), sizes)
    found = weighed_of(problem)
    if not sizes:
        return problem, found
    thetas, space = np.array([-0.4, 0.1, 0.3])[:, None] * np.ones(len(problem.sizes)), space_of(problem)
    given = tuple(each for theta in thetas if (each := space.given(theta)) is not None)
    return problem, replace(found, thetas=thetas, weights=np.array([0.2, 0.5, 0.3]), given=given)


class _Without:
    """What readings are without a mistake: values y' of density |det T| p(y'), or y of a covariance K + B Bᵀ."""

    def __init__(self, problem: Problem, found: Weighed) -> None:
        self.values, self.weights = problem.values, found.weights
        self.covariances = [Dense(problem).judging(theta) for theta in found.thetas]

    def odds(self, values: Array, places: int = 1) -> tuple[float, float]:
        """Return the log odds of 1 % before, the sizes integrated out, and how probable a worse agreement is then."""
        return self.odds_of(values, self.covariances, places)

    def odds_of(self, values: Array, wide: Sequence[Array], places: int = 1) -> tuple[float, float]:
        """Return the same for a covariance of each draw instead of those of the readings as they are."""
        nought = np.zeros(len(values))
        gains = np.array([
            log_density(values, nought, other) - log_density(self.values, nought, each)
            for each, other in zip(self.covariances, wide, strict=True)
        ])  # fmt: skip
        tails = [stats.chi2(len(values)).sf(values @ np.linalg.inv(other) @ values) for other in wide]
        logs = np.log(self.weights) + gains
        whole = logsumexp(logs)
        return float(np.log(0.01 / places) + whole), float(np.exp(logs - whole) @ tails)


def _agrees(found: Tried, expected: tuple[float, float]) -> None:
    assert found.mistake.log_odds == pytest.approx(expected[0], rel=1e-5, abs=1e-5)
    assert found.p == pytest.approx(expected[1], rel=1e-4, abs=1e-12)


@pytest.mark.parametrize(("kind", "sizes"), [("axis", ()), ("axis", ("std", "noise")), ("two set-ups", ())])
def test_other_values_are_as_probable_as_their_density(kind: str, sizes: tuple[str, ...]) -> None:
    """The wrong sign: |det T| = 1."""
    problem, weighed = _learning(kind, sizes)
    without, expected = _Without(problem, weighed), dict[tuple[Mistake, tuple[int, ...], float], Array]()
    for setup in sorted(set(problem.setup.tolist())):
        expected["sign", (setup,), -1.0] = np.where(problem.setup == setup, -problem.values, problem.values)
    found = {(each.mistake.mistake, each.mistake.setups, each.mistake.factor): each
             for each in _turned(problem, weighed)}  # fmt: skip
    assert found.keys() == expected.keys()
    for key, values in expected.items():
        _agrees(found[key], without.odds(values))
        assert found[key].mistake.reading == -1


def test_two_set_ups_of_as_many_numbers_may_be_swapped() -> None:
    """Every other reading of the axis belongs to a second set-up, and then one of the first more than of the second."""
    problem, weighed = _learning("axis")
    both = replace(problem, setup=problem.reading % 2)
    assert "swapped" not in {each.mistake.mistake for each in _turned(both, weighed)}
    both = both.only(both.reading < 8)
    weighed = weighed_of(both)
    (swapped,) = (each for each in _turned(both, weighed) if each.mistake.mistake == "swapped")
    values = (both.values * both.noise).reshape(-1, 2)[:, ::-1].ravel() / both.noise
    _agrees(swapped, _Without(both, weighed).odds(values))
    assert swapped.mistake.setups == (0, 1)


@pytest.mark.parametrize("sizes", [(), ("std", "noise")])
def test_an_axis_that_counts_the_other_way_is_as_probable_as_its_covariance(sizes: tuple[str, ...]) -> None:
    problem, weighed = _learning("axis", sizes)
    other = replace(problem, rows=problem.rows * np.where(np.arange(problem.rows.shape[1]) % 2, 1.1, -0.7))
    (found,) = _against(problem, weighed, [(("C",), other)])
    covariances = [Dense(other).judging(theta) for theta in weighed.thetas]
    _agrees(found, _Without(problem, weighed).odds_of(problem.values, covariances))
    assert (found.mistake.mistake, found.mistake.axes) == ("direction", ("C",))


@pytest.mark.parametrize("factor", [1000.0, 0.001, 25.4, 1 / 25.4])
@pytest.mark.parametrize("since", [0, 1, 5])
def test_another_unit_divides_the_density_by_its_factor_for_each_number(factor: float, since: int) -> None:
    """Values drawn from the model and multiplied from a reading on: all of them at once, or from any later place."""
    problem, weighed = _learning("axis")
    (covariance,) = _Without(problem, weighed).covariances
    drawn = np.linalg.cholesky(covariance) @ np.random.default_rng(2).standard_normal(len(problem.values))
    off = replace(problem, values=np.where(problem.reading >= since, factor * drawn, drawn))
    weighed = weighed_of(off)
    tried = {(each.mistake.factor, each.mistake.reading): each for each in _units(off, weighed)}
    log_odds, tail = _Without(off, weighed).odds(drawn, 1 if since == 0 else COUNTS["axis"] - 1)
    log_det = -int(np.sum(problem.reading >= since)) * np.log(factor)
    _agrees(tried[factor, since or -1], (log_odds + log_det, min(tail, 1 - tail)))


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
    found = _explained([_explaining(float(np.log(odds)), setup=setup) for setup, odds in enumerate(tried)])
    assert [each.odds for each in found] == pytest.approx(named)
    assert len(_explained([_explaining(50.0), _explaining(51.0)])) == 1  # of one set-up
    assert not _explained([_explaining(50.0, p=0.0004)])
    assert _explained([_explaining(50.0, p=0.0006)])
    assert Explained("sign", 1e4, (0,)).odds == pytest.approx(np.exp(600.0))
    assert NAMED == 20


def _verdict(times: float, z: Array, left_out: int = 0) -> tuple[Agreement, float]:
    """Return the verdict on values drawn from the model, all of them so many times as large, and yᵀK⁻¹y."""
    problem, weighed = _learning("axis")
    (covariance,) = _Without(problem, weighed).covariances
    drawn = times * np.random.default_rng(3).standard_normal(len(problem.values))
    wider = replace(problem, values=np.linalg.cholesky(covariance) @ drawn)
    return agreement(wider, weighed_of(wider), z, left_out), float(drawn @ drawn)


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
