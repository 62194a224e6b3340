"""The accuracy after each reading of a plan, against readings that enter one by one."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.planning.gains import covariance
from axiscal.planning.gains.covariance import RunningAccuracy, along
from axiscal.planning.plan.task import Task
from tests.generators.designs import levered, splines
from tests.planning.test_three_values import mixed


@pytest.mark.parametrize("together", [7, 80])
@pytest.mark.parametrize("asked", [splines(2, 5, 0.1, 200), levered(200), mixed(200)], ids=["sums", "levers", "mixed"])
def test_the_figures_after_each_reading_are_those_of_readings_one_by_one(
    asked: Task, together: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(covariance, "_TOGETHER", together)
    chosen = np.random.default_rng(3).permutation(len(asked.lattice))[:20]
    order, state = asked.lattice.within(np.concatenate([chosen, chosen[:3]])), asked.state
    found, meter = list(along(state, asked.yardstick, order)), RunningAccuracy.of(asked.yardstick, state.factor)
    assert len(found) == len(order)
    for i, (value, accuracy) in enumerate(found):
        state, change = state.entered(order.at(i))
        meter = meter.after(change)
        assert value == pytest.approx(state.value, rel=1e-8)
        np.testing.assert_allclose(accuracy, meter.accuracy, rtol=1e-8)


def test_of_no_reading_there_is_nothing_to_say() -> None:
    asked = splines(1, 5, 0.1, 50)
    assert not list(along(asked.state, asked.yardstick, asked.lattice.within(slice(0, 0))))
