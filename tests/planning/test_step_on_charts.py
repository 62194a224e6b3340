"""Climbing on a chart: to poses that can be taken, and on a raster from step to step."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.machine import load_machine
from axiscal.measurement.candidates import spread
from axiscal.measurement.charts.room import Chart, has_room
from axiscal.measurement.instrument import values_of
from axiscal.measurement.reading import Places, Reading
from axiscal.measurement.travel import sides_of
from axiscal.planning.gains.covariance import Covariance
from axiscal.planning.gains.gain import Scorer
from axiscal.planning.next_readings import root_of
from axiscal.planning.plan.exchange import climb_from
from axiscal.planning.step.ground import ground_of, places_along
from tests.generators.forms import gains_of
from tests.generators.kinematics import in_travel, tip
from tests.generators.texts import campaign_text, setup_text

BALL = np.array([0.2, 0.0, -0.08])
AT_BALL = """
machine = "dmu60"
[target]
part = {{ radius = "200 mm", z = ["-100 mm", "100 mm"], B = ["-30 deg", "100 deg"] }}
[[artefacts]]
name = "ball"
balls = {{ low = ["200 mm", "0 mm", "-80 mm"] }}
[[setups]]
name = "it"
instrument = "{instrument}"
artefact = "ball"
approach = "both"
{keys}
"""
BAR = campaign_text(
    "dmu60",
    setup_text("it", "ballbar", length="150 mm", station=["0 mm", "0 mm", "100 mm"], plane="zx", approach="both"),
)
CASES = {
    "one value": AT_BALL.format(instrument="probe", keys='direction = "y"'),
    "three values": AT_BALL.format(instrument="rtest", keys=""),
    "bar": BAR,
}


def begun(name: str) -> tuple[Case, Scorer, Places]:
    """Return a case after two readings, what readings gain there, and candidates."""
    case = Case(campaign_from_texts(CASES[name], "c.toml", load_machine("dmu60").text, "dmu60"))
    lattice = spread(case.description.machine, case.description.setups, 120)
    knowledge = case.knowledge
    known = knowledge.read([_reading(case, lattice, number) for number in (3, 40)])
    return (
        case,
        Covariance.from_factor(known.observation, known.belief.factor, root_of(case, known.belief)).scorer(),
        lattice,
    )


def _reading(case: Case, lattice: Places, number: int) -> Reading:
    setup = case.description.setups[0]
    others = (0.0,) * (values_of(setup) - 1)
    pose, approach = lattice.poses[number].tolist(), lattice.approaches[number].astype(int).tolist()
    return Reading(setup.name, tuple(pose), tuple(approach), 0.0, others=others, time=0.0)


def chart_of(scorer: Scorer) -> Chart:
    """Return the chart of the only set-up."""
    chart = scorer.observation.setups[0].chart
    assert chart is not None
    return chart


def test_pieces_are_all_that_can_be_taken() -> None:
    _, scorer, lattice = begun("one value")
    climb = climb_from(scorer, 0, lattice.poses[[7]], lattice.approaches[[7]])
    for number in range(2):
        cut = ground_of(scorer.observation, 0).pieces(number, climb.places[0], climb.sides[0])
        low, high = climb.ground.ends[number]
        fine = np.linspace(low, high, 20_001)
        places = places_along(climb.places[0], number, fine)
        taken = has_room(chart_of(scorer), places, np.tile(climb.sides[0], (len(fine), 1)))
        within = np.any((fine[:, None] >= cut[:, 0] - 1e-9) & (fine[:, None] <= cut[:, 1] + 1e-9), axis=1)
        assert np.mean(taken != within) < 1e-3


@pytest.mark.long
@pytest.mark.parametrize("name", CASES)
def test_a_climb_ends_at_poses_that_can_be_taken_higher_than_it_began(name: str) -> None:
    case, scorer, lattice = begun(name)
    climb = climb_from(scorer, 0, lattice.poses[:6], lattice.approaches[:6])
    before = climb.gains.copy()
    climb.uphill()
    assert np.all(climb.gains >= before)
    machine = case.description.machine
    for pose, approach in zip(*climb.readings, strict=True):
        assert in_travel(machine, pose)
        off = np.linalg.norm(tip(machine, pose) - (np.array([0.0, 0.0, 0.1]) if name == "bar" else BALL))
        assert off == pytest.approx(0.15 if name == "bar" else 0.0, abs=1e-9)
        chart = chart_of(scorer)
        place = chart.places(pose[None])
        assert has_room(chart, place, sides_of(chart, place, approach[None]))[0]


@pytest.mark.long
def test_a_raster_keeps_to_its_steps() -> None:
    keys = 'direction = "y"\nraster = { B = "10 deg" }'
    text = AT_BALL.format(instrument="probe", keys="@").replace("@", keys)
    case = Case(campaign_from_texts(text, "c.toml", load_machine("dmu60").text, "dmu60"))
    lattice = spread(case.description.machine, case.description.setups, 60)
    scorer = Covariance.from_factor(case.observation, case.prior.factor, case.yardstick.root).scorer()
    climb = climb_from(scorer, 0, lattice.poses[:2], lattice.approaches[:2])
    climb.uphill()
    swivels = np.degrees(climb.readings[0][:, 1])
    np.testing.assert_allclose(swivels / 10, np.round(swivels / 10), atol=1e-9)
    assert np.all(climb.gains >= gains_of(scorer, lattice)[:2])
