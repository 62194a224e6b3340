"""What a check is of and says: a simulated campaign, readings under a control, and the words for a judgement."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.estimation.case import Case
from axiscal.evaluation.table_checks import Judgement
from axiscal.measurement.reading import Places, Reading
from axiscal.measurement.setup import Setup
from axiscal.measurement.simulation import Simulator, VirtualMachine
from axiscal.numerics import Array
from axiscal.present.check_answer import check_details
from axiscal.tables.surface import Control, left_by
from tests.generators.recorded import measured as read_along
from tests.generators.recorded import write_record

READINGS = 60
"""Of a campaign that states no number."""


def said_of(judgement: Judgement) -> str:
    """Return the words for a judgement."""
    places = [{"place": float(number)} for number in np.unique(judgement.of)]
    return "\n".join(check_details(replace(judgement, places=places, promised=1e-6)))


def measured(path: Path, description: CampaignDescription, seed: int) -> Path:
    """Return the record of a virtual machine, read at places all over what a plan chooses from: it plans nothing."""
    case, truth = Case(description), Simulator(description.machine, description.setups).drawn(seed)
    lattice, count = case.lattice, description.target.readings or READINGS
    places = lattice.within(np.unique(np.linspace(0, len(lattice) - 1, count).astype(int))).listed(description.setups)
    return write_record(path, description, read_along(case, truth, places, seed))


def idle(poses: Array, approaches: Array) -> Array:
    """Return what a control without tables adds."""
    return np.zeros_like(poses)


def readings_of(
    setups: Sequence[Setup], truth: VirtualMachine, places: Places, control: Control, seed: int
) -> tuple[Reading, ...]:
    """Return what probes show on the true machine under a control, with zeros of their own and noise."""
    rng = np.random.default_rng(seed)
    tips = left_by(truth.model, truth.deviation, control, places.poses, places.approaches)
    zeros = rng.normal(0, 1e-4, len(setups))
    rows = zip(places.setups.tolist(), places.poses.tolist(), places.approaches.astype(int).tolist(), tips, strict=True)
    return tuple(
        Reading(
            setups[s].name,
            tuple(pose),
            tuple(sides),
            float(tip @ setups[s].direction + zeros[s] + rng.normal(0, setups[s].noise)),
        )
        for s, pose, sides, tip in rows
    )
