"""A warm machine, under instruments that read it along a direction, as a distance, and in space."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.estimation.case import Case
from axiscal.measurement.reading import Places, Reading
from axiscal.measurement.reading_rows import seen
from tests.generators.campaigns import built_in

STATION = 'station = ["300 mm", "-800 mm", "-300 mm"]'


@pytest.mark.parametrize(
    "setup",
    [
        f'instrument = "tracker"\n{STATION}',
        f'instrument = "tracer"\n{STATION}',
        'instrument = "interferometer"\ndirection = [0.6, 0.8, 0.0]\nmoves = ["X", "Y"]',
    ],
)
def test_a_warm_machine_takes_the_tool_farther_from_the_middle(setup: str) -> None:
    """What is read of a machine at 23 degC that is right is 35.1 um/m of the way from the middle of all travels."""
    warm, cold = (
        Case(built_in(f'[[setups]]\nname = "0"\n{setup}\n{text}')).observation
        for text in ('temperature = "23 degC"', "")
    )
    places = np.array([[0.55, 0.35, 0.1], [0.1, 0.05, 0.3], [0.3, 0.2, 0.2]])
    if "interferometer" in setup:
        places[:, 2] = 0.2
    count = 3 if "tracker" in setup else 1
    readings = [Reading("0", tuple(each), (1, 1, 1), 0.0, others=(0.0,) * (count - 1)) for each in places.tolist()]
    taken_off = (seen(cold, readings)[1] - seen(warm, readings)[1]).reshape(3, count)
    grown = 35.1e-6 * (places - [0.3, 0.2, 0.2])
    away = warm.machine.frames(places).tcp - [0.3, -0.8, -0.3]
    by_hand = {
        "tracker": grown,
        "tracer": (np.linalg.norm(away + grown, axis=1) - np.linalg.norm(away, axis=1))[:, None],
        "interferometer": (grown @ [0.6, 0.8, 0.0])[:, None],
    }
    assert taken_off == pytest.approx(by_hand[warm.setups[0].instrument], abs=1e-12)


def test_a_tracker_is_linear_about_the_turn_that_readings_have_found() -> None:
    """By 20 mrad the second order is 80 um at 400 mm, which rows about the stated turn would take for errors."""
    case = Case(built_in(f'[[setups]]\nname = "0"\ninstrument = "tracker"\n{STATION}'))
    mean, poses = case.prior.mean.copy(), np.array([[0.1, 0.1, 0.1], [0.5, 0.3, 0.3]])
    names = [unknown.name for unknown in case.description.setups[0].unknowns]
    own = dict(zip(names, case.observation.unknowns_of(0).tolist(), strict=True))
    mean[[own["turn_x"], own["turn_y"], own["turn_z"]]] = 0.02, -0.01, 0.015
    found = case.located(mean)
    assert found is not None
    sides, shown = np.ones_like(poses), case.observation.shown(0, poses, np.ones_like(poses), mean)
    rows = found.observation.numbers(Places.of_setup(0, poses, sides)).rows
    linear = (rows @ mean).reshape(2, 3) + found.observation.nonlinear_part(0, poses, sides)
    assert linear == pytest.approx(shown, abs=1e-12)
    assert np.abs(shown).max() > 1e-3
