"""The judge of plans and programs sees what is two nanometres off, run into, or torn off."""

from __future__ import annotations

import re
from functools import cache

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.machine import load_machine
from axiscal.measurement.reading import Place
from axiscal.numerics import Array
from axiscal.programs import dialect, programs
from tests.generators.printed_machine import printed_machine
from tests.generators.said_places import Said
from tests.generators.ways_said import WaysSaid
from tests.programs.test_programs_in_touch import places_of

TEXT = """
machine = "dmu60"
[[artefacts]]
name = "balls"
balls = {{ low = ["200 mm", "0 mm", "-80 mm"], high = ["-100 mm", "170 mm", "120 mm"] }}
[[setups]]
name = "s"
instrument = "{instrument}"
artefact = "balls"
{ball}
raster = {{ B = "15 deg", C = "15 deg" }}
approach = "both"
"""
KINDS = {"rtest": 'ball = "low"', "sphere": ""}


@cache
def printed(instrument: str) -> tuple[Said, tuple[Place, ...], str]:
    """Return what a campaign says, eight places of it, and the program that LinuxCNC gets."""
    text = TEXT.format(instrument=instrument, ball=KINDS[instrument])
    source = load_machine("dmu60").text
    campaign = campaign_from_texts(text, "campaign.toml", source, "dmu60")
    places = tuple(places_of(campaign, 8, 2))
    (program,) = programs(campaign.machine, campaign.setups, places, dialect("linuxcnc"))
    return Said(text, printed_machine(source)), places, program.text


def poses_of(places: tuple[Place, ...]) -> dict[int, Array]:
    return {number: np.array(place.pose) for number, place in enumerate(places, start=1)}


@pytest.mark.parametrize("instrument", KINDS)
def test_what_is_right_holds(instrument: str) -> None:
    said, places, text = printed(instrument)
    assert {said.holds(place) for place in places} == {"artefact"}
    assert WaysSaid(said, "s", "linuxcnc").holds(text, poses_of(places)) == 7


@pytest.mark.parametrize("instrument", KINDS)
@pytest.mark.parametrize("axis", range(2, 5))
def test_two_nanometres_off_a_ball_are_seen(instrument: str, axis: int) -> None:
    said, places, _ = printed(instrument)
    pose = list(places[0].pose)
    pose[axis] += 2e-9
    with pytest.raises(AssertionError):
        said.holds(Place("s", tuple(pose), places[0].approach))


def test_a_nest_that_is_torn_off_on_the_way_is_seen() -> None:
    said, places, text = printed("rtest")
    lines = text.splitlines()
    way = next(k for k, line in enumerate(lines) if "READING 1)" in line)
    after = next(k for k in range(way, len(lines)) if re.match(r"G1 .*[BC]", lines[k]))
    torn = [*lines[:after], "G1 X200.002000 F100", "G1 X200.000000 F100", *lines[after:]]
    with pytest.raises(AssertionError):
        WaysSaid(said, "s", "linuxcnc").holds("\n".join(torn), poses_of(places))


def test_a_way_that_leaves_the_travel_and_one_through_a_ball_are_seen() -> None:
    said, places, text = printed("sphere")
    lines = text.splitlines()
    second = next(k for k, line in enumerate(lines) if "READING 2)" in line)
    low = [*lines[: second + 1], "G53 G1 Z-1.0000 F100", *lines[second + 1 :]]
    with pytest.raises(AssertionError):
        WaysSaid(said, "s", "linuxcnc").holds("\n".join(low), poses_of(places))
    at_ball = [f"{axis.name}{1e3 * at:.4f}" for axis, at in zip(said.machine.axes[2:], places[1].pose[2:], strict=True)]
    into = [*lines[: second + 1], f"G53 G1 {' '.join(at_ball)} F100", *lines[second + 1 :]]
    with pytest.raises(AssertionError):
        WaysSaid(said, "s", "linuxcnc").holds("\n".join(into), poses_of(places))
