"""When readings were taken: the ways of all readings at once are those from one to the next."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.estimation.case import Case
from axiscal.estimation.timed import Timed, elapsed, timed
from axiscal.measurement.reading import Reading
from axiscal.measurement.travel import first_seconds, reading_seconds, way_seconds
from tests.generators.campaigns import drawn, mixed
from tests.generators.laser_axis import CASE, machine, read

CASES = {
    "set-ups in turn": (mixed(), drawn(mixed())),
    "one set-up after the other": (mixed(), sorted(drawn(mixed()), key=lambda reading: reading.setup)),
    "one axis": (CASE, read(machine(3), 24)),
}


def _one_by_one(case: Case, readings: list[Reading]) -> list[float]:
    """Return when each reading ended, way after way: the naive way."""
    now, ends, last = 0.0, list[float](), None
    for reading in readings:
        setup = case.description.setup(reading.setup)
        if last is None or last.setup != reading.setup:
            now += first_seconds(setup)
        else:
            here, there = np.array(last.pose), np.array(reading.pose)
            sides = np.array(reading.approach or np.zeros(len(there)), dtype=float)
            now += float(way_seconds(case.description.machine, setup, here, there, sides)) + reading_seconds(setup)
        ends.append(now)
        last = reading
    return ends


@pytest.mark.parametrize("name", CASES)
def test_all_at_once_take_the_time_of_one_after_the_other(name: str) -> None:
    case, given = CASES[name]
    readings = [replace(reading, time=None) for reading in given]
    expected = _one_by_one(case, readings)
    found = timed(case, readings)
    np.testing.assert_allclose(found.ends, expected, rtol=1e-12)
    assert [reading.time for reading in found.readings] == [*found.ends]


def test_a_time_that_was_read_off_a_clock_stays() -> None:
    case, readings = CASES["one axis"]
    found = timed(case, readings)
    assert found.readings == tuple(readings)
    assert timed(case, ()) == Timed()


@pytest.mark.parametrize("count", [0, 1, 9])
def test_places_to_come_are_reached_from_the_last_reading(count: int) -> None:
    case, given = CASES["set-ups in turn"]
    readings = [replace(reading, time=None) for reading in given[:12]]
    after = elapsed(case, timed(case, readings[:count]), [reading.place for reading in readings[count:]])
    assert after == pytest.approx(_one_by_one(case, readings)[-1], rel=1e-12)
