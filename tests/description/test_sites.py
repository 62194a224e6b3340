"""Where a set-up is read: what campaign.toml says of it, and what is refused, in words."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription, read_campaign
from axiscal.exceptions import InputError
from axiscal.machine import load_machine
from axiscal.measurement.charts.kinds import Balls, Bar, Circle, Line
from tests.generators.campaigns import built_in

SPHERES = """
[[artefacts]]
name = "spheres"
balls = { low = ["200 mm", "0 mm", "-80 mm"], high = ["-100 mm", "170 mm", "120 mm"] }
"""
TOUCHED = '[[setups]]\nname = "touched"\ninstrument = "sphere"\nartefact = "spheres"\n'
BAR = '[[setups]]\nname = "bar"\ninstrument = "ballbar"\nlength = "150 mm"\nstation = ["0 mm", "0 mm", "100 mm"]\n'
LASER = '[[setups]]\nname = "diagonal"\ninstrument = "interferometer"\n'
GRID = '[[artefacts]]\nname = "spheres"\ngrid = { origin = ["0 mm", "0 mm", "0 mm"], '
PITCH = '["9 mm", "9 mm"]'
MANY = '[[artefacts]]\nname = "spheres"\n[artefacts.balls]\n'
MANY += "".join(f'b{k} = ["{k} mm", "0 mm", "0 mm"]\n' for k in range(401))


def described(text: str, machine: str = "dmu60") -> CampaignDescription:
    return built_in(text, machine)


def test_spheres_are_read_at_all_their_balls_with_all_rotary_axes() -> None:
    (setup,) = described(SPHERES + TOUCHED + 'raster = { B = "15 deg", C = "30 deg" }\n').setups
    assert isinstance(setup.chart, Balls)
    assert [each.step for each in setup.chart.coordinates[:3]] == [1.0, math.radians(30), math.radians(15)]
    assert setup.contact == "retracted"
    assert setup.setup_time == 600.0
    assert setup.mean_sides


def test_a_grid_is_its_balls_in_rows() -> None:
    text = f"{GRID}count = [2, 3], pitch = {PITCH}, along = ['x', 'z'] }}\n"
    (setup,) = described(text + TOUCHED).setups
    assert setup.artefact is not None
    places = {ball.name: ball.place for ball in setup.artefact.balls}
    assert places == {f"ball_{i + 1}_{j + 1}": (9e-3 * i, 0.0, 9e-3 * j) for i in range(2) for j in range(3)}


def test_the_unknowns_of_a_site_that_are_named_keep_whose_they_are() -> None:
    (usual,) = described(BAR).setups
    (named,) = described(BAR + 'unknowns = { tool_z = "70 um" }\n').setups
    owners = {unknown.name: unknown.owner for unknown in usual.unknowns}
    assert [(each.name, each.std, each.owner) for each in named.unknowns] == [("tool_z", 7e-5, owners["tool_z"])]


def test_a_plane_of_two_directions_and_the_cone_of_an_artefact_hold_for_a_bar() -> None:
    (flat,) = described(BAR + "plane = [[1, 0, 0], [1, 1, 0]]\n").setups
    assert isinstance(flat.chart, Circle)
    np.testing.assert_allclose(flat.chart.plane, [[1, 0, 0], [0, 1, 0]], atol=1e-12)
    text = SPHERES + 'free = "z"\ncone = "40 deg"\n' + BAR.split("station")[0] + 'artefact = "spheres"\nball = "low"\n'
    (setup,) = described(text).setups
    assert isinstance(setup.chart, Bar)
    assert setup.chart.cone == pytest.approx(math.radians(40))


def test_a_nest_is_read_at_one_ball_in_touch() -> None:
    (setup,) = described(SPHERES + TOUCHED.replace("sphere", "rtest", 1) + 'ball = "high"\nmoves = ["C"]\n').setups
    assert isinstance(setup.chart, Balls)
    np.testing.assert_allclose(setup.chart.spots, [[-0.1, 0.17, 0.12]])
    assert setup.chart.turning == (0,)
    assert (setup.contact, setup.mean_sides, setup.stroke) == ("held", False, 1e-3)


def test_a_bar_without_a_plane_is_free_in_space_and_with_one_goes_round_as_far_as_it_can() -> None:
    free, flat, upright = described(
        BAR + BAR.replace('"bar"', '"xy"') + 'plane = "xy"\n' + BAR.replace('"bar"', '"zx"') + 'plane = "zx"\n'
    ).setups
    assert isinstance(free.chart, Bar)
    assert isinstance(flat.chart, Circle)
    assert flat.chart.coordinates[0][:2] == (0.0, math.tau)
    assert isinstance(upright.chart, Circle)
    low, high, *_ = upright.chart.coordinates[0]
    assert math.degrees(high - low) == pytest.approx(200, abs=2)  # as far as the stem of the tool lets it


def test_a_laser_on_a_diagonal_reads_along_it() -> None:
    text = 'along = [["-200 mm", "-200 mm", "0 mm"], ["200 mm", "200 mm", "300 mm"]]\n'
    (setup,) = described(LASER + text).setups
    assert isinstance(setup.chart, Line)
    np.testing.assert_allclose(setup.direction, np.array([4, 4, 3]) / math.sqrt(41))


def test_a_reach_is_what_a_reading_is_asked_for_in() -> None:
    text = '[[setups]]\nname = "dial"\ninstrument = "straightedge"\ndirection = "y"\nmoves = ["X"]\n'
    (setup,) = described(text + 'reach = { X = ["150 mm", "450 mm"] }\n', "three-axis-mill").setups
    machine = load_machine("three-axis-mill")
    assert setup.span(machine.axis("X"), machine.index("X")) == pytest.approx((0.15, 0.45))


@pytest.mark.parametrize("length", ["150 mm", "237 mm"])
@pytest.mark.parametrize("plane", ["zx", "yz"])
def test_the_arc_that_a_refusal_names_can_be_gone_round(length: str, plane: str) -> None:
    """Its ends were rounded to the nearest degree, beyond what is reached: the same refusal came again."""
    bar = BAR.replace("150 mm", length) + f'plane = "{plane}"\n'
    with pytest.raises(InputError) as refused:
        described(bar + 'arc = ["0 deg", "360 deg"]\n')
    (given,) = re.findall(r"arc = \[.*?\]", str(refused.value))
    (setup,) = described(f"{bar}{given}\n").setups
    assert isinstance(setup.chart, Circle)


def test_more_balls_than_a_plan_can_choose_from_are_refused() -> None:
    with pytest.raises(InputError, match="balls are too many"):
        described(f"{MANY}\n{TOUCHED}")


def test_a_sphere_without_a_ball_opens_where_readings_exist(tmp_path: Path) -> None:
    path = tmp_path / "campaign.toml"
    path.write_text('machine = "dmu60"\n[target]\nreadings = 9\n[[setups]]\nname = "s"\ninstrument = "sphere"\n')
    (setup,) = read_campaign(path, asking=False).setups
    assert setup.lacks is not None
