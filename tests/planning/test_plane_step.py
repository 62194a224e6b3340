"""What readings leave where two axes act together, and the nine that come first where sizes are learnt."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import volume_moments, whole_travel
from axiscal.estimation.accuracy.criterion import Root
from axiscal.estimation.belief import Belief
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import estimated
from axiscal.machine import machine_from_text
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.planning.next_readings import next_places
from axiscal.planning.other_readings import plane_start
from axiscal.record.events import Asked, Gap
from tests.generators.planes import centred, matern
from tests.generators.texts import machine_text

SQUARE = """
chain = "w-b-X-Y-t"
[axes.X]
travel = ["0 m", "1 m"]
[axes.Y]
travel = ["0 m", "1 m"]
[errors]
EZX = { std = "1 m", knots = 7, length = "350 mm" }
EZY = { std = "1 m", knots = 7, length = "350 mm" }
EZXY = { std = "0.5 m", knots = 7, length = "350 mm" }
"""
BEFORE = 10.851987
GRID = 0.273907


def test_nine_even_readings_of_a_plane_leave_what_is_published() -> None:
    """Constant of variance 10, centred curves, interaction a quarter of their product, noise 1e-3 (variance)."""
    machine = machine_from_text(SQUARE)
    model = ErrorModel(machine)
    assert model.size == 7 + 7 + 36
    setup = Setup("z", "probe", (0.0, 0.0, 1.0), (0, 1), (0.5, 0.5), np.sqrt(1e-3), (), 60, 1, 1, (0.0, 0.0), "+")
    observation = Observation(model, (setup,))
    covariance = model.prior_covariance()
    knots = np.linspace(0, 1, 7)
    for curve in model.functions:
        covariance[curve.columns, curve.columns] = centred(matern(knots, 0.35)) + 5.0
    belief, root = (
        Belief(np.zeros(model.size), covariance),
        Root.of_gram(volume_moments(model, whole_travel(model)).gram),
    )
    assert root.criterion(belief.factor) == pytest.approx(BEFORE, rel=2e-5)
    places = np.stack([g.ravel() for g in np.meshgrid([0.0, 0.5, 1.0], [0.0, 0.5, 1.0])], axis=1)
    rows = observation.rows(0, places, np.ones_like(places)).rows
    even = Belief(np.zeros(model.size), covariance).update(rows, np.zeros(9), np.full(9, 1e-3))
    assert root.criterion(even.factor) == pytest.approx(GRID, abs=1e-6)


MACHINE = machine_text(
    "w-Y'-b-X-t",
    {"X": (0, 300), "Y": (0, 200)},
    {"EZX": 'std = "60 um", knots = 5, length = "150 mm"', "EZY": 'std = "60 um", knots = 5, length = "100 mm"'},
)
PLANE = 'EZXY = { std = "40 um", knots = 5, length = ["150 mm", "100 mm"], rest = "2 um" }\n'
CAMPAIGN = """
machine = "machine.toml"
usual = "off"
sure = "roughly"
[target]
readings = 14
[[setups]]
name = "bed"
instrument = "probe"
direction = "z"
moves = ["X", "Y"]
reach = { X = ["0 mm", "300 mm"], Y = ["0 mm", "200 mm"] }
noise = "2 um"
raster = { X = "20 mm", Y = "20 mm" }
"""
ALONE = CAMPAIGN.replace('moves = ["X", "Y"]', 'moves = ["X"]')
ALONE = ALONE.replace(', Y = ["0 mm", "200 mm"]', "").replace(', Y = "20 mm"', "")


def _case(campaign: str = CAMPAIGN, machine: str = MACHINE + PLANE) -> Case:
    return Case(campaign_from_texts(campaign, "campaign.toml", machine, "machine.toml"))


def test_nine_places_on_the_raster_come_first_and_then_the_plan() -> None:
    known = estimated(_case(), ())
    places = next_places(known.case, known.knowledge, ())
    poses = np.array([place.pose for place in places])
    assert len(places) == 9
    assert {round(1e3 * y) for y in poses[:, 0]} == {0, 100, 200}
    assert {round(1e3 * x) for x in poses[:, 1]} == {0, 160, 300}
    readings = [Reading(p.setup, p.pose, p.approach, 1e-5 * i) for i, p in enumerate(places)]
    left = plane_start(_case(), readings[:4], 10)
    assert len(left) == 5
    known = estimated(_case(), readings)
    assert len(next_places(known.case, known.knowledge, known.readings, known.outliers)) == 5


def test_a_place_that_cannot_be_read_is_left_out() -> None:
    known = estimated(_case(), ())
    places = next_places(known.case, known.knowledge, ())
    gaps = (Gap(Asked(0, places[2]), "the clamp is there"),)
    again = next_places(known.case, known.knowledge, (), (), gaps)
    assert {place.pose for place in again} == {place.pose for place in places} - {places[2].pose}


def test_of_few_readings_corners_come_first_and_then_the_middle() -> None:
    poses = plane_start(_case(), (), 5).poses
    expected = np.array([[0, 0], [0.2, 0.3], [0, 0.3], [0.2, 0], [0.1, 0.16]])
    np.testing.assert_allclose(poses, expected)
    assert len(plane_start(_case(), (), 8)) == 8


@pytest.mark.parametrize(
    ("campaign", "machine"),
    [
        (CAMPAIGN.replace('"roughly"', '"exactly"'), MACHINE + PLANE),
        (CAMPAIGN, MACHINE),
        (ALONE, MACHINE + PLANE),
        (CAMPAIGN.replace('direction = "z"', 'direction = "x"'), MACHINE + PLANE),
    ],
    ids=["sizes as stated", "no plane", "one axis", "not seen"],
)
def test_else_the_plan_comes_at_once(campaign: str, machine: str) -> None:
    assert len(plane_start(_case(campaign, machine), (), _case(campaign, machine).description.target.readings)) == 0


def test_of_several_set_ups_none_begins_so() -> None:
    case = _case()
    two = replace(case.description, setups=(*case.description.setups, replace(case.description.setups[0], name="more")))
    assert len(plane_start(Case(two), (), None)) == 0
