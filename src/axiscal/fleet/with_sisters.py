"""A campaign with what its sisters teach: the one door by which records become a prior."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from axiscal.description.campaign import CampaignDescription, read_campaign
from axiscal.exceptions import RecordError
from axiscal.fleet.type_learning import DOUBT, learnt_type
from axiscal.record.gathering import gathered


def campaign_with_sisters(
    path: str | Path,
    *,
    target_needed: bool = True,
    asking: bool = True,
    told: Callable[[str], None] = lambda said: None,
) -> CampaignDescription:
    """Return the campaign in a file, with the prior that the records named under [sisters] teach.

    As `read_campaign` for a campaign that names none; told : called with what is being done. Raises InputError.
    """
    described = read_campaign(path, target_needed=target_needed, asking=asking)
    return with_sisters(described, told)


def with_sisters(
    described: CampaignDescription, told: Callable[[str], None] = lambda said: None
) -> CampaignDescription:
    """Return a campaign with what its sisters teach as its prior; itself where it names none."""
    named = described.sisters
    if named is None or described.prior_text:
        return described
    if not named.records:
        remedy = 'Give a pattern beside the campaign, such as records = "records/*.axiscal", or "store:"'
        raise RecordError("[sisters] names no record that is there", remedy, described.source)
    doubt = DOUBT if described.doubt is None else described.doubt
    files = gathered(named.records)
    prior = learnt_type(files, described.machine, named.directions, doubt, told, named.type)
    return replace(described, prior_text=prior.text())
