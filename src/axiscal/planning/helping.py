"""The set-ups that would bring a target which no reading of a campaign can reach, and what they take."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.description.first_campaign import OFFERED
from axiscal.description.target import Target
from axiscal.design.plan.plan import make_plan
from axiscal.design.plan.task import Limits
from axiscal.estimation.case import Case
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.uncertain import as_standard
from axiscal.exceptions import InputError, PlanError
from axiscal.measurement.setup import Setup
from axiscal.planning.next_readings import posed
from axiscal.planning.promise import asked
from axiscal.units import format_quantity

_KINDS = ("interferometer", "ballbar", "straightedge", "sphere")
"""Those whose set-ups follow from the machine alone, and of which nothing has to be looked up first."""
_TOGETHER = 2
"""Set-ups that are added at most: more are another campaign."""
_CANDIDATES = 400
"""Enough for the readings and minutes of a plan that is only told."""


def helping_words(case: Case, target: Target) -> str:
    """Return which further set-ups would let a target be reached, with readings and minutes; "" where none would."""
    described, added = replace(case.description, target=target), list[Setup]()
    for _ in range(_TOGETHER):
        tried = [(_missed(each), each, setup) for each, setup in _with_one_more(described)]
        if not tried:
            return ""
        missed, described, setup = min(tried, key=lambda each: each[0])
        added.append(setup)
        if missed < 1.0:
            return _words(described, target, added)
    return ""


def _missed(described: CampaignDescription) -> float:
    """Return how many times its limit the accuracy is left at that comes nearest to its own."""
    return min(each.floor / each.limit for each in asked(described.target, case_of(described).yardstick))


def _with_one_more(described: CampaignDescription) -> Iterator[tuple[CampaignDescription, Setup]]:
    """Yield the campaign with each set-up of a usual instrument that it does not have."""
    names = {setup.name for setup in described.setups}
    for text in (text for kind in _KINDS for text in OFFERED[kind](described.machine)):
        machine = described.machine.text, described.machine_source
        try:
            found = campaign_from_texts(f"{described.text}\n{text}", described.source, *machine).setups[-1]
        except InputError:  # an artefact of that name stands there already
            continue
        if found.name not in names:
            yield replace(described, setups=(*described.setups, found)), found


def _words(described: CampaignDescription, target: Target, added: list[Setup]) -> str:
    """Return what would help, with the readings and minutes of a plan for it."""
    case, names = case_of(described), " and ".join(f'"{setup.name}"' for setup in added)
    wanted = None if target.expanded is None else as_standard(case, case.knowledge, target.expanded)
    rms = max([each for each in (target.rms, wanted) if each is not None], default=None)
    limits = Limits(target.readings, rms, target.worst, target.budget)
    try:
        made = make_plan(posed(case, case.knowledge, candidates=_CANDIDATES), limits, patience=0.0, bounded=False)
    except PlanError:
        return f"With {names} as well it can be reached"
    count, minutes = len(made.readings), format_quantity(made.seconds, "min", 3)
    met = "it can be reached" if made.met else "it comes nearer"
    return f"With {names} as well {met}: {count} readings in {minutes} for all set-ups"
