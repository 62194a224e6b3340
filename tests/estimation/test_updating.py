"""Many readings absorbed at once are the same as one after the other: belief, innovations, and the history of both."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import path, paths
from axiscal.estimation.knowledge import Innovations, Knowledge
from axiscal.estimation.located import absorbed
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import seen
from tests.generators import laser_axis
from tests.generators.campaigns import drawn, mixed


class Twin(NamedTuple):
    """What is known after some readings, and by what the last one surprised."""

    case: Case
    knowledge: Knowledge
    surprise: Innovations | None = None


def _after_one(before: Twin, reading: Reading, counts: bool) -> Twin:
    """What is known after one reading more, by one plain update."""
    opened = before.knowledge.opened([reading])
    numbers = seen(opened.observation, [reading])
    expected = opened.belief.through(numbers.rows)
    surprise = Innovations(numbers.values - expected.mean, np.hypot(expected.std, np.sqrt(numbers.variances)))
    belief = opened.belief.read(numbers.rows, numbers.values, numbers.variances) if counts else opened.belief
    case = before.case
    if reading.setup not in case.both and not case.came_as_allowed(reading):
        case = replace(case, both=case.both | {reading.setup})
    return Twin(case, Knowledge(opened.observation, belief), surprise)


def test_the_history_is_what_was_known_after_each_reading(monkeypatch: pytest.MonkeyPatch) -> None:
    """Seven at once; they begin to come from sides that nobody told only after eight of them, and one is bad."""
    monkeypatch.setattr("axiscal.estimation.knowledge.AT_ONCE", 7)
    case = mixed('usual = "off"\nsure = "exactly"')
    readings = [replace(r, approach=(1, 1, -1)) if i < 8 else r for i, r in enumerate(drawn(case, 24))]
    readings[15] = replace(readings[15], value=2.0)
    known = concluded(case, readings)
    moments, final, implausible = path(known), known.absorbed, known.implausible
    twin = Twin(final.case, final.case.knowledge)
    assert 15 in implausible
    assert len(moments) == 25
    assert moments[0] == (known.stated.yardstick.measure(known.stated.prior), None, 0.0)
    for count, moment in enumerate(moments[1:], start=1):
        twin = _after_one(twin, readings[count - 1], count - 1 not in final.left_out)
        assert moment.seconds == known.timed.ends[count - 1]
        if count < 24:
            expected = twin.case.yardstick.measure(twin.knowledge.belief)
            np.testing.assert_allclose(moment.accuracy, expected, rtol=1e-8)
        assert moment.innovations is not None
        assert twin.surprise is not None
        np.testing.assert_allclose(moment.innovations.std, twin.surprise.std, rtol=1e-8)
        sizes = moment.innovations.value - twin.surprise.value
        assert np.all(np.abs(sizes) < 1e-6 * moment.innovations.std + 1e-8 * np.abs(moment.innovations.value))
    assert twin.case.both == {"probe", "nest"}
    assert len(paths(known, case.description.setup("nest"))) == 3  # each number drifts on its own
    assert moments[24].accuracy == known.accuracy
    assert moments[24].seconds == known.timed.seconds


@pytest.mark.parametrize("slip", [0.0, 20e-6])
def test_the_surprise_of_the_last_reading_is_by_what_it_differs_from_all_before(slip: float) -> None:
    readings = laser_axis.read(laser_axis.machine(1), 12)
    readings[-1] = replace(readings[-1], value=readings[-1].value + slip)
    known = absorbed(laser_axis.CASE, readings, [3])
    last = known.blocks[-1].innovations[-1]
    assert known.surprise(11) == pytest.approx(float(np.abs(last.value[0]) / last.std[0]), rel=1e-6)
