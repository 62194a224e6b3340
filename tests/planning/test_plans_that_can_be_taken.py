"""Every reading that a plan asks for can be taken: its poses, and the ways between, by matrices of the tests' own."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.exceptions import PlanError
from axiscal.machine import load_machine
from axiscal.measurement.reading import Place
from axiscal.measurement.touched import touching_sides
from axiscal.planning.next_readings import next_places, placed
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from tests.generators.campaigns import built_in
from tests.generators.texts import artefact_text, campaign_text, setup_text

NEST = campaign_text(
    "dmu60",
    artefact_text("ball", balls={"low": ["200 mm", "0 mm", "-80 mm"]}),
    setup_text("nest", "rtest", artefact="ball", approach="both"),
)
BAR = campaign_text(
    "dmu60",
    setup_text("bar", "ballbar", length="150 mm", station=["0 mm", "0 mm", "100 mm"], plane="zx", approach="both"),
)

COARSE = 'raster = { B = "30 deg", C = "30 deg" }\n'
SIDES = {size: list(product((1, -1), repeat=size)) for size in (1, 2)}


def planned(campaign: CampaignDescription, readings: int) -> tuple[Place, ...]:
    case = Case(campaign)
    return placed(case, proposed(case, Limits(readings=readings), 300))


def test_a_plan_of_a_record_of_before_is_refused_with_the_keys_of_every_set_up() -> None:
    """Descriptions that a record holds are read as they are; only what is asked for must say where."""
    nest = '[[setups]]\nname = "nest"\ninstrument = "rtest"\n'
    bar = '[[setups]]\nname = "bar"\ninstrument = "ballbar"\nstation = ["0 mm", "0 mm", "100 mm"]\n'
    both = 'In "nest": write artefact = .* In "bar": write length = "150 mm"'
    for setups, said in ((nest + bar, both), (nest, "Write artefact = ")):
        case = Case(built_in(setups, "dmu60"))
        with pytest.raises(PlanError, match=said):
            next_places(case, case.knowledge, ())


def with_reversals(text: str, *kept: str) -> CampaignDescription:
    """Return a campaign of the five-axis machine with these reversals alone."""
    lines = load_machine("dmu60").text.splitlines()
    machine = "\n".join(line for line in lines if "_reversal" not in line or line.split()[0] in kept)
    return campaign_from_texts(text, "campaign.toml", machine, "dmu60")


@pytest.mark.long
@pytest.mark.parametrize("text", [NEST + COARSE, BAR + 'raster = { arc = "10 deg" }\n'])
def test_in_touch_all_axes_come_from_sides_that_one_way_has(text: str) -> None:
    """Sides of axes without a reversal tell a program where to come from, too: all must be those of one way in."""
    campaign = with_reversals(text, "EXX_reversal")
    (setup,) = campaign.setups
    chart = setup.chart
    assert chart is not None
    places, overrun = planned(campaign, 6), np.array([each.overrun for each in chart.coordinates])
    for place in places:
        (u,) = chart.places(np.array([place.pose]))
        ways = [
            np.array(place.pose) - chart.poses((u - np.array(side) * overrun)[None])[0] for side in SIDES[len(overrun)]
        ]
        assert any(
            all(come == 0 or come * gone > 0 for come, gone in zip(place.approach, way, strict=True)) for way in ways
        )
    assert any(come != 0 for place in places for come in place.approach)


@pytest.mark.long
def test_slides_come_to_three_touches_as_they_touch_whether_or_not_they_have_a_reversal() -> None:
    """From the other side the radius that is larger would show with the other sign."""
    campaign = with_reversals(NEST.replace("rtest", "sphere") + COARSE + "touches = 3\n", "ECC_reversal")
    linear = [k for k, axis in enumerate(campaign.machine.axes) if not axis.rotary]
    for place in planned(campaign, 6):
        pose = np.array([place.pose])
        assert [place.approach[k] for k in linear] == touching_sides(campaign.machine, pose)[0].tolist()
