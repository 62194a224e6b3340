"""Campaigns on built-in machines; one of two set-ups in turn, of one value and three, whose zero drifts."""

import re
from collections.abc import Mapping

import numpy as np

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.machine import load_machine
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator
from tests.generators.texts import Said, campaign_text, setup_text

CAMPAIGN = campaign_text(
    "three-axis-mill",
    setup_text("probe", "probe", direction="x", approach="both"),
    setup_text("nest", "rtest", station=["0 mm", "0 mm", "-300 mm"], approach="both", drift="3 um/h"),
    target={"readings": 1},
)


def built_in(text: str, machine: str = "three-axis-mill") -> CampaignDescription:
    """Return a campaign on a built-in machine.  text : of campaign.toml; machine : where the text names none"""
    named = re.match(r'machine = "(.*)"', text)
    whole, name = (text, named[1]) if named else (f'machine = "{machine}"\n{text}', machine)
    return campaign_from_texts(whole, "campaign.toml", load_machine(name).text, name)


def on(machine: str, *setups: str, target: Mapping[str, Said] | None = None, **first: Said) -> CampaignDescription:
    """Return a campaign of set-ups on a machine, by their texts.  target, first : as of `campaign_text`"""
    return campaign_from_texts(campaign_text("m", *setups, target=target, **first), "c.toml", machine, "m")


def mixed(first_line: str = "") -> Case:
    """Return the problem.  first_line : of the campaign file"""
    text = f"{first_line}\n{CAMPAIGN}"
    return Case(campaign_from_texts(text, "campaign.toml", load_machine("three-axis-mill").text, "mill"))


def drawn(problem: Case, count: int = 24) -> list[Reading]:
    """Return readings of a virtual machine, 200 s apart, every fifth with its own std."""
    rng, setups = np.random.default_rng(3), problem.description.setups
    machine = Simulator(problem.description.machine, setups).drawn(3)
    low, high = np.array([axis.travel for axis in problem.description.machine.axes]).T

    def taken(i: int) -> Reading:
        setup, pose = setups[i % 2], tuple(rng.uniform(low, high).tolist())
        approach = tuple(int(sign) for sign in rng.choice([-1, 0, 1], 3))
        value, *others = machine.read_all(setup, pose, approach, rng, 200.0 * i)
        std = 2e-6 if i % 5 == 0 else None
        return Reading(setup.name, pose, approach, value, std, others=tuple(others), time=200.0 * i)

    return [taken(i) for i in range(count)]
