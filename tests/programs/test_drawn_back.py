"""Programs that go off a ball and back to it, read by a reader of their own and driven by matrices of their own."""

import math
import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.exceptions import ProgramError
from axiscal.machine import load_machine
from axiscal.measurement.candidates import chart_candidates
from axiscal.measurement.reading import Place
from axiscal.programs import Program, controllers, dialect, programs
from tests.generators.printed_machine import printed_machine
from tests.generators.said_places import Said
from tests.generators.texts import artefact_text, campaign_text, setup_text
from tests.generators.ways_said import WaysSaid

SPHERES = campaign_text(
    "dmu60",
    artefact_text("balls", balls={"low": ["200 mm", "0 mm", "-80 mm"], "high": ["-100 mm", "170 mm", "120 mm"]}),
    setup_text("nest", "sphere", artefact="balls", raster={"B": "15 deg", "C": "15 deg"}, approach="both"),
)
NEST = SPHERES.replace("sphere", "rtest")
BAR = campaign_text(
    "dmu60", setup_text("bar", "ballbar", length="150 mm", station=["0 mm", "0 mm", "100 mm"], plane="xy")
)


def described(text: str) -> CampaignDescription:
    return campaign_from_texts(text, "campaign.toml", load_machine("dmu60").text, "dmu60")


def places_of(campaign: CampaignDescription, count: int = 12, seed: int = 1) -> list[Place]:
    """Return places of the set-up in any order, from any side."""
    (setup,) = campaign.setups
    assert setup.chart is not None
    poses, approaches = chart_candidates(campaign.machine, setup, setup.chart, 400)
    chosen = np.random.default_rng(seed).choice(len(poses), min(count, len(poses)), replace=False)
    sides = approaches[chosen].astype(int).tolist()
    return [Place(setup.name, tuple(p), tuple(s)) for p, s in zip(poses[chosen].tolist(), sides, strict=True)]


@cache
def made(controller: str) -> tuple[Said, list[Place], Program]:
    """Return what a campaign says, eight places of it, and the program."""
    campaign = described(SPHERES)
    places = places_of(campaign, 8, 0)
    (program,) = programs(campaign.machine, campaign.setups, places, dialect(controller))
    return Said(SPHERES, printed_machine(load_machine("dmu60").text)), places, program


def holds(controller: str, text: str) -> int:
    """Assert that nothing is run into on the ways of a program; returns their number."""
    said, places, _ = made(controller)
    planned = {number: np.array(place.pose) for number, place in enumerate(places, start=1)}
    return WaysSaid(said, places[0].setup, controller).holds(text, planned)


@pytest.mark.parametrize("controller", controllers())
def test_what_touches_is_drawn_back_from_reading_to_reading(controller: str) -> None:
    _, places, program = made(controller)
    assert holds(controller, program.text) == len(places) - 1
    for place, row in zip(places, program.readings, strict=True):  # the list says where is read, not where it stands
        written = [float(text) for text in row.coordinates]
        planned = [math.degrees(v) if a.rotary else 1e3 * v for a, v in zip(row.axes, place.pose, strict=True)]
        np.testing.assert_allclose(written, planned, atol=6e-4)


@pytest.mark.parametrize("way", ["G53 G1 Z-1.0000 F100", "G53 G1 {} F100"])
def test_the_judge_sees_what_is_run_into_or_out_of_its_travel(way: str) -> None:
    said, places, program = made("linuxcnc")
    slides = zip(said.machine.axes[2:], places[1].pose[2:], strict=True)
    ball = " ".join(f"{axis.name}{1e3 * at:.4f}" for axis, at in slides)
    with pytest.raises(AssertionError):
        holds("linuxcnc", program.text.replace("(READING 3)", f"{way.format(ball)}\n(READING 3)"))


def test_two_nanometres_off_a_ball_are_seen() -> None:
    said, places, _ = made("linuxcnc")
    assert said.holds(places[0]) == "artefact"
    for axis in range(2, 5):
        pose = list(places[0].pose)
        pose[axis] += 2e-9
        with pytest.raises(AssertionError):
            said.holds(replace(places[0], pose=tuple(pose)))


@pytest.mark.parametrize("text", [NEST, BAR])
def test_what_stays_in_touch_has_a_plan_and_no_program(text: str) -> None:
    campaign = described(text)
    (setup,) = campaign.setups
    with pytest.raises(ProgramError, match=re.escape(f'the instrument of "{setup.name}" stays in touch')):
        programs(campaign.machine, campaign.setups, places_of(campaign, 3), dialect("linuxcnc"))
