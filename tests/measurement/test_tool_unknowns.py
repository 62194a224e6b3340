"""A tool that is longer than stated, or sits aside of the spindle's axis, is no error of the machine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription, Era, campaign_from_texts
from axiscal.machine import load_machine
from axiscal.machine.kinematics import Deviation, tool_motion
from axiscal_core.rigid import SmallMotions
from tests.generators.campaigns import built_in
from tests.generators.texts import TWO_SPHERES, Said, setup_text

_STATION: dict[str, Said] = {"station": ["300 mm", "-800 mm", "-300 mm"]}
_LONGER = 50e-6


@pytest.mark.parametrize("instrument", ["rtest", "tracker", "tracer", "ballbar"])
def test_it_moves_the_readings_as_another_tool_moves_the_point_of_the_chain(instrument: str) -> None:
    """The chain of a machine whose tool is longer by e is the judge: e along −z of the tool."""
    described = built_in(setup_text("it", instrument, **({} if instrument == "rtest" else _STATION)), "dmu60")
    machine, (setup,) = described.machine, described.setups
    low, high = np.clip(np.array([axis.travel for axis in machine.axes]).T, -np.pi, np.pi)
    poses = np.random.default_rng(1).uniform(low, high, (20, len(low)))
    still = SmallMotions(*(np.zeros((len(machine.axes), len(poses), 3)) for _ in range(3)))
    longer, stated = (
        tool_motion(m, poses, still)
        for m in (replace(machine, tool=(0.0, 0.0, -machine.tool_length - _LONGER)), machine)
    )
    moved = Deviation(longer.translation - stated.translation, np.zeros((len(poses), 3)))
    kind = setup
    expected = kind.shown(kind.places(poses, deviation=moved), {})
    assert kind.shown(kind.places(poses), {"tool_z": -_LONGER}) == pytest.approx(expected, abs=1e-14)
    row = kind.own_slopes(kind.places(poses), ["tool_z"])[:, :, 0]
    assert -_LONGER * row == pytest.approx(expected, abs=_LONGER**2 / 0.1)


def test_where_nothing_turns_the_tool_is_one_with_the_zero_and_no_unknown() -> None:
    assert not any("tool" in u.name for u in built_in(setup_text("it", "rtest")).setups[0].unknowns)
    turning = built_in(setup_text("it", "rtest"), "dmu60").setups[0].unknowns
    assert {"tool_x", "tool_y", "tool_z"} < {unknown.name for unknown in turning}


def _at_spheres(tool: str, usual: bool = True) -> CampaignDescription:
    machine = load_machine("dmu60").text
    return campaign_from_texts(f"{tool}{TWO_SPHERES}", "campaign.toml", machine, "dmu60", era=Era(usual))


@pytest.mark.parametrize(
    ("tool", "stds"),
    [
        ("", {"tool_x": 5e-6, "tool_y": 5e-6, "tool_z": 1e-4}),
        ('tool_length = "2 um"\n', {"tool_x": 2e-6, "tool_y": 2e-6, "tool_z": 2e-6}),
        ('tool_length = "30 um"\n', {"tool_x": 5e-6, "tool_y": 5e-6, "tool_z": 3e-5}),
        ('tool_length = "0 um"\n', {}),
        ('tool_length = "0 um"\ntool_eccentricity = "9 um"\n', {"tool_x": 9e-6, "tool_y": 9e-6}),
    ],
)
def test_how_well_the_tool_is_known_is_stated_once_for_all_that_touch(tool: str, stds: Mapping[str, float]) -> None:
    (setup,) = _at_spheres(tool).setups
    assert {u.name: u.std for u in setup.unknowns if "tool" in u.name} == pytest.approx(stds)


def test_records_of_before_keep_the_doubt_of_the_tool_that_they_were_begun_with() -> None:
    (setup,) = _at_spheres("", usual=False).setups
    assert {each.name: each.std for each in setup.unknowns if "tool" in each.name} == {"tool_z": 5e-6}
