"""Plan, measure, estimate, stop, compensate and report, on a machine whose truth is known to the demo only."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from importlib import resources
from pathlib import Path

from axiscal.answers.answer import TablesChecked
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import reaches
from axiscal.campaign.milestones import Milestone
from axiscal.campaign.sources.simulated import SimulatedSource
from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Estimation
from axiscal.evaluation.acceptance.at_the_machine import Taken
from axiscal.evaluation.acceptance.check import Check
from axiscal.machine import load_machine
from axiscal.measurement.place import Place
from axiscal.measurement.simulation import Simulator, VirtualMachine
from axiscal.present.check_answer import check_answer
from axiscal.present.delivery import deliver, reached
from axiscal.present.demo.measured_truth import measured_truth
from axiscal.present.summarising import Extras
from axiscal.present.summary import Summary, TruthCheck
from axiscal.record.events import Asked
from axiscal.units import to_unit

SEED = 2005
"""Any seed: the demo is to be the same every time."""
CONTROL = "linuxcnc-volumetric"
"""The control whose tables are checked."""


def description() -> CampaignDescription:
    """Return the demo's campaign on the built-in five-axis machine."""
    text = resources.files("axiscal.present.demo").joinpath("campaign.toml").read_text(encoding="utf-8")
    return campaign_from_texts(text, "demo campaign.toml", load_machine("dmu60").text, "dmu60")


def hidden_machine(case: Case) -> VirtualMachine:
    """Return the machine with the measured curves, which the estimate never sees."""
    simulator = Simulator(case.description.machine, case.description.setups)
    return simulator.with_curves(measured_truth(case.errors, SEED), SEED)


def run_demo(
    case: Case, out: Path, planned: Callable[[Sequence[Place]], None], watch: Callable[[Milestone], None]
) -> Summary:
    """Run the campaign into a folder and return the words on its result.

    planned : called with the plan; watch : called with every reading
    Raises RecordError if there is a campaign already.
    """
    truth = hidden_machine(case)
    with Campaign.create(out / "campaign.axiscal", case.description) as campaign:
        first = campaign.next()
        if isinstance(first, Asked):
            planned((first.place, *campaign.state.plan))
        campaign.run(SimulatedSource(truth, SEED), watch)
        estimation = campaign.estimate(ended=True)
        check = truth_check(estimation, truth)
        extras = Extras(truth=truth, truth_check=check, compared=True, checked=checked(campaign, truth))
        return deliver(campaign, estimation, out, extras)


def checked(campaign: Campaign, truth: VirtualMachine) -> TablesChecked | None:
    """Return what twelve new places of the true machine show of the tables; None where the target is not reached."""
    if not reaches(campaign.description.target, campaign.estimate(ended=True)):
        return None
    check = Check.of(campaign, CONTROL)
    places = check.planned(tolerance=check.allowed(None))
    judged = check.judged(check.read_on(truth, SEED, places), None)
    return check_answer(judged, len(places), check.promised, Taken()).summary


def truth_check(estimation: Estimation, truth: VirtualMachine) -> TruthCheck:
    """Return the accuracy promised and the accuracy reached over the volume, and the RMS error as found."""
    before, after = as_found_and_left(estimation, truth)
    return TruthCheck(to_unit(estimation.accuracy.rms, "um"), to_unit(after, "um"), to_unit(before, "um"))


def as_found_and_left(estimation: Estimation, truth: VirtualMachine) -> tuple[float, float]:
    """Return the RMS deviation of the machine, and what the estimate does not know of it, m."""
    blank = replace(estimation.estimate(), belief=estimation.case.prior)
    yardstick, found = estimation.case.yardstick, truth.deviation
    return reached(yardstick, blank, found), reached(yardstick, estimation.estimate(), found)
