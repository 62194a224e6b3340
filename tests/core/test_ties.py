"""Ties: what differs by rounding is equal, and the first of equals is taken."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from axiscal_core.ties import first_best, first_best_each, ranked, surely_more

SHARE = 1e-9
LEVELS = st.lists(st.integers(1, 6), min_size=1, max_size=30)
NOISE = st.integers(0, 2**32 - 1)


def _noisy(levels: list[int], seed: int) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return np.array(levels) * (1 + 1e-12 * np.random.default_rng(seed).uniform(-1, 1, len(levels)))


@given(LEVELS, NOISE)
def test_rounding_changes_neither_the_best_nor_the_order(levels: list[int], seed: int) -> None:
    values = _noisy(levels, seed)
    assert first_best(values, SHARE) == levels.index(max(levels))
    assert first_best_each(np.array([values, values]), SHARE).tolist() == [levels.index(max(levels))] * 2
    expected = sorted(range(len(levels)), key=lambda i: -levels[i])
    assert ranked(values, SHARE).tolist() == expected
    assert ranked(values, SHARE, 4).tolist() == expected[:4]
    assert not surely_more(values, np.array(levels, dtype=float), SHARE).any()


def test_what_cannot_be_is_never_first() -> None:
    values = np.array([-np.inf, 1.0, -np.inf, 1.0 + 1e-13, 2.0, -np.inf])
    assert ranked(values, SHARE).tolist() == [4, 1, 3, 0, 2, 5]
    assert ranked(values, SHARE, 5).tolist() == [4, 1, 3, 0, 2]
    assert ranked(np.full(3, -np.inf), SHARE, 1).tolist() == [0]
    assert first_best(values, SHARE) == 4
    assert surely_more(np.array([1.0]), np.array([-np.inf]), SHARE).all()
