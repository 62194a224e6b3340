"""What stands between a campaign and its end, said after every reading: what is promised and not vouched for."""

from __future__ import annotations

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import standing
from axiscal.guide.language import said
from axiscal.units import to_unit


def standing_words(campaign: Campaign) -> list[str]:
    """Return sentences about where the campaign stands; none where nothing is to be minded."""
    found = standing(campaign.description.target, campaign.known())
    if found.promised is None:
        return []
    what = (
        "The {name} target is promised, and does not count as reached: what the readings can vouch for is a standard "
        "uncertainty of {size} um."
    )
    return [said(what, name=found.promised, size=f"{to_unit(found.vouched, 'um'):.3g}")]
