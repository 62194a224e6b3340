"""How long ways take: in touch, and off a ball and back, against figures counted elsewhere and a naive profile."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.machine.motion import approach_seconds, travel_seconds
from axiscal.measurement.charts.kinds import Held
from axiscal.measurement.charts.room import Room, arrivals, turns
from axiscal.measurement.setup import Setup
from axiscal.measurement.travel import held_seconds, off_seconds, way_seconds
from axiscal.numerics import Array
from tests.generators.kinematics import pose_with_tip, stem, tip
from tests.measurement.test_charts import DMU, UP, held
from tests.measurement.test_ways_gone import machine

SETUP = Setup("nest", "rtest", (0.0, 0.0, 1.0), (0, 1, 2, 3, 4), (0.0,) * 5, 1e-6, (), 0, 0, 0, (0.0,) * 5, "both")
NEST = replace(SETUP, chart=held(), contact="held")
SPHERE = replace(SETUP, chart=held(), contact="retracted", retract=0.05)


def places(*degrees: tuple[float, float]) -> Array:
    return np.asarray(np.radians(np.array(degrees)), dtype=np.float64)


def test_a_way_in_touch_takes_as_long_as_counted_elsewhere() -> None:
    start, stop = places((0, 0)), places((90, 30))
    assert held_seconds(DMU, held(), start, stop)[0] == pytest.approx(1.21, abs=0.005)
    apart = travel_seconds(DMU, held().poses(start), held().poses(stop))
    assert apart[0] == pytest.approx(1.51, abs=0.006)


def test_nothing_takes_no_time_and_a_sphere_is_left_and_come_back_to() -> None:
    poses = held().poses(places((10, 5), (100, 20)))
    free = np.zeros_like(poses)
    assert way_seconds(DMU, NEST, poses[0], poses[0], free[0]) == 0.0
    assert way_seconds(DMU, SPHERE, poses[0], poses[0], free[0]) == 0.0
    between = way_seconds(DMU, SPHERE, poses[0], poses[1], free[0])
    assert between == pytest.approx(
        float(approach_seconds(DMU, poses[0], poses[1], free[0])) + 2 * off_seconds(DMU, SPHERE)
    )
    assert off_seconds(DMU, SPHERE) == pytest.approx(2 * np.sqrt(0.05 / 4.0))
    assert way_seconds(DMU, NEST, poses[:0], poses[:0], np.zeros((0, poses.shape[1]))).shape == (0,)


def test_coming_from_the_other_side_goes_past_the_place_and_back() -> None:
    chart, overruns = held(), np.array([axis.overrun for axis in DMU.axes])
    start, stop = places((10, 5)), places((100, 20))
    poses = chart.poses(np.concatenate([start, stop]))
    come = [arrivals(chart, overruns, stop, side * np.ones((1, 2)))[0] for side in (1.0, -1.0)]
    straight, turned = (float(way_seconds(DMU, NEST, poses[0], poses[1], side)) for side in come)
    past = stop + overruns[:2]
    back = held_seconds(DMU, chart, start, past) + held_seconds(DMU, chart, past, stop)
    assert turned == pytest.approx(float(back[0]))
    assert straight < turned


def test_off_a_ball_the_tool_goes_from_where_it_is_drawn_back_to_where_it_is_drawn_back() -> None:
    """With a head that swivels these are not as far apart as the places at the ball."""
    built = machine("w-C'-b-X-Y-Z-B-t")
    turning = turns(built, (0, 4), (0.0, 0.0))
    chart = Held(Room.empty(built), np.array([0.05, 0.0, 0.1]), UP, np.radians(100), (0, 4), np.zeros(5), turning)
    sphere = replace(SPHERE, chart=chart)
    start, stop = chart.poses(places((10, -40), (20, 60)))
    off = [pose_with_tip(built, pose, tip(built, pose) + 0.05 * stem(built, pose)) for pose in (start, stop)]
    apart, nearer = (float(approach_seconds(built, a, b, np.zeros(5))) for a, b in (off, (start, stop)))
    expected = apart + 2 * off_seconds(built, sphere)
    assert way_seconds(built, sphere, start, stop, np.zeros(5)) == pytest.approx(expected)
    assert apart != pytest.approx(nearer)
