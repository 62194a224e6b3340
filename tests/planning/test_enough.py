"""What a plan foresees is what the result then says: U with all that a result counts, readings and minutes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from statistics import median

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.sources.source import SimulatedSource
from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.estimate import concluded
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.known_rows import known_rows
from axiscal.measurement.reading import Place
from axiscal.measurement.simulation import Simulator
from axiscal.planning.enough import reached_by
from axiscal.planning.helping import helping_setups, helping_words
from axiscal.planning.next_readings import next_places, placed
from axiscal.planning.plan.task import Limits
from axiscal.planning.promise import foreseen
from axiscal.planning.proposal import proposed
from axiscal.present.plan_answer import plan_answer
from tests.generators.campaigns import built_in
from tests.generators.recorded import measured
from tests.generators.texts import artefact_text, campaign_text, machine_text, setup_text

FEW = 200


def described(target: str, axes: str = "X", more: str = "") -> CampaignDescription:
    """Return lasers along axes of a mill."""
    laser = 'instrument = "interferometer"\napproach = "both"\n'
    setups = (
        f'[[setups]]\nname = "along {axis}"\n{laser}direction = "{axis.lower()}"\nmoves = ["{axis}"]\n'
        f'raster = {{ {axis} = "10 mm" }}\n{more}'
        for axis in axes
    )
    return built_in(f"[target]\n{target}\n{''.join(setups)}")


@pytest.mark.parametrize("more", ["", 'temperature = "21 degC"\n'])
def test_the_u_that_is_foreseen_is_that_of_the_result(more: str) -> None:
    """A laser out and back: most of U is what no reading shows, and less of it where somebody has measured."""
    of = described('wants = ["positioning X"]', more=more)
    case, ways = case_of(of), ((1, range(20, 700, 80)), (-1, range(660, 0, -80)))
    park = case.description.setups[0].park
    places = [Place("along X", (x / 1000, *park[1:]), (side, 0, 0)) for side, at in ways for x in at]
    there, found = known_rows(case, foreseen(case, (), places), ())[0], list[float]()
    for seed in (1, 2, 3):
        readings = measured(case, Simulator(of.machine, of.setups).drawn(seed), places, seed)
        known = concluded(case, readings)
        found.append(known_rows(known.case, known.printed, known.readings)[0].known)
    assert there.known == pytest.approx(median(found), rel=0.2)


def test_where_no_two_set_ups_reach_the_target_those_that_bring_most_are_named() -> None:
    case = case_of(described('U = "10 um"', "XYZ"))
    found = helping_setups(case, case.description.target)
    assert found is not None
    assert (len(found.setups), found.readings, found.reached) == (2, 0, False)
    assert helping_words(found).endswith(" as well it comes nearer.")


@pytest.mark.parametrize("checks", [0, 4])
def test_a_plan_reaches_its_target_in_the_order_in_which_it_is_read(checks: int) -> None:
    """With a zero that drifts and checks between: each reading comes later than it would alone."""
    laser = {"direction": "x", "approach": "both", "reading_time": "4 min", "drift": "6 um/h"}
    text = setup_text("laser", "interferometer", **laser)
    case = case_of(built_in(f"[target]\nchecks = {checks}\n{text}", "one-axis"))
    yardstick = case.yardstick
    limit = float(np.hypot(yardstick.rms_floor, 0.1 * yardstick.measure(case.knowledge.belief).rms))
    target = replace(case.description.target, rms=limit)
    case = case_of(replace(case.description, target=target))
    places = next_places(case, case.knowledge, ())
    assert sum(place.check for place in places) == checks
    assert len(places) < 30
    assert yardstick.measure(foreseen(case, (), places).belief).rms <= limit


@pytest.mark.long
def test_a_campaign_takes_the_readings_and_minutes_that_its_plan_says(tmp_path: Path) -> None:
    """No set-up is mounted again. Sizes that readings show smaller than usual may save a few of them."""
    of = described('wants = ["backlash X 1 um"]')
    limits, machine = Limits.of(of.target), Simulator(of.machine, of.setups).drawn(1)
    plan = plan_answer(case_of(of), proposed(case_of(of), limits, FEW), limits)
    with Campaign.create(tmp_path / "campaign.axiscal", of) as campaign:
        campaign.run(SimulatedSource(machine, 1), lambda milestone: None)
        assert campaign.seconds() / 60 == pytest.approx(plan.minutes, rel=0.25)
        assert len(campaign.state.readings) == pytest.approx(plan.readings, rel=0.25, abs=3)


def test_a_plan_ends_where_the_result_just_reaches_u() -> None:
    case = case_of(described('U = "20 um"', "XYZ"))
    limits = Limits.of(case.description.target)
    places = placed(case, proposed(case, limits, FEW))
    assert reached_by(case, limits, places)
    assert not reached_by(case, limits.times(0.95), places)


TURNED = machine_text(
    "w-A'-b-Y-Z-t",
    {"Y": (0, 400), "Z": (-350, 0), "A": (0, 360)},
    {"Y0A Z0A": "30 um"},
    origins={"A": (0, 200, -250)},
)


BALL = campaign_text(
    "turned",
    artefact_text("ball", placed="1 mm", balls={"it": ["0 mm", "240 mm", "-200 mm"]}),
    setup_text("sphere", "sphere", artefact="ball"),
    target={"wants": ["centre of A 15 um"]},
)


@pytest.mark.long
def test_a_plan_says_that_a_tool_of_known_length_would_reach_its_target() -> None:
    case = case_of(campaign_from_texts(BALL, "campaign.toml", TURNED, "turned"))
    found = helping_setups(case, case.description.target)
    assert found is not None
    assert found.setups == ()
    assert found.tool
    assert found.reached
    assert helping_words(found).startswith('With tool_length = "5 um", tool_eccentricity = "5 um" as well, ')
    known = case_of(campaign_from_texts(f'tool_length = "5 um"\n{BALL}', "campaign.toml", TURNED, "turned"))
    assert [row.reachable for each in (case, known) for row in known_rows(each, each.knowledge, ())] == [False, True]
