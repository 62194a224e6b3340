"""Readings of virtual machines, and records of them."""

from collections.abc import Sequence
from itertools import repeat
from pathlib import Path

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import CampaignDescription
from axiscal.estimation.case import Case
from axiscal.measurement.reading import Place, Reading
from axiscal.measurement.simulation import VirtualMachine


def measured(case: Case, machine: VirtualMachine, places: Sequence[Place], seed: int) -> tuple[Reading, ...]:
    """Return what is read of a virtual machine along a plan."""
    chance = repeat(np.random.default_rng((seed, 6)))
    return machine.measured(
        case.description.setups, places, np.cumsum(case.seconds_along(None, places)).tolist(), chance
    )


def write_record(file: Path, described: CampaignDescription, readings: Sequence[Reading]) -> Path:
    """Write a record of readings, and return its file."""
    with Campaign.create(file, described) as campaign:
        campaign.adopt(tuple(readings))
    return file
