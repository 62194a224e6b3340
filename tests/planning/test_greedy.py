"""Set-ups that cannot win are not looked at, and the choice is the one among all."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from axiscal.planning.plan.greedy import Setups, of_best_size
from axiscal_core.state import unexplained

EACH_BRINGS = 1e-3
"""Share of J that a set-up more must bring."""


@given(st.lists(st.floats(0.0, 0.5), min_size=1, max_size=80), st.integers(0, 80))
def test_the_best_size_is_that_of_all_sets_and_few_larger_ones_are_made(brings: list[float], last: int) -> None:
    """By looking at every size: parts bring ever less, and from some size on hardly anything."""
    worth = [max(each, 2 * EACH_BRINGS) for each in sorted(brings, reverse=True)][:last] + [0.0] * (80 - last)
    left = np.cumprod([1.0, *(1 - np.array(worth))])
    made = list[int]()

    def growing() -> Iterator[Setups]:
        for size in range(1, len(left) + 1):
            made.append(size)
            yield tuple(range(size))

    best = len(of_best_size(growing(), lambda setups: float(left[len(setups) - 1])))
    hardly = [size for size in range(1, len(left)) if left[size] >= (1 - EACH_BRINGS) * left[size - 1]]
    assert best == min(hardly, default=len(left))
    assert max(made) <= max(4, 2 * best + 2)


@given(st.integers(0, 2**32 - 1), st.integers(1, 30), st.integers(1, 12))
def test_what_readings_leave_follows_from_the_columns_that_they_feel(seed: int, readings: int, felt: int) -> None:
    rng = np.random.default_rng(seed)
    weighted, rows = rng.normal(size=(3, 20)), np.zeros((readings, 20))
    rows[:, rng.permutation(20)[:felt]] = 10.0 ** rng.uniform(-2, 2) * rng.normal(size=(readings, felt))
    dense = np.trace(weighted @ np.linalg.inv(np.eye(20) + rows.T @ rows) @ weighted.T)
    np.testing.assert_allclose(np.sum(unexplained(weighted, rows) * weighted), dense, rtol=1e-9)
