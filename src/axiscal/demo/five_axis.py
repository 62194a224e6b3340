"""Plan, measure, estimate, stop, compensate and report, on a machine whose truth is known to the demo only."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from importlib import resources
from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.milestones import Milestone
from axiscal.campaign.sources.simulated import SimulatedSource
from axiscal.demo.measured_truth import measured_truth
from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Estimation
from axiscal.machine import load_machine
from axiscal.measurement.place import Place
from axiscal.record.events import Asked
from axiscal.report.delivery import deliver, reached
from axiscal.report.summarising import Extras
from axiscal.report.summary import Summary, TruthCheck
from axiscal.simulation import Simulator, VirtualMachine
from axiscal.units import to_unit

SEED = 2005
"""Any seed: the demo is to be the same every time."""


def description() -> CampaignDescription:
    """Return the demo's campaign on the built-in five-axis machine."""
    text = resources.files("axiscal.demo").joinpath("campaign.toml").read_text(encoding="utf-8")
    return campaign_from_texts(text, "demo campaign.toml", load_machine("dmu60").text, "dmu60")


def hidden_machine(case: Case) -> VirtualMachine:
    """Return the machine with the measured curves, which the estimate never sees."""
    simulator = Simulator(case.description.machine, case.description.setups)
    return simulator.with_curves(measured_truth(case.errors, SEED), SEED)


def run_demo(
    case: Case, out: Path, planned: Callable[[Sequence[Place]], None], watch: Callable[[Milestone], None]
) -> Summary:
    """Run the campaign into a folder and return what is said of it.

    planned : called with the plan; watch : called with every reading
    Raises RecordError if there is a campaign already.
    """
    truth = hidden_machine(case)
    with Campaign.create(out / "campaign.axiscal", case.description) as campaign:
        first = campaign.next()
        if isinstance(first, Asked):
            planned((first.place, *campaign.state.plan))
        campaign.run(SimulatedSource(truth, SEED), watch)
        estimation = campaign.concluded()
        extras = Extras(truth=truth, truth_check=truth_check(estimation, truth), compared=True)
        return deliver(campaign, estimation, out, extras)


def truth_check(estimation: Estimation, truth: VirtualMachine) -> TruthCheck:
    """Return the accuracy promised and the accuracy reached over the volume, and the RMS error as found."""
    before, after = as_found_and_left(estimation, truth)
    return TruthCheck(to_unit(estimation.accuracy.rms, "um"), to_unit(after, "um"), to_unit(before, "um"))


def as_found_and_left(estimation: Estimation, truth: VirtualMachine) -> tuple[float, float]:
    """Return the RMS deviation of the machine, and what the estimate does not know of it, m."""
    blank = replace(estimation.estimate(), belief=estimation.case.prior)
    yardstick, found = estimation.case.yardstick, truth.deviation
    return reached(yardstick, blank, found), reached(yardstick, estimation.estimate(), found)
