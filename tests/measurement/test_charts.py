"""What a chart gives can be taken, and all that it leaves out cannot: by matrices, and by looking everywhere."""

from __future__ import annotations

import math

import numpy as np
import pytest

from axiscal.machine import load_machine, machine_from_text
from axiscal.measurement.charts.kinds import Balls, Bar, Circle, Sight
from axiscal.measurement.charts.room import Coordinate, Room, arrivals, has_room
from tests.generators.kinematics import in_travel, stem, tip
from tests.generators.printed_machine import printed_machine
from tests.generators.solids import filled, solids

DMU = load_machine("dmu60")
MILL = load_machine("three-axis-mill")
UP = np.array([0.0, 0.0, 1.0])
BALLS = {"low": (0.2, 0.0, -0.08), "high": (-0.1, 0.17, 0.12), "third": (-0.1, -0.17, 0.02)}
HOME = np.array([0.0 if axis.rotary else sum(axis.travel) / 2 for axis in DMU.axes])


def held(ball: str = "low", step: float = 0.0, cone: float = 100.0) -> Balls:
    """The tool point at one of the balls of the table of the five-axis machine."""
    room, spots = Room.empty(DMU), np.array([BALLS[ball]])
    turned = tuple(Coordinate(*axis.travel, math.radians(step), axis.overrun) for axis in DMU.axes[:2])
    return Balls(room, HOME, turned, spots, (room,), UP, math.radians(cone), (0, 1))


def circle(plane: str = "xy", turning: float = 0.0) -> Circle:
    """A bar of 150 mm."""
    ways = {"xy": (0, 1), "yz": (1, 2), "zx": (2, 0)}[plane]
    rates = np.array([turning, 0.0, 0.0, 0.0, 0.0])
    room = Room.empty(DMU)
    arc = (Coordinate(0.0, math.tau, 0.0, 1e-3 / 0.15, endless=turning == 0),)
    bar = np.array([0.0, 0.0, 0.1]), 0.15, UP, math.radians(100)
    return Circle(room, HOME, arc, *bar, plane=np.eye(3)[list(ways)], rates=rates)


def sphere(overrun: float) -> tuple[Coordinate, ...]:
    """Azimuth and elevation of a bar."""
    return Coordinate(0.0, math.tau, 0.0, overrun, endless=True), Coordinate(-math.pi / 2, math.pi / 2, 0.0, overrun)


@pytest.mark.parametrize(("step", "cone", "counts"), [(30, 100, (36, 37, 48)), (15, 30, (84, 110, 120))])
def test_as_many_poses_of_a_raster_can_be_taken_as_counted_elsewhere(
    step: float, cone: float, counts: tuple[int, int, int]
) -> None:
    found = []
    for ball in BALLS:
        chart = held(ball, step, cone)
        values = chart.coordinates[0].values[:-1], chart.coordinates[1].values  # a full turn once
        grid = np.stack([g.ravel() for g in np.meshgrid(*values)], axis=1)
        poses = chart.poses(grid)
        taken = chart.feasible(poses)
        for pose, said in zip(poses, taken, strict=True):
            tilt = math.degrees(math.acos(np.clip(stem(DMU, pose)[2], -1, 1)))
            assert said == (in_travel(DMU, pose) and tilt <= cone + 1e-6)
        found.append(int(taken.sum()))
    assert tuple(found) == counts


def test_a_rotary_axis_in_step_leaves_the_bar_where_it_is_in_the_workpiece() -> None:
    chart = circle("xy", turning=1.0)
    poses = chart.poses(np.linspace(0, math.tau, 30)[:, None])
    np.testing.assert_allclose(poses[:, 0], np.linspace(0, math.tau, 30), atol=1e-12)
    for pose, angle in zip(poses, np.linspace(0, math.tau, 30), strict=True):
        np.testing.assert_allclose(tip(DMU, pose), [0.15 * math.cos(angle), 0.15 * math.sin(angle), 0.1], atol=1e-12)


def test_a_bar_in_space_reaches_all_of_its_sphere_and_no_place_under_the_stem() -> None:
    room = Room.empty(DMU)
    chart = Bar(room, HOME, sphere(1e-3 / 0.15), np.array([0.0, 0.0, 0.1]), 0.15, UP, math.radians(100))
    rng = np.random.default_rng(2)
    places = np.column_stack([rng.uniform(0, math.tau, 200), rng.uniform(-1.5, 1.5, 200)])
    poses = chart.poses(places)
    for pose, said, place in zip(poses, chart.feasible(poses), places, strict=True):
        assert np.linalg.norm(tip(DMU, pose) - chart.centre) == pytest.approx(0.15, abs=1e-12)
        assert said == (in_travel(DMU, pose) and place[1] >= math.radians(-10) - 1e-9)
    np.testing.assert_allclose(chart.places(poses), places, atol=1e-9)


