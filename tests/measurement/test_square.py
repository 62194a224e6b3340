"""A square lies at one turn that both of its legs share, with opposite signs: together they show squareness."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.machine import load_machine
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator
from axiscal.numerics import Array

SQUARE = '[[artefacts]]\nname = "square"\nturned = "1 mrad"\n'
ALONG_X = """
[[setups]]
name = "leg along x"
instrument = "straightedge"
artefact = "square"
direction = "y"
moves = ["X"]
reach = { X = ["100 mm", "400 mm"] }
approach = "both"
"""
ALONG_Y = """
[[setups]]
name = "leg along y"
instrument = "straightedge"
artefact = "square"
direction = "x"
moves = ["Y"]
reach = { Y = ["50 mm", "350 mm"] }
approach = "both"
"""


def described(*legs: str) -> CampaignDescription:
    text = "\n".join(['machine = "three-axis-mill"', SQUARE, *legs])
    return campaign_from_texts(text, "campaign.toml", load_machine("three-axis-mill").text, "three-axis-mill")


def readings(campaign: CampaignDescription, seed: int) -> tuple[list[Reading], float]:
    """Return readings of every leg by a machine and square drawn from what is stated, and its squareness of X and Y."""
    truth = Simulator(campaign.machine, campaign.setups).drawn(seed)
    rng, taken = np.random.default_rng(seed), []
    for setup in campaign.setups:
        (moving,) = setup.moves
        low, high = setup.span(campaign.machine.axes[moving], moving)
        for at in np.linspace(low + 0.002, high - 0.002, 16):
            for side in (1, -1):
                pose = tuple(float(at) if k == moving else park for k, park in enumerate(setup.park))
                approach = tuple(side if k == moving else 0 for k in range(len(pose)))
                value, *_ = truth.read_all(setup, pose, approach, rng, 0.0)
                taken.append(Reading(setup.name, pose, approach, value, time=0.0))
    at = _middle(campaign)
    return taken, float(_skew(campaign, at) @ np.array(truth.deviation(at, np.zeros_like(at))).ravel())


def _middle(campaign: CampaignDescription) -> Array:
    """Return poses at the ends of both legs, (4, q)."""
    x, y = (campaign.machine.index(name) for name in "XY")
    park = np.array([sum(axis.travel) / 2 for axis in campaign.machine.axes])
    poses = np.tile(park, (4, 1))
    poses[:2, x], poses[2:, y] = [0.1, 0.4], [0.05, 0.35]
    return poses


def _skew(campaign: CampaignDescription, poses: Array) -> Array:
    """Return the row that reads how much less than 90 deg the chords of both legs enclose, over (4, 3) deviations."""
    row = np.zeros((4, 3))
    row[0, 1], row[1, 1] = -1 / 0.3, 1 / 0.3
    row[2, 0], row[3, 0] = -1 / 0.3, 1 / 0.3
    return row.ravel()


def found(campaign: CampaignDescription, taken: list[Reading]) -> tuple[float, float]:
    """Return mean and std of the squareness over the legs."""
    case = Case(campaign)
    known = case.knowledge.read(taken)
    poses = _middle(campaign)
    rows = _skew(campaign, poses) @ case.errors.rows(poses, np.zeros_like(poses)).reshape(-1, case.errors.size)
    belief = known.belief
    own = belief.factor[: case.errors.size]
    return float(rows @ belief.mean[: case.errors.size]), float(np.linalg.norm(rows @ own))


def test_the_legs_see_the_turn_with_opposite_signs_and_it_is_one_unknown() -> None:
    case = Case(described(ALONG_X, ALONG_Y))
    shared = [u for u in case.observation.setups[0].unknowns if u.owner == "square"]
    assert [u.name for u in shared] == ["square_x", "square_y", "square_z"]
    columns = [case.observation.unknowns_of(k) for k in (0, 1)]
    both = sorted(set(columns[0].tolist()) & set(columns[1].tolist()))
    assert len(both) == 3
    park = np.array(case.description.setups[0].park)
    slopes = []
    for k, name in enumerate("XY"):
        poses = np.tile(park, (2, 1))
        index = case.description.machine.index(name)
        poses[1, index] += 0.1
        seen = case.observation.rows(k, poses, np.zeros_like(poses)).rows
        slopes.append((seen[1] - seen[0])[both] / 0.1)
    np.testing.assert_allclose(slopes[0], [0, 0, 1], atol=1e-9)
    np.testing.assert_allclose(slopes[1], [0, 0, -1], atol=1e-9)


def test_one_leg_shows_no_squareness_and_two_do() -> None:
    both, one = described(ALONG_X, ALONG_Y), described(ALONG_X)
    before = found(both, [])[1]
    alone = found(one, readings(one, 1)[0])[1]
    together = found(both, readings(both, 1)[0])[1]
    assert alone > 0.5 * before
    assert together < 0.15 * before


@pytest.mark.parametrize("seed", range(3))
def test_what_two_legs_find_is_the_squareness_of_the_machine(seed: int) -> None:
    campaign = described(ALONG_X, ALONG_Y)
    taken, true = readings(campaign, seed)
    mean, std = found(campaign, taken)
    assert abs(mean - true) < 4 * std
