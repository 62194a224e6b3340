"""Gains of a lattice and accuracies of a plan kept up to date, against those computed anew."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.planning.gains import covariance
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.covariance import ReadNumbers, after_each
from axiscal.planning.gains.running_gains import Scores
from axiscal.planning.plan.task import Task
from tests.generators.designs import levered, splines
from tests.planning.test_three_values import mixed


def test_a_factor_stays_narrow_however_often_readings_leave() -> None:
    asked = levered(100)
    state = asked.state.opened(asked.lattice.single(0))
    rows, variances, _ = state.rows(asked.lattice.single(0))
    row, variance = rows[0], float(variances[0])
    value = state.value
    for _ in range(80):
        state = state.changed_by(ReadNumbers(row[None], np.array([variance])))[0]
        state = state.changed_by(ReadNumbers(row[None], np.array([variance]), leaving=True))[0]
    assert state.factor.shape[1] <= state.factor.shape[0] + 48
    assert state.value == pytest.approx(value, rel=1e-8, abs=0.0)


@pytest.mark.parametrize(
    "asked", [levered(150), mixed(150), splines(1, 4, 0.1, 60)], ids=["levers", "three values", "fewer unknowns"]
)
def test_readings_that_enter_together_are_those_that_enter_one_by_one(asked: Task) -> None:
    one, together = (Scores(Pool(asked.observation, asked.lattice), asked.state) for _ in range(2))
    together.enter(0)
    together.without(0)
    together.leave(0)
    places = asked.lattice.within(np.arange(0, 50, 5))
    gains = sum(one.enter(places.single(index)) for index in range(len(places)))
    assert together.enter_all(places) == pytest.approx(gains, rel=1e-9, abs=0.0)
    np.testing.assert_allclose(together.gains, one.gains, rtol=1e-7)
    np.testing.assert_allclose(together.losses(), one.losses(), rtol=1e-6)
    (expected, own), (found, same) = one.without(3), together.without(3)
    np.testing.assert_allclose(found, expected, rtol=1e-6)
    assert same == pytest.approx(own, rel=1e-6, abs=0.0)
    assert together.state.factor.shape == one.state.factor.shape
    assert together.enter_all(places.within(slice(0, 0))) == 0.0


@pytest.mark.parametrize("together", [7, 80])
@pytest.mark.parametrize("asked", [splines(2, 5, 0.1, 200), levered(200), mixed(200)], ids=["sums", "levers", "mixed"])
def test_the_figures_after_each_reading_are_those_of_readings_one_by_one(
    asked: Task, together: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(covariance, "_TOGETHER", together)
    chosen = np.random.default_rng(3).permutation(len(asked.lattice))[:20]
    order, state = asked.lattice.within(np.concatenate([chosen, chosen[:3]])), asked.state
    found = list(after_each(state, asked.yardstick, order))
    assert len(found) == len(order)
    for i, (value, accuracy) in enumerate(found):
        state, _ = state.entered(order.single(i))
        assert value == pytest.approx(state.value, rel=1e-8, abs=0.0)
        np.testing.assert_allclose(accuracy, asked.yardstick.measure_factor(state.factor), rtol=1e-8)
