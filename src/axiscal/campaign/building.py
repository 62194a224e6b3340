"""The engine that a campaign has unless it is given another."""

from __future__ import annotations

from axiscal.campaign.description import CampaignDescription
from axiscal.campaign.engine import Engine


def build(description: CampaignDescription) -> Engine:
    """Return the engine of a campaign; what it needs is loaded when it is first asked."""
    from axiscal.campaign.calibration import Calibration
    from axiscal.campaign.inheritance import problem_of

    return Calibration(problem_of(description))
