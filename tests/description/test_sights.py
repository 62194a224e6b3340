"""Where a tracker sees the tool: within its range, and within the cone of its reflector; and what is refused."""

import math

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.measurement.candidates import spread
from axiscal.numerics import Array
from tests.generators.campaigns import built_in
from tests.generators.kinematics import in_travel, tip

STATION = np.array([0.9, -0.9, 0.3])
TWO_PLACES = 'choose_from = [["900 mm", "-900 mm", "300 mm"], ["0 mm", "-900 mm", "300 mm"]]'


STANDING = 'station = ["900 mm", "-900 mm", "300 mm"]'


def described(keys: str, instrument: str = "tracker", standing: str = STANDING) -> CampaignDescription:
    text = f"""
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
    return built_in(text, "dmu60")


def seen(campaign: CampaignDescription, pose: Array) -> tuple[float, float]:
    """Return how far the tool is from the station, m, and by how much the station is off the x direction, deg."""
    assert in_travel(campaign.machine, pose)
    towards = STATION - tip(campaign.machine, pose)
    far = float(np.linalg.norm(towards))
    return far, math.degrees(math.acos(towards[0] / far))


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
