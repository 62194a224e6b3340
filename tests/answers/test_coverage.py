"""Of machines drawn from the model so many rows lie inside U as it says."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.answers.answer_of_campaign import answered
from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.functionals.asked import asked_rows
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator, VirtualMachine
from tests.generators.texts import artefact_text, campaign_text, setup_text

MACHINE = """
chain = "w-b-X-Y-t"
[axes.X]
travel = ["0 mm", "400 mm"]
[axes.Y]
travel = ["0 mm", "300 mm"]
[errors]
EXX = { std = "8 um", rest = "0.2 um" }
EYX = { std = "3 um", rest = "0.2 um" }
EXX_reversal = { std = "3 um" }
EXY = { std = "3 um", rest = "0.2 um" }
EYY = { std = "5 um", rest = "0.2 um" }
ECX = { std = "10 urad" }
C0Y = { std = "40 urad" }
"""
CAMPAIGN = campaign_text(
    "m",
    artefact_text("square", turned="1 mrad"),
    setup_text("laser along X", "interferometer", direction="x", moves=["X"], approach="both", drift="0 um/h"),
    setup_text(
        "leg along x",
        "straightedge",
        artefact="square",
        type_b={"square": "0 urad"},
        direction="y",
        moves=["X"],
        drift="0 um/h",
    ),
    setup_text(
        "leg along y",
        "straightedge",
        artefact="square",
        type_b={"square": "0 urad"},
        direction="x",
        moves=["Y"],
        drift="0 um/h",
    ),
    target={
        "readings": 30,
        "wants": ["positioning X", "backlash X", "straightness X in Y", "straightness Y in X", "squareness XY"],
    },
    usual="off",
    sure="exactly",
)
CASE = Case(campaign_from_texts(CAMPAIGN, "c.toml", MACHINE, "m"))
MACHINES = 30


def _read(drawn: VirtualMachine, seed: int) -> list[Reading]:
    """Return readings of all set-ups: X at six places from both sides, each leg at six."""
    rng, found = np.random.default_rng(seed), list[Reading]()
    for setup in CASE.description.setups:
        (axis,) = setup.moves
        low, high = CASE.description.machine.axes[axis].travel
        for side in setup.sides:
            for at in np.linspace(low, high, 6)[::side]:
                pose = tuple(float(at) if k == axis else park for k, park in enumerate(setup.park))
                sides = tuple(side if k == axis else 0 for k in range(2))
                found.append(Reading(setup.name, pose, sides, drawn.read_all(setup, pose, sides, rng)[0]))
    return found


@pytest.mark.long
def test_truth_lies_inside_u_as_often_as_it_says() -> None:
    simulator = Simulator(CASE.description.machine, CASE.description.setups)
    inside = dict[str, list[float]]()
    for seed in range(MACHINES):
        drawn = simulator.drawn(seed)
        known = concluded(CASE, _read(drawn, seed))
        asked = asked_rows(CASE.description, known.readings)
        for each, row in zip(asked, answered(known, {}), strict=True):
            assert each.map is not None
            where = each.map.poses, each.map.sides
            missed = each.map.row(drawn.deviation(*where) - known.estimate().deviation(*where))
            inside.setdefault(row.row.name, []).append(float(np.mean(np.abs(missed) <= row.known)))
    assert np.mean([np.mean(each) for each in inside.values()]) == pytest.approx(0.95, abs=0.03)
