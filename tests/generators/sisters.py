"""Machines of one made-up type: a slide with one laser, small enough that a folder of records takes no time."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import repeat
from pathlib import Path

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.case import Case, ends_along
from axiscal.measurement.reading import Place, Reading
from axiscal.measurement.simulation import VirtualMachine
from examples.virtual_sisters import Imagined, VirtualType

MACHINE = """name = "Slide"
chain = "w-b-X-t"
{serial}[axes.X]
travel = ["0 mm", "{travel} mm"]
[errors]
EXX = {{ std = "20 um", knots = 7, length = "150 mm" }}
EXX_reversal = {{ std = "6 um" }}
"""
CAMPAIGN = """machine = "machine.toml"
usual = "off"
sure = "exactly"
{first}[target]
rms = "2 um"
aligned = false
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
moves = ["X"]
approach = "both"
noise = "0.5 um"
unknowns = {{ zero = "100 um" }}
"""
PLACES = tuple(Place("laser", (x,), (side,)) for x in np.linspace(0.02, 0.48, 8).tolist() for side in (1, -1))


def slide(
    prior: str = "", first: str = "", serial: str = "", travel: int = 500, usual: str = "off"
) -> CampaignDescription:
    """Return the campaign of a slide.

    prior : what its type has taught; first : lines of campaign.toml; usual : "on" with what usually goes wrong
    """
    machine = MACHINE.format(serial=f'serial = "{serial}"\n' if serial else "", travel=travel)
    text = CAMPAIGN.format(first=first).replace('usual = "off"', f'usual = "{usual}"')
    return campaign_from_texts(text, "campaign.toml", machine, "machine.toml", prior_text=prior)


HALF = Imagined(0.5, 0.8)
"""Machines half as large as stated, four fifths of the variance in common."""


def measured(case: Case, machine: VirtualMachine, places: Sequence[Place], seed: int) -> tuple[Reading, ...]:
    """Return what is read of a virtual machine along a plan."""
    chance = repeat(np.random.default_rng((seed, 6)))
    return machine.measured(case.description.setups, places, ends_along(case, places), chance)


def read_on(number: int, imagined: Imagined = HALF, seed: int = 3, again: int = 0) -> list[Reading]:
    """Return what is read of one machine of a type.  again : with other noise"""
    machine, _ = VirtualType(slide(), imagined, seed).drawn(number)
    return list(measured(Case(slide()), machine, PLACES, number + 1000 * again))


def write_record(file: Path, described: CampaignDescription, readings: Sequence[Reading]) -> Path:
    """Write a record of readings, and return its file."""
    with Campaign.create(file, described) as campaign:
        campaign.adopt(tuple(readings))
    return file


def shop(folder: Path, count: int) -> list[Path]:
    """Return the records of so many sisters in a folder."""
    return [write_record(folder / f"slide-{n}.axiscal", slide(), read_on(n)) for n in range(count)]
