"""Set-ups that cannot win are not looked at, and the choice is the one among all."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.machine import load_machine
from axiscal.planning.gains.covariance import criterion_after
from axiscal.planning.next_readings import posed
from axiscal.planning.plan import greedy
from axiscal.planning.plan.greedy import Setups, chosen_setups, filled, of_best_size, scores_among
from axiscal.planning.plan.task import Limits
from tests.generators.texts import Said, setup_text

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
    assert max(made) <= max(16, 2 * best + 2)


@given(st.integers(0, 2**32 - 1), st.integers(1, 30), st.integers(1, 12))
def test_what_readings_leave_follows_from_the_columns_that_they_feel(seed: int, readings: int, felt: int) -> None:
    rng = np.random.default_rng(seed)
    weighted, rows = rng.normal(size=(3, 20)), np.zeros((readings, 20))
    rows[:, rng.permutation(20)[:felt]] = 10.0 ** rng.uniform(-2, 2) * rng.normal(size=(readings, felt))
    dense = np.trace(weighted @ np.linalg.inv(np.eye(20) + rows.T @ rows) @ weighted.T)
    np.testing.assert_allclose(criterion_after(weighted, rows), dense, rtol=1e-9)


@pytest.mark.long
@pytest.mark.parametrize("limits", [Limits(readings=4), Limits(readings=40)])
def test_of_many_set_ups_those_are_chosen_that_leave_no_more_than_looking_at_all_sizes(
    monkeypatch: pytest.MonkeyPatch, limits: Limits
) -> None:
    """Where one reading is as good as another, either way of looking may end at another size: J tells less than 1 %."""
    mill = load_machine("three-axis-mill").text
    case = Case(campaign_from_texts(_many(20), "campaign.toml", mill, "three-axis-mill"))
    left = list[float]()
    for sizes in (greedy._SIZES, 1000):
        monkeypatch.setattr(greedy, "_SIZES", sizes)
        task = posed(case, case.knowledge, candidates=500)
        chosen, readings = chosen_setups(task, limits), limits.readings or 0
        left.append(filled(scores_among(task, chosen), readings, chosen).state.value)
    assert left[0] <= 1.005 * left[1]


def _many(count: int) -> str:
    """Return a campaign of straight lines along X, each at another height, read by three instruments in turn."""
    kinds = [("interferometer", "x"), ("autocollimator", "y"), ("autocollimator", "z")]
    parts = ['machine = "three-axis-mill"\n[target]\nreadings = 4\n']
    for number in range(count):
        instrument, direction = kinds[number % 3]
        park: Said = {"Y": f"{20 + 37 * number % 360} mm", "Z": f"{20 + 53 * number % 260} mm"}
        parts.append(setup_text(f"line {number}", instrument, direction=direction, moves=["X"], park=park))
    return "".join(parts)
