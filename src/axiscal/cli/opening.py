"""A campaign with its mathematics, as the commands open it."""

from __future__ import annotations

from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.description import CampaignDescription


def tell_out_of_reach(campaign: Campaign) -> None:
    """Say on stderr if the target cannot be reached with the set-ups."""
    from axiscal.campaign.calibration import calibration_of
    from axiscal.campaign.feasibility import out_of_reach
    from axiscal.cli.printing import tell

    said = out_of_reach(calibration_of(campaign.engine).problem)
    if said is not None:
        tell(f"Mind: {said}")


def open_campaign(record: Path, *, write: bool = True) -> Campaign:
    """Return the campaign of a record; raises RecordError."""
    return Campaign.open(record, write=write)


def create_campaign(record: Path, description: CampaignDescription) -> Campaign:
    """Return a new campaign; raises RecordError if something is there already."""
    return Campaign.create(record, description)
