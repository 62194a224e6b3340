"""The campaign by which a machine is measured again: the last one's, with what that learnt, and with a new prior."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from axiscal.description.campaign import CampaignDescription
from axiscal.design.plan.plan import Plan
from axiscal.design.plan.task import Limits
from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Estimation
from axiscal.exceptions import PlanError
from axiscal.planning.proposal import proposed
from axiscal.promise.problem import Inherited


def again(known: Estimation) -> CampaignDescription:
    """Return the description of a campaign with noise and sizes as learnt, and places anew."""
    described, learnt = known.stated.description, known.case.description
    pairs = zip(described.setups, learnt.setups, strict=True)
    setups = tuple(replace(mine, noise=found.noise) for mine, found in pairs)
    return replace(described, machine=learnt.machine, setups=setups)


def case_again(described: CampaignDescription, prior: Inherited) -> Case:
    """Return the case of a machine of which so much is known; readings and minutes end it no more."""
    target = replace(described.target, readings=None, budget=None)
    plain = replace(described, prior_text="", sisters=None, doubt=None, target=target, sure="exactly", usual=False)
    return Case(plain, prior)


def recalibration(
    known: Estimation, prior: Inherited, rms: float | None, told: Callable[[str], None] = lambda said: None
) -> Plan:
    """Return the plan by which a machine is measured again: until the targets of its last campaign.

    prior : what is known of it by then; rms : that campaign's target of an RMS or U, as an RMS, m
    Raises PlanError where no readings reach them, or none has to: of a plan without readings nothing becomes better.
    """
    target, case = known.stated.description.target, case_again(again(known), prior)
    limits = Limits(target.readings, rms, target.worst, target.budget)
    if limits.met(case.yardstick.measure(case.knowledge.belief)):
        raise PlanError("what is known of it meets the target of its last campaign", "Ask for less in a campaign")
    return proposed(case, limits, progress=told, bounded=False).plan
