"""What a departure does when it is just seen, against scipy and against its own definition."""

from __future__ import annotations

import math

import numpy as np
import pytest
from axiscal.accuracy.damage import FALSE_ALARM, KAPPA, Harm, bearable, hidden, needed
from scipy import stats


@pytest.mark.parametrize(("degrees", "value"), [(1, 15.365), (2, 17.948), (3, 19.796)])
def test_what_is_needed_is_seen_with_ninety_percent(degrees: int, value: float) -> None:
    assert needed(degrees) == pytest.approx(value, abs=2e-3)
    limit = stats.chi2.isf(FALSE_ALARM, degrees)
    assert stats.ncx2.sf(limit, degrees, needed(degrees)) == pytest.approx(0.9, abs=1e-9)


def test_at_the_damage_a_promise_of_that_size_sees_what_makes_it_wrong_by_half() -> None:
    effect = Harm(np.array([[4e12]]), 0.09, 1e-3)
    assert effect.power(effect.damage) == pytest.approx(0.9, abs=1e-9)
    size = math.sqrt((KAPPA**2 - 1) / effect.wrong) * effect.damage
    assert size == pytest.approx(effect.seen_from)
    assert math.sqrt(effect.damage**2 + size**2 * effect.wrong) == pytest.approx(KAPPA * effect.damage)


def test_what_nothing_shows_does_what_its_largest_size_does() -> None:
    effect = Harm(np.zeros((1, 1)), 0.25, 20e-6)
    assert effect.damage == pytest.approx(10e-6)
    assert effect.seen_from == math.inf
    assert effect.power(1e-6) == pytest.approx(FALSE_ALARM)


def test_of_two_columns_the_phase_that_is_seen_least_counts() -> None:
    effect = Harm(np.array([[3e12, 1e12], [1e12, 3e12]]), 0.5, 5e-6)
    assert effect.seen_from == pytest.approx(math.sqrt(needed(2) / 2e12))


def test_what_leaves_no_error_is_no_danger() -> None:
    effect = Harm(np.array([[1e12]]), 0.0, 5e-6)
    assert effect.damage == 0.0
    assert effect.power(1e-6) == 1.0


def test_what_only_an_absurd_size_would_show_is_not_seen_from_any() -> None:
    assert Harm(np.array([[1e-20]]), 0.25, 20e-6).seen_from == math.inf


def test_the_promise_that_departures_may_spoil_is_where_so_many_of_them_do() -> None:
    """Three places, one of which nothing shows, by an average of many sizes."""
    information, wrong, std = np.array([0.0, 4e10, 1e14]), np.array([0.2, 0.1, 0.3]), 10e-6
    harms = [Harm(np.array([[each]]), w, std) for each, w in zip(information, wrong, strict=True)]
    sizes = std * np.random.default_rng(1).standard_normal((200_000, 1))
    spoilt = np.sqrt(sizes**2 * wrong / (KAPPA**2 - 1))
    unseen = stats.ncx2.cdf(stats.chi2.isf(FALSE_ALARM, 1), 1, np.maximum(sizes**2 * information, 1e-300))
    for share in (0.05, 0.2):
        promise = bearable(harms, std, share)
        assert hidden(harms, std, promise) <= share < hidden(harms, std, promise * (1 - 1e-9))
        assert float(np.mean(unseen * (spoilt > promise))) == pytest.approx(share, abs=0.02)
    assert bearable(harms, std, 0.9) == 0.0
