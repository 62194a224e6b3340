"""Where a tracker sees the tool: within its range, and within the cone of its reflector; and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.machine import load_machine
from axiscal.measurement.candidates import spread
from axiscal.numerics import Array
from axiscal.planning.next_readings import placed
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from tests.generators.kinematics import in_travel, tip

STATION = np.array([0.9, -0.9, 0.3])
TWO_PLACES = 'choose_from = [["900 mm", "-900 mm", "300 mm"], ["0 mm", "-900 mm", "300 mm"]]'


STANDING = 'station = ["900 mm", "-900 mm", "300 mm"]'


def described(keys: str, instrument: str = "tracker", standing: str = STANDING) -> CampaignDescription:
    text = f"""
machine = "dmu60"
[[artefacts]]
name = "ball"
balls = {{ one = ["0 mm", "0 mm", "0 mm"] }}
[[artefacts]]
name = "square"
[[setups]]
name = "it"
instrument = "{instrument}"
approach = "both"
{standing}
{keys}
"""
    return campaign_from_texts(text, "campaign.toml", load_machine("dmu60").text, "dmu60")


def seen(campaign: CampaignDescription, pose: Array) -> tuple[float, float]:
    """Return how far the tool is from the station, m, and by how much the station is off the x direction, deg."""
    assert in_travel(campaign.machine, pose)
    towards = STATION - tip(campaign.machine, pose)
    far = float(np.linalg.norm(towards))
    return far, math.degrees(math.acos(towards[0] / far))


@pytest.mark.long
@pytest.mark.parametrize("instrument", ["tracker", "tracer"])
def test_a_reading_is_asked_for_only_where_it_is_seen(instrument: str) -> None:
    campaign = described('range = ["1.2 m", "1.5 m"]\nfaces = "x"\nsight = "50 deg"', instrument)
    candidates = spread(campaign.machine, campaign.setups, 300)
    assert len(candidates) > 100
    found = np.array([seen(campaign, pose) for pose in candidates.poses])
    assert found[:, 0].min() >= 1.2
    assert found[:, 0].max() <= 1.5
    assert found[:, 1].max() <= 50 + 1e-6
    case = Case(campaign)
    for place in placed(case, proposed(case, Limits(readings=3), 200).plan):
        far, off = seen(campaign, np.array(place.pose))
        assert 1.2 <= far <= 1.5
        assert off <= 50 + 1e-6


def test_a_reflector_that_turns_to_the_station_is_seen_from_everywhere_in_range() -> None:
    campaign = described('range = ["0.1 m", "8 m"]')
    candidates = spread(campaign.machine, campaign.setups, 400)
    off = [seen(campaign, pose)[1] for pose in candidates.poses]
    assert min(off) < 30
    assert max(off) > 60


def test_a_reflector_that_does_not_turn_is_seen_within_sixty_degrees_unless_said() -> None:
    campaign = described('faces = "x"')
    candidates = spread(campaign.machine, campaign.setups, 400)
    off = [seen(campaign, pose)[1] for pose in candidates.poses]
    assert 50 < max(off) <= 60 + 1e-6


def test_a_plan_may_choose_from_places_each_of_which_is_a_setup() -> None:
    campaign = described("", "tracer", TWO_PLACES)
    assert [(setup.name, setup.station) for setup in campaign.setups] == [
        ("it at 900, -900, 300", (0.9, -0.9, 0.3)),
        ("it at 0, -900, 300", (0.0, -0.9, 0.3)),
    ]
    assert list(campaign.particulars.setups) == [setup.name for setup in campaign.setups]


def test_an_artefact_at_each_place_stands_there_anew() -> None:
    at = 'artefact = "ball"\nchoose_from = [["0 mm", "0 mm", "50 mm"], ["100 mm", "0 mm", "50 mm"]]'
    first, second = described("", "sphere", at).setups
    assert first.artefact is not None
    assert second.artefact is not None
    assert first.artefact.standing != second.artefact.standing
    moved = np.subtract(second.artefact.balls[0].place, first.artefact.balls[0].place)
    np.testing.assert_allclose(moved, [0.1, 0.0, 0.0])
