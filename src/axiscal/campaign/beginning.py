"""The beginning of a campaign: its record with a plan in it, or nothing."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import CampaignDescription


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
