"""Set-ups that were mounted anew while a campaign went on elsewhere: as described, with unknowns of their own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from axiscal.description.campaign import CampaignDescription
from axiscal.measurement.setup import Setup
from axiscal.record.events import Mounted


def with_mounted(description: CampaignDescription, mounted: Sequence[Mounted]) -> CampaignDescription:
    """Return a campaign with its set-ups as they were mounted anew behind them.

    What belongs to a set-up alone is as stated once more, whatever is known of the other one: zero, slope, station,
    and how its zero wanders. What an artefact, a bar or a tool owns stays one quantity.
    Raises DescriptionError where there is no such set-up.
    """
    for each in mounted:
        anew = replace(description.setup(each.setup), name=each.name)
        description = replace(description, setups=(*description.setups, anew))
    return description


def stands_with_others(setup: Setup) -> str:
    """Return what else would have to be mounted anew with a set-up: what owns the place it reads at; "" for nothing."""
    standing = "" if setup.artefact is None else setup.artefact.standing
    for unknown in setup.unknowns:
        if unknown.owner and (unknown.owner == standing or unknown.name.startswith("station_")):
            return unknown.owner
    return ""
