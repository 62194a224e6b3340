"""Programs in touch, read again by a reader of their own and driven by matrices of their own: nothing is torn off."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from decimal import Decimal
from functools import cache
from itertools import pairwise

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
from tests.generators.kinematics import in_travel, pose_with_tip, tip
from tests.generators.program_ways import STEP, Reader
from tests.generators.texts import artefact_text, campaign_text, setup_text

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
STATION = '"0 mm", "0 mm", "100 mm"'
ON_MILL = '"300 mm", "200 mm", "-70 mm"'
BALL = np.array([0.2, 0.0, -0.08])


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
def read_cached(text: str, count: int, seed: int, controller: str) -> list[tuple[str, list[Array], bool]]:
    """Return the same of so many places of a campaign."""
    campaign = described(text)
    return read(campaign, places_of(campaign, count, seed), controller)


def read(campaign: CampaignDescription, places: list[Place], controller: str) -> list[tuple[str, list[Array], bool]]:
    """Return what a program does, with whether the control holds the tool point; and that no axis leaves its travel."""
    reader, found = Reader(campaign.machine, controller), []
    for what, poses in reader.follow(program_of(campaign, places, controller).text):
        slack = STEP[controller] * 1e-3 + 1e-8
        assert all(in_travel(campaign.machine, pose, slack) for pose in poses), what
        found.append((what, poses, reader.held))
    return found


def stands_as_planned(campaign: CampaignDescription, place: Place, pose: Array, controller: str) -> None:
    """Assert that a reading is taken where it was planned, as far as its numbers can say."""
    for axis, planned, at in zip(campaign.machine.axes, place.pose, pose, strict=True):
        angle = 0.5e-4 if controller != "fanuc" else 0.5e-3
        rounded = math.radians(angle) if axis.rotary else 1e-3 * STEP[controller]
        slack = rounded if axis.rotary else rounded + 0.6 * math.radians(angle)
        turned = abs(at - planned) if not axis.rotary else abs(math.remainder(at - planned, math.tau))
        assert turned <= slack + 1e-9, (axis.name, at, planned)


@pytest.mark.parametrize("controller", controllers())
def test_a_nest_keeps_its_ball_from_reading_to_reading(controller: str) -> None:
    campaign = described(NEST)
    places = places_of(campaign, 8, 0)
    done = read_cached(NEST, 8, 0, controller)
    readings = [k for k, (what, _, _) in enumerate(done) if what.startswith("READING")]
    assert [done[k][0] for k in readings] == [f"READING {n}" for n in range(1, 9)]
    for k, place in zip(readings, places, strict=True):
        (pose,) = done[k][1]
        assert np.linalg.norm(tip(campaign.machine, pose) - BALL) < 1e-9
        stands_as_planned(campaign, place, pose, controller)
    stayed = 0
    for before, after in pairwise(readings):
        between = done[before + 1 : after]
        if any(what == "free" for what, _, _ in between):
            continue
        stayed += 1
        for _, poses, held in between:
            assert held
            for pose in poses:
                assert np.linalg.norm(tip(campaign.machine, pose) - BALL) < 1e-9
    assert stayed >= 1


@pytest.mark.parametrize("controller", controllers())
def test_rotary_axes_come_to_a_reading_from_the_side_that_was_planned(controller: str) -> None:
    campaign = described(NEST)
    places = places_of(campaign, 8, 0)
    done = read_cached(NEST, 8, 0, controller)
    trace = [(what, pose) for what, poses, _ in done for pose in poses]
    numbered = [(k, int(what.split()[1])) for k, (what, _) in enumerate(trace) if what.startswith("READING")]
    checked = 0
    for k, number in numbered:
        for axis_number, axis in enumerate(campaign.machine.axes):
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


@pytest.mark.parametrize("controller", ["linuxcnc", pytest.param("heidenhain", marks=pytest.mark.long)])
def test_slides_come_to_a_reading_in_touch_from_the_side_that_was_planned(controller: str) -> None:
    """On the last degree to it: a straight way from afar comes at another slant than one from an overrun away."""
    campaign = described(NEST.replace("15 deg", "5 deg"))
    machine, checked = campaign.machine, 0
    places = places_of(campaign, 40, 3)
    done = read(campaign, places, controller)
    trace = [(what, pose) for what, poses, _ in done for pose in poses]
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


@pytest.mark.parametrize("controller", controllers())
def test_a_probe_stands_off_its_sphere_along_itself(controller: str) -> None:
    campaign = described(SPHERES)
    places = places_of(campaign, 10)
    done = read(campaign, places, controller)
    assert not any(held for _, _, held in done)
    at = [poses[0] for what, poses, _ in done if what.startswith("READING")]
    for place, pose in zip(places, at, strict=True):
        ball, here = tip(campaign.machine, np.array(place.pose)), tip(campaign.machine, pose)
        assert np.linalg.norm(here - ball) == pytest.approx(0.05, abs=3e-6)
    (program,) = [program_of(campaign, places, controller)]
    for place, row in zip(places, program.readings, strict=True):  # the list says where is read, not where it stands
        written = [float(text) for text in row.coordinates]
        planned = [math.degrees(v) if a.rotary else 1e3 * v for a, v in zip(row.axes, place.pose, strict=True)]
        np.testing.assert_allclose(written, planned, atol=6e-4)


@pytest.mark.parametrize("controller", controllers())
def test_a_bar_on_a_mill_keeps_its_length_while_the_slides_go_together(controller: str) -> None:
    campaign = described(BAR.format(machine="three-axis-mill", station=ON_MILL, keys=""), "three-axis-mill")
    places = places_of(campaign, 12)
    done = read(campaign, places, controller)
    first = next(k for k, (what, _, _) in enumerate(done) if what == "READING 1")
    last = next(k for k, (what, _, _) in enumerate(done) if what == "READING 12")
    centre = np.array([0.3, 0.2, -0.07])
    rounded = 1e-9 + 1e-3 * STEP[controller]
    for what, poses, held in done[first : last + 1]:
        assert not held
        for pose in poses:
            short = 0.15 - np.linalg.norm(tip(campaign.machine, pose) - centre)
            assert -rounded <= short <= 1e-5 + rounded, what
            if what.startswith("READING"):
                assert abs(short) <= rounded


@pytest.mark.parametrize("controller", controllers())
def test_a_bar_keeps_its_length_while_the_table_turns_in_step(controller: str) -> None:
    keys = 'turning = { C = 1.0 }\narc = ["10 deg", "200 deg"]'
    campaign = described(BAR.format(machine="dmu60", station=STATION, keys=keys))
    done = read(campaign, places_of(campaign, 2), controller)
    first = next(k for k, (what, _, _) in enumerate(done) if what == "READING 1")
    last = next(k for k, (what, _, _) in enumerate(done) if what == "READING 2")
    centre, rounded = np.array([0.0, 0.0, 0.1]), STEP[controller] * 1e-3
    for what, poses, held in done[first : last + 1]:
        assert held
        for pose in poses:
            short = 0.15 - np.linalg.norm(tip(campaign.machine, pose) - centre)
            assert -rounded - 1e-9 <= short <= 1e-5 + rounded, what
            if what.startswith("READING"):
                assert abs(short) <= rounded + 1e-9


@pytest.mark.parametrize("controller", controllers())
def test_a_program_says_which_mode_and_zero_it_needs(controller: str) -> None:
    campaign = described(NEST)
    program = program_of(campaign, places_of(campaign, 2), controller)
    head = program.text.split("READING 1")[0]
    assert "TOOL POINT ON THE" in head
    assert "NEEDS" in head
    assert any("zero" in note or "datum" in note for note in program.notes)
    assert any("option" in note or "configurations" in note for note in program.notes)


def test_a_control_without_kinematics_for_the_chain_refuses() -> None:
    campaign = described(NEST)
    places, machine = places_of(campaign, 1), campaign.machine
    swivel_first = Machine(
        machine.name, (machine.axis("B"), machine.axis("C"), *machine.axes[2:]), 0.12, (), "w-B'-C'-", ""
    )
    with pytest.raises(ProgramError, match="no kinematics for the chain") as refused:
        programs(swivel_first, campaign.setups, places, dialect("linuxcnc"))
    assert "choose another control" in str(refused.value)


@pytest.mark.parametrize("controller", ["sinumerik", "heidenhain", "linuxcnc"])
@pytest.mark.parametrize("kind", [pytest.param("nest", marks=pytest.mark.long), "bar"])
def test_where_no_way_in_touch_leads_the_tool_goes_off_and_comes_back(
    kind: str, controller: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    on_mill = BAR.format(machine="three-axis-mill", station=ON_MILL, keys="")
    campaign = described(NEST) if kind == "nest" else described(on_mill, "three-axis-mill")
    places = places_of(campaign, 3)
    monkeypatch.setattr(SmoothChart, "between", lambda self, here, there: None)
    done = read(campaign, places, controller)
    text = program_of(campaign, places, controller).text
    readings = [k for k, (what, _, _) in enumerate(done) if what.startswith("READING")]
    centre, radius = (BALL, 0.0) if kind == "nest" else (np.array([0.3, 0.2, -0.07]), 0.15)
    for k, place in zip(readings, places, strict=True):
        (pose,) = done[k][1]
        stands_as_planned(campaign, place, pose, controller)
    for before, after in pairwise(readings):
        between = [pose for _, poses, _ in done[before + 1 : after] for pose in poses]
        off = [abs(float(np.linalg.norm(tip(campaign.machine, pose) - centre)) - radius) for pose in between]
        assert max(off) > 4e-3
    asked = re.findall("TAKE THE BAR OFF|PUT THE BAR ON|READING \\d", text)
    assert (asked.count("TAKE THE BAR OFF") >= 2) == (kind == "bar")
    assert asked.count("TAKE THE BAR OFF") == asked.count("PUT THE BAR ON")


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
    campaign = described(BAR.format(machine="three-axis-mill", station=ON_MILL, keys=""), "three-axis-mill")
    (setup,) = campaign.setups
    apart = replace(setup, driving=Driving(order=(("X",), ("Y",), ("Z",))))
    with pytest.raises(ProgramError, match="move together while the instrument is in touch"):
        programs(campaign.machine, [apart], places_of(campaign, 4), dialect("fanuc"))
