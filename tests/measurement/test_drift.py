"""Zeros that wander: the mathematics against a plain integral, the estimate, the markers, and the clock."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import CampaignDescription
from axiscal.description.placed_readings import placed_readings
from axiscal.estimation.case import Case
from axiscal.measurement.readers.files import read_any
from axiscal.measurement.reading import Place, Reading
from axiscal.numerics import Array
from axiscal.planning.other_readings import planned_with_markers, with_markers, without_markers
from axiscal.planning.plan.task import Limits
from axiscal.planning.promise import EVERY
from axiscal.present.findings import untimed
from axiscal.record.events import Recorded
from axiscal.record.payload import decode, encode
from axiscal_core.causes import MEMORY, wandered
from tests.generators.campaigns import built_in

RATE = 6e-6 / 3600
CAMPAIGN = """machine = "one-axis"
[target]
readings = {readings}
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
approach = "both"
setup_time = "0 min"
reading_time = "2 min"
{drift}
"""


def _description(drift: str = 'drift = "6 um/h"', readings: int = 40) -> CampaignDescription:
    return built_in(CAMPAIGN.format(drift=drift, readings=readings))


def _by_steps(times: Array) -> Array:
    """The covariance of ∫ rate, the rate's correlation exp(−|s − t|/T) summed up in steps of ten seconds."""
    steps = np.arange(5.0, float(np.max(times)), 10.0)
    rates = RATE**2 * np.exp(-np.abs(steps[:, None] - steps[None, :]) / MEMORY)
    until = 10.0 * (steps[None, :] < times[:, None])
    return until @ rates @ until.T


def _in_closed_form(times: Array) -> Array:
    """The same, r²T² (2 min(s, t)/T − 1 + exp(−s/T) + exp(−t/T) − exp(−|s − t|/T))."""
    x = times / MEMORY
    ends, apart = np.exp(-x), np.exp(-np.abs(x[:, None] - x))
    return (RATE * MEMORY) ** 2 * (2 * np.minimum(x[:, None], x) - 1 + ends[:, None] + ends - apart)


def test_a_wandering_zero_is_the_integral_of_a_rate_that_forgets_itself() -> None:
    times = np.array([0.0, 60.0, 600.0, 3600.0, 3610.0, 20000.0])
    assert _in_closed_form(times) == pytest.approx(_by_steps(times), rel=1e-3, abs=1e-20)
    assert wandered(RATE, times) == pytest.approx(np.diagonal(_in_closed_form(times)), rel=1e-9, abs=1e-20)
    assert np.sqrt(wandered(RATE, 3600.0)) == pytest.approx(6e-6, rel=0.2)


def test_readings_that_do_not_tell_their_times_are_named_where_the_zero_may_drift() -> None:
    drifting, still = _description().setups, _description('drift = "0"').setups
    timed = Reading("laser", (0.1,), (1,), 0.0, time=5.0)
    (found,) = untimed([timed, replace(timed, time=None)], drifting)
    assert found.code == "drift"
    assert "add a column time" in found.text
    assert untimed([timed], drifting) == untimed([replace(timed, time=None)], still) == []


def test_a_marker_is_read_again_every_twenty_minutes() -> None:
    problem = Case(_description())
    places = [Place("laser", (0.01 * i,), (1,)) for i in range(40)]
    marked = with_markers(problem, (), (), places)
    again = [i for i, place in enumerate(marked) if place == places[0]]
    assert again[0] == 0
    seconds = 122.0  # of a reading, at least
    assert all((later - one - 1) * seconds <= EVERY + seconds for one, later in pairwise(again))
    assert len(again) == 4
    assert [place for place in marked if place != places[0]] == places[1:]
    first = Reading("laser", places[0].pose, (1,), 0.0, time=0.0)
    assert without_markers(problem, [first], marked) == tuple(places[1:])


@pytest.mark.parametrize(("left", "searches"), [(36, 1), (5, 2)])
def test_markers_are_counted_from_what_is_left_and_anew_where_a_plan_has_more(left: int, searches: int) -> None:
    problem, asked = Case(_description()), list[int]()
    places = tuple(Place("laser", (0.01 * i,), (1,)) for i in range(40))

    def plan(limits: Limits, _: Sequence[Place]) -> tuple[Place, ...]:
        asked.append(limits.readings or 0)
        return places[: limits.readings]

    found = planned_with_markers(problem, (), (), Limits(40), places[:left], plan)
    assert len(found) == 40
    assert found == with_markers(problem, (), (), places[: asked[-1]])
    assert len(asked) == searches


def test_a_reading_that_a_person_records_keeps_the_clock_and_old_records_have_none(tmp_path: Path) -> None:
    with Campaign.create(tmp_path / "c.axiscal", _description(readings=4)) as campaign:
        campaign.next()
        first = campaign.record(1e-6)
        campaign.next()
        second = campaign.record(1e-6)
    assert first.time is not None
    assert second.time is not None
    assert 0.0 <= first.time <= second.time < 600.0
    event = Recorded(replace(first, number=None))  # the record counts readings, it does not keep their numbers
    assert decode(*encode(event)) == event
    old = '{"setup": "laser", "position": [0.1], "approach": [1], "value": 1e-6, "std": null}'
    assert decode("recorded", old) == Recorded(Reading("laser", (0.1,), (1,), 1e-6))


@pytest.mark.parametrize(
    ("times", "seconds"),
    [
        (("10:30", "10:31:30", "12:00:00.5"), (0.0, 90.0, 5400.5)),
        (("2026-11-20T23:59:00", "2026-11-21T00:01:00", "2026-11-21T00:01:00"), (0.0, 120.0, 120.0)),
        (("2026-11-20 10:00:00+01:00", "2026-11-20 10:00:00Z", "2026-11-20T12:00:00+01:00"), (0.0, 3600.0, 7200.0)),
        (("5 min", "0.5 h", "3600 s"), (0.0, 1500.0, 3300.0)),
    ],
)
def test_a_table_of_readings_may_say_when_they_were_taken(
    tmp_path: Path, times: tuple[str, ...], seconds: tuple[float, ...]
) -> None:
    file = tmp_path / "readings.csv"
    file.write_text("setup,X_mm,value_um,time\n" + "".join(f"laser,{100 * i},1,{t}\n" for i, t in enumerate(times)))
    placed = placed_readings(read_any(file), _description(), file)
    assert [reading.time for reading in placed] == pytest.approx(seconds)
