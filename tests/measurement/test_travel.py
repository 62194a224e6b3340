"""How long ways take: from place to place, and off a ball and back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.machine import machine_from_text
from axiscal.machine.motion import approach_seconds
from axiscal.measurement.charts.kinds import Balls
from axiscal.measurement.charts.room import Coordinate, Room
from axiscal.measurement.instruments.distance import RTest
from axiscal.measurement.travel import way_seconds
from axiscal.numerics import Array
from tests.generators.kinematics import pose_with_tip, stem, tip
from tests.generators.texts import machine_text
from tests.measurement.test_charts import DMU, UP, held

SETUP = RTest("nest", DMU, (0.0, 0.0, 1.0), (0, 1, 2, 3, 4), (0.0,) * 5, 1e-6, (), 0, 0, 0, (0.0,) * 5, "both")
NEST = replace(SETUP, chart=held(), contact="held")
SPHERE = replace(SETUP, chart=held(), contact="retracted", retract=0.05)
OFF = 2 * np.sqrt(0.05 / 4.0)
"""s, off a ball: 50 mm from rest to rest at 4 m/s2."""
SWIVEL = machine_from_text(
    machine_text(
        "w-C'-b-X-Y-Z-B-t",
        {"X": (-400, 400), "Y": (-300, 300), "Z": (-200, 400), "B": (-100, 100), "C": (0, 360)},
        {"EXX": "10 um"},
        tool=120,
        origins={"B": (30, 10, -120), "C": (-20, 40, 0)},
    )
)
"""A head that swivels."""


def places(*degrees: tuple[float, float]) -> Array:
    return np.asarray(np.radians(np.array(degrees)), dtype=np.float64)


def test_nothing_takes_no_time_and_a_sphere_is_left_and_come_back_to() -> None:
    poses = held().poses(places((10, 5), (100, 20)))
    free = np.zeros_like(poses)
    assert way_seconds(DMU, NEST, poses[0], poses[0], free[0]) == 0.0
    assert way_seconds(DMU, SPHERE, poses[0], poses[0], free[0]) == 0.0
    between = way_seconds(DMU, SPHERE, poses[0], poses[1], free[0])
    assert between == pytest.approx(float(approach_seconds(DMU, poses[0], poses[1], free[0])) + 2 * OFF)
    assert way_seconds(DMU, NEST, poses[0], poses[1], free[0]) == approach_seconds(DMU, poses[0], poses[1], free[0])
    assert way_seconds(DMU, NEST, poses[:0], poses[:0], np.zeros((0, poses.shape[1]))).shape == (0,)


def test_off_a_ball_the_tool_goes_from_where_it_is_drawn_back_to_where_it_is_drawn_back() -> None:
    """With a head that swivels these are not as far apart as the places at the ball."""
    built = SWIVEL
    turning = tuple(Coordinate(*built.axes[k].travel, overrun=built.axes[k].overrun) for k in (0, 4))
    room, spots = Room.empty(built), np.array([[0.05, 0.0, 0.1]])
    chart = Balls(room, np.zeros(5), turning, spots, (room,), UP, np.radians(100), (0, 4))
    sphere = replace(SPHERE, chart=chart)
    start, stop = chart.poses(places((10, -40), (20, 60)))
    off = [pose_with_tip(built, pose, tip(built, pose) + 0.05 * stem(built, pose)) for pose in (start, stop)]
    apart, nearer = (float(approach_seconds(built, a, b, np.zeros(5))) for a, b in (off, (start, stop)))
    speed, acceleration = built.axis("Z").speed, built.axis("Z").acceleration
    expected = apart + 2 * (0.05 / speed + speed / acceleration)  # it comes to its speed
    assert way_seconds(built, sphere, start, stop, np.zeros(5)) == pytest.approx(expected)
    assert apart != pytest.approx(nearer)
