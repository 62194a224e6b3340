"""Many readings absorbed at once are the same as one after the other: belief, innovations, and the history of both."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

from axiscal.estimation.case import NO_GOAL, Case, Knowledge
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import path
from axiscal.estimation.history import History
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import seen
from axiscal_core.normal import Normal
from tests.generators import laser_axis
from tests.generators.campaigns import drawn, mixed


class Twin(NamedTuple):
    """What is known after some readings, by what the last one surprised, and the standard deviation of that."""

    case: Case
    knowledge: Knowledge
    away: float = 0.0
    std: float = 0.0


def _after_one(before: Twin, reading: Reading, counts: bool) -> Twin:
    """What is known after one reading more, by one plain update."""
    known, case = before.knowledge, before.case
    numbers, values = seen(known.observation, [reading])
    opened = known.state(NO_GOAL).opened(numbers)
    rows, belief = opened.wide(numbers), known.belief.wider(np.zeros(len(opened.root) - known.belief.size))
    belief = Normal.of_factor(belief.mean, opened.root)
    expected = belief.through(rows)
    away, std = values - expected.mean, np.hypot(expected.std, numbers.noise)
    belief = belief.read(rows, values, numbers.noise**2) if counts else belief
    if reading.setup not in case.both and not case.came_as_allowed(reading):
        case = replace(case, both=case.both | {reading.setup})
    return Twin(
        case,
        Knowledge(known.observation, belief, [(rest, cell) for rest, cell in opened.cells.tolist()]),
        float(away[0]),
        float(std[0]),
    )


def test_the_history_is_what_was_known_after_each_reading(monkeypatch: pytest.MonkeyPatch) -> None:
    """Seven at once; they begin to come from sides that nobody told only after eight of them, and one is bad."""
    monkeypatch.setattr("axiscal.estimation.history.AT_ONCE", 7)
    drifting = mixed('usual = "off"\nsure = "exactly"').description
    still = tuple(replace(setup, drift=0.0) for setup in drifting.setups)
    case = Case(replace(drifting, setups=still))
    readings = [replace(r, approach=(1, 1, -1)) if i < 8 else r for i, r in enumerate(drawn(case, 24))]
    readings[15] = replace(readings[15], value=2.0)
    known = concluded(case, readings)
    moments, final, implausible = path(known), known.history, known.implausible
    twin = Twin(final.case, final.case.knowledge)
    assert 15 in implausible
    assert len(moments) == 25
    assert moments[0] == (known.stated.yardstick.measure(known.stated.prior), 0.0, None)
    for count, moment in enumerate(moments[1:], start=1):
        twin = _after_one(twin, readings[count - 1], count - 1 not in final.left_out)
        assert moment.seconds == known.timed.ends[count - 1]
        if count < 24:
            expected = twin.case.yardstick.measure(twin.knowledge.belief)
            np.testing.assert_allclose(moment.accuracy, expected, rtol=1e-8)
        assert moment.surprise == pytest.approx((twin.away, twin.std), rel=1e-6, abs=1e-6 * twin.std)
    assert twin.case.both == {"probe", "nest"}
    assert moments[24].accuracy == known.accuracy
    assert moments[24].seconds == known.timed.seconds


@pytest.mark.parametrize("slip", [0.0, 20e-6])
def test_the_surprise_of_the_last_reading_is_by_what_it_differs_from_all_before(slip: float) -> None:
    readings = laser_axis.read(laser_axis.machine(1), 12)
    readings[-1] = replace(readings[-1], value=readings[-1].value + slip)
    twin = Twin(laser_axis.CASE, laser_axis.CASE.knowledge.read([*readings[:3], *readings[4:-1]]))
    twin = _after_one(twin, readings[-1], counts=True)
    assert History(laser_axis.CASE, readings, frozenset([3])).surprise(11) == pytest.approx(
        abs(twin.away) / twin.std, rel=1e-6
    )
