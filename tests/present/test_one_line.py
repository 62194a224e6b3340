"""A machine of which displacements of one axis alone are described knows the line that was read, and no volume."""

from functools import cache

import numpy as np
import pytest

from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.functionals.asked import EACH, offset_each
from axiscal.estimation.prediction import tcp_prediction
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator
from axiscal_core.usual import OFFSET
from tests.generators.campaigns import on
from tests.generators.texts import machine_text, setup_text

ALONG = {"EXX": 'std = "10 um", length = "200 mm"', "EXX_reversal": "3 um"}
ACROSS, TURNING = {"EYX": "5 um"}, {"ECX": "20 urad"}
PARKED = {"Y": "200 mm", "Z": "100 mm"}


@cache
def _known(others: tuple[str, ...] = (), usual: str = "on", volume: str = "") -> Estimation:
    errors = ALONG | {name: text for each in (ACROSS, TURNING) for name, text in each.items() if name in others}
    machine = machine_text("w-b-X-Y-Z-t", {"X": (0, 1000), "Y": (0, 500), "Z": (0, 400)}, errors)
    setup = setup_text(
        "laser", "interferometer", direction="x", moves=["X"], park=PARKED, reach={"X": ["100 mm", "900 mm"]}
    )
    described = on(machine, f"{volume}\n{setup}", target={"readings": 20}, usual=usual)
    drawn, rng = Simulator(described.machine, described.setups).drawn(3), np.random.default_rng(1)
    at = [((x, 0.2, 0.1), (side, 0, 0)) for side in (1, -1) for x in np.linspace(0.1, 0.9, 9)[::side].tolist()]
    readings = [
        Reading("laser", *place, drawn.read_all(described.setups[0], *place, rng)[0], time=10.0 * number)
        for number, place in enumerate(at)
    ]
    return concluded(Case(described), readings)


def test_beside_the_line_pitch_and_yaw_are_added_to_what_is_predicted() -> None:
    known = _known()
    poses = np.array([[0.5, 0.2, 0.1], [0.5, 0.5, 0.1], [0.5, 0.2, 0.4], [0.5, 0.5, 0.5]])
    std = tcp_prediction(known, poses, np.zeros_like(poses))[1]
    on, *beside = std[:, 0] ** 2
    away = np.array([0.3, 0.3, 0.5])
    np.testing.assert_allclose(np.array(beside) - on, (20e-6 * away) ** 2, rtol=1e-9)
    np.testing.assert_array_equal(std[:, 1:], 0.0)
    each = offset_each(known.stated.description)
    assert each == pytest.approx(BAND * OFFSET.size * EACH)
