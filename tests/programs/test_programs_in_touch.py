"""Programs in touch, read again by a reader of their own and driven by matrices of their own: nothing is torn off."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from decimal import Decimal
from functools import cache
from itertools import pairwise, product

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.exceptions import ProgramError
from axiscal.machine import Machine, load_machine
from axiscal.machine.kinematics import frames, tip_at
from axiscal.machine.motion import Driving
from axiscal.measurement.candidates import chart_candidates
from axiscal.measurement.charts.ways import SmoothChart
from axiscal.measurement.reading import Place
from axiscal.numerics import Array
from axiscal.programs import Program, controllers, dialect, programs
from axiscal.programs.gliding import TipDriver
from axiscal.programs.scale import AxisScale
from axiscal.programs.steps import ProgramAxes, groups
from tests.generators.kinematics import pose_with_tip
from tests.generators.printed_machine import printed_machine
from tests.generators.program_ways import Reader
from tests.generators.said_places import Said
from tests.generators.texts import artefact_text, campaign_text, setup_text
from tests.generators.ways_said import WaysSaid

NEST = campaign_text(
    "dmu60",
    artefact_text("balls", balls={"low": ["200 mm", "0 mm", "-80 mm"], "high": ["-100 mm", "170 mm", "120 mm"]}),
    setup_text("nest", "rtest", artefact="balls", ball="low", raster={"B": "15 deg", "C": "15 deg"}, approach="both"),
)
SPHERES = NEST.replace("rtest", "sphere").replace('ball = "low"\n', "")
BAR = """
machine = "{machine}"
[[setups]]
name = "bar"
instrument = "ballbar"
length = "150 mm"
station = [{station}]
plane = "xy"
{keys}
raster = {{ arc = "10 deg" }}
approach = "both"
"""
TURNING = 'turning = { C = 1.0 }\narc = ["10 deg", "200 deg"]'
STATION = '"0 mm", "0 mm", "100 mm"'
ON_MILL = '"300 mm", "200 mm", "-70 mm"'
BALL = np.array([0.2, 0.0, -0.08])


KINDS = {
    "nest": (NEST, "dmu60"),
    "spheres": (SPHERES, "dmu60"),
    "bar": (BAR.format(machine="three-axis-mill", station=ON_MILL, keys=""), "three-axis-mill"),
    "turning bar": (BAR.format(machine="dmu60", station=STATION, keys=TURNING), "dmu60"),
}
"""What is in touch, or drawn back from what it touched, and the machine that holds it."""


@cache
def described(text: str, machine: str = "dmu60") -> CampaignDescription:
    return campaign_from_texts(text, "campaign.toml", load_machine(machine).text, machine)


def places_of(campaign: CampaignDescription, count: int = 12, seed: int = 1) -> list[Place]:
    """Return places of the set-up in any order, from any side."""
    (setup,) = campaign.setups
    assert setup.chart is not None
    poses, approaches = chart_candidates(campaign.machine, setup, setup.chart, 400)
    chosen = np.random.default_rng(seed).choice(len(poses), min(count, len(poses)), replace=False)
    sides = approaches[chosen].astype(int).tolist()
    return [Place(setup.name, tuple(p), tuple(s)) for p, s in zip(poses[chosen].tolist(), sides, strict=True)]


def program_of(campaign: CampaignDescription, places: list[Place], controller: str) -> Program:
    (program,) = programs(campaign.machine, campaign.setups, places, dialect(controller))
    return program


@cache
def made(kind: str, controller: str) -> tuple[Said, list[Place], Program]:
    """Return what a campaign says, eight places of it, or two where a bar turns, and the program."""
    text, machine = KINDS[kind]
    campaign = described(text, machine)
    places = places_of(campaign, 2 if kind == "turning bar" else 8, 0)
    return Said(text, printed_machine(load_machine(machine).text)), places, program_of(campaign, places, controller)


def holds(kind: str, controller: str, lines: list[str] | None = None) -> int:
    """Assert that nothing is torn off or run into on the ways of a program, or of other lines; returns their number."""
    said, places, program = made(kind, controller)
    planned = {number: np.array(place.pose) for number, place in enumerate(places, start=1)}
    text = program.text if lines is None else "\n".join(lines)
    return WaysSaid(said, places[0].setup, controller).holds(text, planned)


_NESTS = ("heidenhain", "linuxcnc")
"""Controls that hold a nest in the quick tests: each program of one is followed for seconds."""


@pytest.mark.parametrize(
    ("kind", "controller"),
    [
        pytest.param(*each, marks=pytest.mark.long if each[0] == "nest" and each[1] not in _NESTS else ())
        for each in product(KINDS, controllers())
    ],
)
def test_what_touches_stays_in_touch_or_drawn_back_from_reading_to_reading(kind: str, controller: str) -> None:
    said, places, program = made(kind, controller)
    assert holds(kind, controller) == len(places) - 1
    ways = list(Reader(said.machine, controller).follow(program.text))
    readings = [k for k, (what, _) in enumerate(ways) if what.startswith("READING")]
    let_go = [any(what == "free" for what, _ in ways[a:b]) for a, b in pairwise(readings)]
    assert kind == "spheres" or not all(let_go)
    for place, row in zip(places, program.readings, strict=True):  # the list says where is read, not where it stands
        written = [float(text) for text in row.coordinates]
        planned = [math.degrees(v) if a.rotary else 1e3 * v for a, v in zip(row.axes, place.pose, strict=True)]
        np.testing.assert_allclose(written, planned, atol=6e-4)


def test_the_judge_sees_what_is_torn_off_run_into_or_out_of_its_travel() -> None:
    for kind, mark, way in (
        ("nest", r"G1 .*[BC]", ["G1 X200.002000 F100", "G1 X200.000000 F100"]),
        ("spheres", "", ["G53 G1 Z-1.0000 F100"]),
        ("spheres", "", ["G53 G1 {} F100"]),
    ):
        said, places, program = made(kind, "linuxcnc")
        lines = program.text.splitlines()
        read = next(k for k, line in enumerate(lines) if "READING 2)" in line)
        after = next(k for k in range(read + 1, len(lines)) if re.match(mark, lines[k]))
        slides = zip(said.machine.axes[2:], places[1].pose[2:], strict=True)
        ball = " ".join(f"{axis.name}{1e3 * at:.4f}" for axis, at in slides)
        with pytest.raises(AssertionError):
            holds(kind, "linuxcnc", [*lines[:after], *(each.format(ball) for each in way), *lines[after:]])


def test_two_nanometres_off_a_ball_are_seen() -> None:
    said, places, _ = made("nest", "linuxcnc")
    assert said.holds(places[0]) == "artefact"
    for axis in range(2, 5):
        pose = list(places[0].pose)
        pose[axis] += 2e-9
        with pytest.raises(AssertionError):
            said.holds(replace(places[0], pose=tuple(pose)))


def read(campaign: CampaignDescription, places: list[Place], controller: str) -> list[tuple[str, Array]]:
    """Return what a program does, pose by pose."""
    reader = Reader(campaign.machine, controller)
    text = program_of(campaign, places, controller).text
    return [(what, pose) for what, poses in reader.follow(text) for pose in poses]


@pytest.mark.parametrize("controller", controllers())
def test_rotary_axes_come_to_a_reading_from_the_side_that_was_planned(controller: str) -> None:
    said, places, program = made("nest", controller)
    ways = Reader(said.machine, controller).follow(program.text)
    trace = [(what, pose) for what, poses in ways for pose in poses]
    numbered = [(k, int(what.split()[1])) for k, (what, _) in enumerate(trace) if what.startswith("READING")]
    checked = 0
    for k, number in numbered:
        for axis_number, axis in enumerate(said.machine.axes):
            side = places[number - 1].approach[axis_number]
            if not axis.rotary or side == 0:
                continue
            come, here = 0.0, trace[k][1][axis_number]
            for _, pose in reversed(trace[:k]):
                if (here - pose[axis_number]) * side < come - 1e-9:
                    break
                come = (here - pose[axis_number]) * side
            assert come >= axis.overrun - math.radians(2e-3)
            checked += 1
    assert checked >= 12


def test_slides_come_to_a_reading_in_touch_from_the_side_that_was_planned() -> None:
    """On the last degree to it: a straight way from afar comes at another slant than one from an overrun away."""
    campaign = described(NEST.replace("15 deg", "5 deg"))
    machine, checked = campaign.machine, 0
    places = places_of(campaign, 40, 3)
    trace = read(campaign, places, "linuxcnc")
    rotary = [k for k, axis in enumerate(machine.axes) if axis.rotary]
    for k, (what, pose) in enumerate(trace):
        if not what.startswith("READING"):
            continue
        start = next(before for _, before in reversed(trace[:k]) if np.abs(before - pose)[rotary].max() > 1e-6)
        short = min(1.0, math.radians(1.0) / float(np.abs(start - pose)[rotary].max()))
        come = pose - pose_with_tip(machine, pose + short * (start - pose), BALL)
        place = places[int(what.split()[1]) - 1]
        for axis_number, axis in enumerate(machine.axes):
            side = place.approach[axis_number]
            if not axis.rotary and side != 0:
                assert come[axis_number] * side > 0, (what, axis.name)
                checked += 1
    assert checked >= 60


def test_a_control_without_kinematics_for_the_chain_refuses() -> None:
    campaign = described(NEST)
    places, machine = places_of(campaign, 1), campaign.machine
    swivel_first = Machine(
        machine.name, (machine.axis("B"), machine.axis("C"), *machine.axes[2:]), 0.12, (), "w-B'-C'-", ""
    )
    with pytest.raises(ProgramError, match="no kinematics for the chain") as refused:
        programs(swivel_first, campaign.setups, places, dialect("linuxcnc"))
    assert "choose another control" in str(refused.value)


def test_over_a_clearance_the_slides_move_aside_where_it_is_clear_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    campaign = described(*KINDS["bar"])
    (setup,) = campaign.setups
    monkeypatch.setattr(SmoothChart, "between", lambda self, here, there: None)
    over = replace(setup, driving=Driving(clearance=("Z", 0.35)))
    (program,) = programs(campaign.machine, [over], places_of(campaign, 3), dialect("linuxcnc"))
    moves = [line.split()[2:-1] for line in program.text.splitlines() if line.startswith("G53 G1")]
    aside = [(before, words) for before, words in pairwise(moves) if words[0][0] in "XY"]
    assert len(aside) >= 5
    assert all(before == ["Z350.000000"] and len(words) == 2 for before, words in aside)


def a_way_that_swings_out(machine: Machine) -> tuple[Array, Array]:
    """Return two poses with the tool point at one place of the table, between which the slides leave their travels."""
    low, high = np.array([axis.travel for axis in machine.axes]).T
    rotary, rng = np.array([axis.rotary for axis in machine.axes]), np.random.default_rng(1)
    for _ in range(10_000):
        start = rng.uniform(low, high)
        point = frames(machine, start[None]).tcp
        stop = tip_at(machine, np.where(rotary, rng.uniform(low, high), 0.0)[None], point)[0]
        half = tip_at(machine, ((start + stop) / 2)[None], point)[0]
        if np.all((stop >= low) & (stop <= high)) and not np.all((half >= low) & (half <= high)):
            return start, stop
    raise AssertionError("no such way")


def test_a_way_in_touch_that_leaves_the_travels_is_refused() -> None:
    machine = load_machine("dmu60")
    scales = tuple(AxisScale.of_axis(axis, 4) for axis in machine.axes)
    ways = np.stack(a_way_that_swings_out(machine))
    axes = ProgramAxes(scales, groups(machine, Driving()))
    held = TipDriver(axes, machine=machine, step=Decimal("0.0001"), gentle=500)
    with pytest.raises(ProgramError, match="a way in touch leaves the travels"):
        list(held.along(ways))
    beyond = ways[0].copy()
    beyond[machine.index("X")] = 9.0
    with pytest.raises(ProgramError, match="a way in touch leaves the travel of X"):
        held.written(beyond)


def test_a_control_holds_the_tool_point_of_slides_called_x_y_and_z_alone() -> None:
    one_axis = load_machine("one-axis")
    with pytest.raises(ProgramError, match="a tool point is held by X, Y and Z"):
        dialect("sinumerik").refuse_no_tip(one_axis)


def test_slides_that_are_ordered_apart_cannot_stay_in_touch() -> None:
    campaign = described(*KINDS["bar"])
    (setup,) = campaign.setups
    apart = replace(setup, driving=Driving(order=(("X",), ("Y",), ("Z",))))
    with pytest.raises(ProgramError, match="move together while the instrument is in touch"):
        programs(campaign.machine, [apart], places_of(campaign, 4), dialect("fanuc"))
