"""The next reading on a chart: nowhere along a coordinate, and at no pose that was tried, is there a better one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.design.gains.gain import Scorer
from axiscal.design.step.best_step import best_of, climbed_on_chart
from axiscal.design.step.chart_climb import ChartClimb
from axiscal.design.step.chart_line import pieces, places_along
from axiscal.design.step.climb import Climb
from axiscal.estimation.case import Case
from axiscal.machine import load_machine
from axiscal.measurement.candidates import spread
from axiscal.measurement.chart_places import arrivals_of
from axiscal.measurement.charts.arrivals import has_room
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.place import Places
from axiscal.measurement.reading import Reading
from axiscal.measurement.travel import sides_of
from axiscal.numerics import Array
from axiscal.planning.next_readings import root_of
from tests.generators.kinematics import in_travel, tip

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
BAR = """
machine = "dmu60"
[[setups]]
name = "it"
instrument = "ballbar"
length = "150 mm"
station = ["0 mm", "0 mm", "100 mm"]
plane = "zx"
approach = "both"
"""
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
    return case, Scorer.of(known.observation, known.belief, root_of(case, known.belief)), lattice


def _reading(case: Case, lattice: Places, number: int) -> Reading:
    setup = case.description.setups[0]
    others = (0.0,) * (INSTRUMENTS[setup.instrument].values - 1)
    pose, approach = lattice.poses[number].tolist(), lattice.approaches[number].astype(int).tolist()
    return Reading(setup.name, tuple(pose), tuple(approach), 0.0, others=others, time=0.0)


def gains_along(case: Case, scorer: Scorer, climb: ChartClimb, number: int, values: Array) -> Array:
    """Return the gains with other values of a coordinate, −inf where nothing can be read."""
    places = places_along(climb.place, number, values)
    sides = np.tile(climb.sides, (len(values), 1))
    setup = scorer.observation.setups[0]
    taken = has_room(climb.chart, places, sides)
    come = arrivals_of(case.description.machine, setup, climb.chart, places[taken], sides[taken])
    found = np.full(len(values), -np.inf)
    found[taken] = scorer.at(0, climb.chart.poses(places[taken]), come)
    return found


@pytest.mark.long
@pytest.mark.parametrize("name", CASES)
def test_nowhere_along_a_coordinate_is_there_a_better_reading(name: str) -> None:
    case, scorer, lattice = begun(name)
    climb = ChartClimb.begun(scorer, 0, lattice.poses[7], lattice.approaches[7])
    assert climb is not None
    for number in range(climb.chart.size):
        best = climb._along(number)
        cut = pieces(scorer.observation, 0, climb.chart, number, climb.place, climb.sides)
        assert len(cut) > 5
        for left, right in cut[:: max(1, len(cut) // 8)]:
            fine = gains_along(case, scorer, climb, number, np.linspace(left, right, 401)[1:-1])
            assert np.all(np.isfinite(fine))
            assert best.gain >= fine.max() * (1 - 1e-9)
        everywhere = gains_along(case, scorer, climb, number, np.linspace(*climb.chart.bounds(number)[:2], 4001))
        assert best.gain >= everywhere.max() * (1 - 1e-9)


def test_pieces_are_all_that_can_be_taken() -> None:
    _, scorer, lattice = begun("one value")
    climb = ChartClimb.begun(scorer, 0, lattice.poses[7], lattice.approaches[7])
    assert climb is not None
    for number in range(2):
        cut = pieces(scorer.observation, 0, climb.chart, number, climb.place, climb.sides)
        low, high = climb.chart.bounds(number)[:2]
        fine = np.linspace(low, high, 20_001)
        places = places_along(climb.place, number, fine)
        taken = has_room(climb.chart, places, np.tile(climb.sides, (len(fine), 1)))
        within = np.any((fine[:, None] >= cut[:, 0] - 1e-9) & (fine[:, None] <= cut[:, 1] + 1e-9), axis=1)
        assert np.mean(taken != within) < 1e-3


@pytest.mark.long
@pytest.mark.parametrize("name", CASES)
def test_the_best_step_is_a_pose_that_can_be_taken_and_no_other_that_was_tried_is_better(name: str) -> None:
    case, scorer, lattice = begun(name)
    step = best_of(scorer, lattice)
    machine, setup = case.description.machine, case.description.setups[0]
    assert in_travel(machine, step.pose)
    off = np.linalg.norm(tip(machine, step.pose) - (np.array([0.0, 0.0, 0.1]) if name == "bar" else BALL))
    assert off == pytest.approx(0.15 if name == "bar" else 0.0, abs=1e-9)
    assert step.gain >= scorer.gains(lattice).max()
    others = spread(machine, case.description.setups, 3000)
    assert setup.chart is not None
    assert step.gain >= scorer.gains(others).max() * (1 - 2e-3)
    place = setup.chart.places(step.pose[None])
    sides = sides_of(setup.chart, place, step.approach[None])
    assert has_room(setup.chart, place, sides)[0]


def test_a_raster_keeps_to_its_steps() -> None:
    keys = 'direction = "y"\nraster = { B = "10 deg" }'
    text = AT_BALL.format(instrument="probe", keys="@").replace("@", keys)
    case = Case(campaign_from_texts(text, "c.toml", load_machine("dmu60").text, "dmu60"))
    lattice = spread(case.description.machine, case.description.setups, 60)
    scorer = Scorer.of(case.observation, case.prior, case.yardstick.root)
    climb = Climb(scorer, 0, lattice.poses[:2], lattice.approaches[:2], scorer.gains(lattice)[:2])
    ended = climbed_on_chart(climb)
    swivel = math.degrees(float(ended.poses[0, 1]))
    assert swivel / 10 == pytest.approx(round(swivel / 10), abs=1e-9)
    assert ended.gains[0] >= climb.gains.max()
