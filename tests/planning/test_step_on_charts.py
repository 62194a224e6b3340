"""Climbing on a chart: to poses that can be taken and gain more."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.estimation.case import Case
from axiscal.machine import load_machine
from axiscal.measurement.candidates import spread
from axiscal.measurement.charts.room import has_room
from axiscal.measurement.travel import sides_of
from axiscal.planning.gains.covariance import Covariance
from axiscal.planning.plan.exchange import climb_from
from tests.generators.campaigns import built_in
from tests.generators.kinematics import in_travel, tip
from tests.generators.texts import artefact_text, setup_text

BALL = artefact_text("ball", balls={"low": ["200 mm", "0 mm", "-80 mm"]})


@pytest.mark.parametrize("raster", [{}, {"B": "10 deg"}])
def test_a_climb_goes_over_places_that_can_be_taken(raster: dict[str, str]) -> None:
    probe = setup_text("it", "probe", artefact="ball", direction="y", approach="both", raster={**raster})
    case, machine = Case(built_in(BALL + probe, "dmu60")), load_machine("dmu60")
    (chart,) = (setup.chart for setup in case.description.setups)
    assert chart is not None
    lattice = spread(machine, case.description.setups, 120)
    scorer = Covariance.from_factor(case.observation, case.prior.factor, case.yardstick.root).scorer()
    climb = climb_from(scorer, 0, lattice.poses[[7]], lattice.approaches[[7]])
    before = climb.gains.copy()
    climb.uphill()
    assert np.all(climb.gains > before)
    (pose,), (approach,) = climb.readings
    assert in_travel(machine, pose)
    assert np.linalg.norm(tip(machine, pose) - [0.2, 0.0, -0.08]) < 1e-9
    place = chart.places(pose[None])
    assert has_room(chart, place, sides_of(chart, place, approach[None]))[0]
    swivel = np.degrees(pose[1]) / 10
    assert abs(swivel - round(swivel)) < 1e-9 or not raster
