"""The machine tests of the standards as set-ups: planned, programmed, and readings of the same estimate.

Of ISO 10791-6: circles with a rotary axis that turns in step (K), and a point that is held while one rotary axis turns
(AK, BK, CK).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.machine import load_machine
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator
from axiscal.planning.next_readings import placed
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from axiscal.programs import controllers, dialect, programs
from tests.generators.said_places import Said

BALL = '[[artefacts]]\nname = "ball"\nballs = { one = ["150 mm", "0 mm", "0 mm"] }\n'
AT_BALL = 'instrument = "rtest"\nartefact = "ball"\nmoves = ["{}"]\nraster = {{ {} = "10 deg" }}\n'
BAR = 'instrument = "ballbar"\nlength = "150 mm"\nstation = ["0 mm", "0 mm", "100 mm"]\n'
TESTS = {
    "ISO 10791-6, circle with C in step": (
        "",
        BAR + 'plane = "xy"\narc = ["10 deg", "200 deg"]\nturning = { C = 1.0 }\nraster = { arc = "10 deg" }\n',
    ),
    "ISO 10791-6, CK": (BALL, AT_BALL.format("C", "C")),
    "ISO 10791-6, BK": (BALL, AT_BALL.format("B", "B")),
    "ISO 10791-6, AK": (BALL.replace("150 mm", "60 mm"), AT_BALL.format("A", "A")),
}
SWIVEL = (Path(__file__).parents[1] / "linuxcnc/machines/xyzac.machine.toml").read_text(encoding="utf-8")


def described(name: str) -> tuple[CampaignDescription, Said]:
    artefacts, keys = TESTS[name]
    text = f'machine = "dmu60"\n{artefacts}[[setups]]\nname = "{name[:40]}"\n{keys}approach = "both"\n'
    described = SWIVEL if name.endswith("AK") else load_machine("dmu60").text
    campaign = campaign_from_texts(text, "campaign.toml", described, "machine.toml")
    return campaign, Said(text, campaign.machine)


@pytest.mark.parametrize(
    "name", [name if name.endswith("CK") else pytest.param(name, marks=pytest.mark.long) for name in TESTS]
)
def test_it_is_planned_programmed_and_read(name: str) -> None:
    campaign, said = described(name)
    case = Case(campaign)
    places = placed(case, proposed(case, Limits(readings=4), 80).plan)
    assert len(places) == 4
    for place in places:
        said.holds(place)
    for controller in controllers():
        (program,) = programs(campaign.machine, campaign.setups, places, dialect(controller))
        assert [row.number for row in program.readings] == [1, 2, 3, 4]
    truth = Simulator(campaign.machine, campaign.setups).drawn(3)
    (setup,) = campaign.setups
    rng = np.random.default_rng(3)
    readings = []
    for place in places:
        value, *others = truth.read_all(setup, place.pose, place.approach, rng, 0.0)
        readings.append(Reading(setup.name, place.pose, place.approach, value, others=tuple(others), time=0.0))
    before, after = (
        case.yardstick.measure(known.belief).rms for known in (case.knowledge, case.knowledge.read(readings))
    )
    assert after < before