def test_linear_axes_come_from_where_they_really_come_when_a_rotary_axis_comes_from_a_side() -> None:
    chart, overruns = held(), np.array([axis.overrun for axis in DMU.axes])
    rng = np.random.default_rng(4)
    places, sides = rng.uniform([1, 0], [5, 1], (100, 2)), rng.choice([-1.0, 1.0], (100, 2))
    come = arrivals(chart, places, sides)
    np.testing.assert_array_equal(come[:, :2], sides)
    for place, side, said in zip(places, sides, come, strict=True):
        before = chart.poses((place - side * overruns[:2])[None])[0]
        way = chart.poses(place[None])[0] - before
        for k in range(5):
            assert said[k] == (np.sign(way[k]) if abs(way[k]) >= overruns[k] / 10 else 0.0)


def test_a_place_at_the_end_of_a_travel_has_no_room_to_be_come_to_from_there() -> None:
    chart = held()
    first, last = np.array([[0.0, 0.0]]), np.array([[math.tau, 0.0]])
    up, down = np.array([[1.0, 1.0]]), np.array([[-1.0, 1.0]])
    assert not has_room(chart, first, up)[0]
    assert has_room(chart, first, down)[0]
    assert has_room(chart, last, up)[0]
    assert not has_room(chart, last, down)[0]


def test_what_is_to_be_kept_out_is_kept_out_with_the_width_of_the_tool() -> None:
    low_table = np.array([[[-0.25, 0.25], [-0.25, 0.25], [-0.3, -0.15]]])
    room = Room(DMU, low_table)
    rng = np.random.default_rng(5)
    poses = held().poses(rng.uniform([0, -0.5], [math.tau, 2.0], (400, 2)))
    poses = poses[Room.empty(DMU).in_travel(poses)]
    printed, grazed = printed_machine(DMU.text), 0
    for pose, said in zip(poses, room.holds(poses), strict=True):
        points = filled(printed, pose, solids(printed)["holder"])
        entered = np.any(np.all((points > low_table[0, :, 0]) & (points < low_table[0, :, 1]), axis=1))
        assert not (said and entered)
        grazed += not (said or entered)
    assert grazed <= len(poses) / 50  # only beside an edge


def test_a_tracker_sees_what_is_in_range_and_in_its_reflector_s_cone() -> None:
    spans = np.array([axis.travel for axis in MILL.axes])
    park = spans.mean(axis=1)
    ends = tuple(Coordinate(*axis.travel) for axis in MILL.axes)
    station = np.array([0.3, -1.0, 0.0])
    chart = Sight(
        Room.empty(MILL), park, ends, (0, 1, 2), station[None], (0.9, 1.4), np.array([0.0, -1.0, 0.0]), math.radians(20)
    )
    rng = np.random.default_rng(6)
    poses = chart.poses(spans[:, 0] + np.ptp(spans, axis=1) * rng.uniform(size=(300, 3)))
    for pose, said in zip(poses, chart.feasible(poses), strict=True):
        beam = station - tip(MILL, pose)
        far = np.linalg.norm(beam)
        assert said == (0.9 <= far <= 1.4 and math.degrees(math.acos(-beam[1] / far)) <= 20 + 1e-6)


@pytest.mark.parametrize(("radius", "free"), [("49 mm", True), ("51 mm", False), (None, True)])
def test_a_thicker_tool_enters_what_a_thinner_one_passes(radius: str | None, free: bool) -> None:
    stated = "" if radius is None else f'radius = "{radius}"\n'
    machine = machine_from_text(load_machine("dmu60").text.replace("[tool]\n", f"[tool]\n{stated}"))
    beside = np.array([[[0.05, 0.1], [-0.1, 0.1], [-0.3, 0.3]]])  # a wall 50 mm from the middle of the tool at home
    home = np.array([[0.0, 0.0, 0.0, 0.0, 0.12]])
    assert np.linalg.norm(tip(machine, home[0])) < 1e-12
    assert Room(machine, beside).holds(home).tolist() == [free]
