"""Plan, measure, estimate, stop, compensate and report, on a machine whose truth is known to the demo only.

That truth is made of measured shapes on the axes of a machine, scaled to what its description expects.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import resources
from pathlib import Path

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import Milestone, reaches
from axiscal.campaign.sources.source import SimulatedSource
from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.evaluation.check import Check
from axiscal.machine import load_machine
from axiscal.measurement.simulation import Simulator, TruthCurve, VirtualMachine
from axiscal.present.answer import TablesChecked
from axiscal.present.check_answer import tables_checked
from axiscal.present.delivery import deliver
from axiscal.present.result import Result
from axiscal_core.machine import Machine

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


def run_demo(case: Case, out: Path, watch: Callable[[Milestone], None]) -> Result:
    """Run the campaign into a folder and return its result.

    watch : called with every reading.  Raises RecordError if there is a campaign already.
    """
    truth = hidden_machine(case)
    with Campaign.create(out / "campaign.axiscal", case.description) as campaign:
        campaign.run(SimulatedSource(truth, SEED), watch)
        estimation = campaign.estimate(ended=True)
        return deliver(campaign, estimation, out, checked=checked(campaign, truth))


def checked(campaign: Campaign, truth: VirtualMachine) -> TablesChecked | None:
    """Return what twelve new places of the true machine show of the tables; None where the target is not reached."""
    if not reaches(campaign.description.target, campaign.estimate(ended=True)):
        return None
    check = Check.from_campaign(campaign, CONTROL)
    readings = check.read_on(truth, SEED, check.planned(tolerance=check.known(None)))
    return tables_checked(check.judged(readings, None))


def measured_truth(model: Machine, seed: int) -> dict[str, TruthCurve]:
    """Return a curve for every error of the model: a measured shape for a motion, a drawn value for a constant.

    seed : of the constants, and of which shape goes where
    """
    rng = np.random.default_rng(seed)
    text = resources.files("axiscal.present.demo").joinpath("shapes.csv").read_text(encoding="utf-8")
    shapes = tuple(np.array([float(v) for v in line.split(",")[1].split()]) for line in text.splitlines()[1:])
    order = rng.permutation(len(shapes))
    curves, used = {}, 0
    for function in model.curves:
        if function.spline.size == 1:
            value = np.sqrt(function.covariance[0, 0]) * rng.standard_normal()
            curves[function.name] = TruthCurve(np.zeros(1), np.array([value]))
            continue
        lap, place = divmod(used, len(shapes))
        shape, axis, size = shapes[order[place]], model.axes[function.axis], function.spline.size
        shape, even = shape[:: -1 if lap else 1], np.linspace(0.0, 1.0, len(shape))
        values = shape - (shape[0] + (shape[-1] - shape[0]) * even) if axis.cyclic else shape
        # the RMS that the prior expects of a curve beyond its constant and slope, which the shapes do not have
        straight = np.vander(np.linspace(-1.0, 1.0, size), 2)
        bend = np.eye(size) - straight @ np.linalg.pinv(straight)
        expected = float(np.sqrt(np.trace(bend @ function.covariance @ bend) / size))
        values = values / np.sqrt(np.mean(values**2)) * expected
        curves[function.name] = TruthCurve(np.linspace(*axis.travel, len(shape)), values)
        used += 1
    return curves
