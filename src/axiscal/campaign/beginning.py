"""The beginning of a campaign: its record with a plan in it, or nothing."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import CampaignDescription, read_campaign
from axiscal.document.ports import part


def begun_campaign(
    path: Path, description: CampaignDescription, told: Callable[[Campaign], None] = lambda campaign: None
) -> Campaign:
    """Return a new campaign with its plan; nothing stays of one that cannot be planned.

    told : called before the plan is made.  Raises InputError.
    """
    campaign = Campaign.create(path, description)
    try:
        told(campaign)
        campaign.prepared()
    except BaseException:
        campaign.close()
        path.unlink(missing_ok=True)  # on a server it stays: nothing is deleted there
        raise
    return campaign


def campaign_with_sisters(path: str | Path, *, target_needed: bool = True, asking: bool = True) -> CampaignDescription:
    """Return the campaign in a file, with the prior that the records named under [sisters] teach.

    As `read_campaign` for a campaign that names none. Raises InputError.
    """
    return with_sisters(read_campaign(path, target_needed=target_needed, asking=asking))


def with_sisters(described: CampaignDescription) -> CampaignDescription:
    """Return a campaign with what its sisters teach as its prior; itself where it names none."""
    named = described.sisters
    if named is None or not named.names_some or described.prior_text:
        return described
    found: CampaignDescription = part("sisters")(described, named)
    return found
