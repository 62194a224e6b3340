"""A tracer whose place is found, and a warm machine."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.machine.kinematics import frames
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import seen
from axiscal.measurement.simulation import Simulator
from tests.generators.campaigns import built_in
from tests.generators.texts import setup_text

STATION = 'station = ["300 mm", "-800 mm", "-300 mm"]'


def test_the_place_of_a_tracer_is_found_within_its_sigma() -> None:
    described = built_in(setup_text("0", "tracer", station=["300 mm", "-800 mm", "-300 mm"]))
    machine, rng = Simulator(described.machine, described.setups).drawn(5), np.random.default_rng(5)
    low, high = np.array([axis.travel for axis in described.machine.axes]).T
    poses = [tuple(rng.uniform(low, high).tolist()) for _ in range(40)]
    (setup,), side = described.setups, (1, 1, 1)
    values = [machine.read_all(setup, pose, side, rng)[0] for pose in poses]
    known = concluded(
        Case(described), [Reading("0", pose, side, value) for pose, value in zip(poses, values, strict=True)]
    )
    columns, belief = known.case.observation.unknowns_of(0), known.knowledge.belief
    hidden = [machine.offsets["0"][unknown.name] for unknown in setup.unknowns]
    assert np.all(np.abs(belief.mean[columns] - hidden) < 4 * np.sqrt(np.diagonal(belief.covariance)[columns]))
    assert len(known.outliers) <= 1  # of forty, at 1 % before any reading


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
    taken_off = (seen(cold, readings).values - seen(warm, readings).values).reshape(3, count)
    grown = 35.1e-6 * (places - [0.3, 0.2, 0.2])
    away = frames(warm.machine, places).tcp - [0.3, -0.8, -0.3]
    by_hand = {
        "tracker": grown,
        "tracer": (np.linalg.norm(away + grown, axis=1) - np.linalg.norm(away, axis=1))[:, None],
        "interferometer": (grown @ [0.6, 0.8, 0.0])[:, None],
    }
    assert taken_off == pytest.approx(by_hand[warm.setups[0].instrument], abs=1e-12)
