"""What readings suffer with time: when it is there, and ways from one to the next.

How large it is the golden results say.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from axiscal.estimation.case import Case, Timed, elapsed, timed
from axiscal.estimation.estimate import posed
from axiscal.estimation.promise.causes import passing_columns
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import places_of, times_of
from axiscal.measurement.travel import reading_seconds, way_seconds
from axiscal.numerics import Array
from tests.generators.campaigns import built_in, drawn, mixed
from tests.generators.laser_axis import CASE, machine, read
from tests.generators.texts import campaign_text, setup_text

AT = (0.1, 0.3, 0.45, 0.2, 0.15, 0.2, 0.417, 0.2, 0.2)
SIDES = (1, 1, 1, 1, -1, -1, 1, -1, -1)


def axis(approach: str = "both", usual: str = "on") -> Case:
    """Return an axis with a reversal of 4 um under a laser."""
    laser = setup_text("laser", "interferometer", direction="x", approach=approach, noise="0.5 um")
    return Case(built_in(campaign_text("one-axis", laser, target={"readings": 20}, usual=usual)))


OUT_AND_BACK = [
    Reading("laser", (at,), (side,), 0.0, time=60.0 * n) for n, (at, side) in enumerate(zip(AT, SIDES, strict=True))
]


def test_it_is_there_where_both_sides_are_read_and_what_usually_goes_wrong_counts() -> None:
    assert "way" in {size.kind for size in axis().sizes.of}
    assert "way" in {scale.kind for scale in posed(axis(), OUT_AND_BACK).scales}
    assert "way" not in {scale.kind for scale in posed(axis(approach="+"), OUT_AND_BACK).scales}
    assert "way" not in {size.kind for size in axis(usual="off").sizes.of}


def _since_it_turned(begun: float, overrun: float) -> list[float]:
    """Return how far an axis has come since it turned: the way that it goes, stop by stop, and then back along it."""
    stops, found = [begun], list[float]()
    for place, side in zip(AT, SIDES, strict=True):
        stands = place == stops[-1] and (stops[-1] > stops[-2]) == (side > 0)
        past = [] if stands or (place - stops[-1]) * side > 0 else [place - side * overrun]
        stops += [*past, *([] if stands else [place])]
        way = 0.0
        for one, other in zip(stops[-2::-1], stops[:0:-1], strict=True):
            if (other - one) * side < 0:
                break
            way += abs(other - one)
        found.append(way)
    return found


def test_a_part_of_a_reversal_is_missing_as_long_as_the_axis_has_not_come_far_since_it_turned() -> None:
    """Where it turned before the first reading nobody knows: all shares that a way leaves are alike."""
    problem, overrun = posed(axis(), OUT_AND_BACK), axis().description.machine.axes[0].overrun
    parts = [i for i, scale in enumerate(problem.scales) if scale.kind == "way"]
    whole = problem.scales[parts[0]].ramp[0] / 2 * np.array(SIDES) / problem.noise
    missing = 1 - problem.rows[:, problem.first + np.array(parts)] / whole[:, None]
    own = problem.rows[:, [i for i, kind in enumerate(problem.passing) if kind == "way"]]
    spread = np.sqrt(np.sum(own**2, axis=1)) / np.abs(whole)
    ways = [np.array(_since_it_turned(AT[0] - before, overrun))[:, None] for before in (overrun, 0.02, 0.1, 10.0)]
    each = [np.exp(-way / [0.03, 0.1, 0.35]) for way in ways]
    np.testing.assert_allclose(missing[3:], each[0][3:], rtol=1e-9)
    assert not np.any(spread[3:])
    assert np.all(np.abs(np.array(each)[:, :3] - missing[:3]) <= 1.001 * each[0][:3] / 2)
    np.testing.assert_allclose(spread[:3], np.sqrt(np.sum(each[0][:3] ** 2, axis=1) / 12), rtol=1e-9)


def _by_kind(case: Case, readings: Sequence[Reading]) -> dict[str, Array]:
    """Return the columns of what passes by kind, of all set-ups and numbers."""
    places = places_of(case.observation.setups, readings)
    numbers = case.observation.counts[places.setups]
    reading = np.repeat(np.arange(len(readings)), numbers)
    clock, found = times_of(readings), dict[str, list[Array]]()
    for kind, _, columns in passing_columns(case.observation, places, reading, clock, case.description.usual)[0]:
        found.setdefault(kind, []).append(columns)
    return {kind: np.hstack(parts) for kind, parts in found.items()}


def test_readings_of_a_long_day_and_many_of_them_have_no_cycle() -> None:
    case, day = axis(), 4 * 3600.0
    for count, seconds, there in ((3, day, True), (3, day + 1, False), (300, day, True), (301, day, False)):
        times = np.linspace(0, seconds, count)
        readings = [Reading("laser", (0.2,), (1,), 0.0, time=float(time)) for time in times]
        assert ("cycle" in _by_kind(case, readings)) == there


CASES = {
    "set-ups in turn": (mixed(), drawn(mixed())),
    "one set-up after the other": (mixed(), sorted(drawn(mixed()), key=lambda reading: reading.setup)),
    "one axis": (CASE, read(machine(3), 24)),
}


def _one_by_one(case: Case, readings: list[Reading]) -> list[float]:
    """Return when each reading ended, way after way: the naive way."""
    seconds = list[float]()
    for last, reading in zip([None, *readings], readings, strict=False):
        setup, way = case.description.setup(reading.setup), 0.0
        if last is None or last.setup != reading.setup:
            way = setup.setup_time
        else:
            sides = np.array(reading.approach or np.zeros(len(reading.pose)), dtype=float)
            here, there = np.array(last.pose), np.array(reading.pose)
            way = float(way_seconds(case.description.machine, setup, here, there, sides))
        seconds.append(way + reading_seconds(setup))
    return [float(end) for end in np.cumsum(seconds)]


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
