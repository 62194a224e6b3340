"""What the prior of a type saves: the plan with it beside the plan without."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from axiscal.description.campaign import CampaignDescription
from axiscal.design.plan.plan import Plan
from axiscal.design.plan.task import Limits
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.uncertain import as_standard
from axiscal.exceptions import TargetError
from axiscal.planning.proposal import proposed


@dataclass(frozen=True, eq=False, slots=True)
class Saving:
    """stated : the plan by the stated prior; taught : the plan by what its type has taught"""

    stated: Plan
    taught: Plan

    @property
    def readings(self) -> int:
        """How many readings fewer."""
        return len(self.stated.readings) - len(self.taught.readings)

    @property
    def seconds(self) -> float:
        """How much less time, s."""
        return self.stated.seconds - self.taught.seconds


def saving(described: CampaignDescription, text: str, told: Callable[[str], None] = lambda said: None) -> Saving:
    """Return both plans of a campaign.  text : what its type has taught; told : called with what is being done

    Raises TargetError where nothing would end the plans, PlanError.
    """
    plain = replace(described, prior_text="", sisters=None)
    if plain.target.empty:
        raise TargetError("nothing would ever end this plan", 'Give the campaign a target, such as rms = "4 um"')
    return Saving(
        _planned(plain, lambda said: told(f"as stated: {said}")),
        _planned(replace(plain, prior_text=text), lambda said: told(f"by its type: {said}")),
    )


def _planned(described: CampaignDescription, told: Callable[[str], None]) -> Plan:
    case, target = case_of(described), described.target
    rms = target.rms
    if target.expanded is not None:
        rms = max(rms or 0.0, as_standard(case, case.knowledge, target.expanded))
    return proposed(case, Limits(target.readings, rms, target.worst, target.budget), progress=told).plan
