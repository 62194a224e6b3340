"""EXX_pitch: believed beforehand and estimated."""

import numpy as np
import pytest

from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.machine.description import machine_from_text
from axiscal.measurement.reading import Reading
from tests.generators.campaigns import on
from tests.generators.texts import machine_text, setup_text

_MACHINE = machine_text("w-b-X-t", {"X": (0, 600)}, {"EXX": 'std = "8 um", length = "200 mm"'})
_PITCH = 'EXX_pitch = { std = "5 um", period = "50 mm", harmonics = 2 }\n'
_LASER = setup_text("laser", "interferometer", direction="x", noise="0.5 um", unknowns={})


def test_a_pitch_is_a_sum_of_waves_of_falling_size() -> None:
    model = machine_from_text(_MACHINE + _PITCH, "m")
    function, at = model.by_name["EXX_pitch"], np.array([0.013, 0.021, 0.374])
    rows = function.rows(at)
    turns = 2 * np.pi * (at[:, None] - at) / 0.05
    assert rows @ function.covariance @ rows.T == pytest.approx(
        25e-12 * (np.cos(turns) + np.cos(2 * turns) / 4), abs=2e-3 * 25e-12
    )


def test_readings_find_a_pitch_between_what_a_curve_can_follow() -> None:
    case = Case(on(_MACHINE + _PITCH, _LASER, target={"readings": 14}, usual="off"))
    places = np.linspace(0.004, 0.596, 23)
    truth = 5e-6 * np.sin(2 * np.pi * places / 0.05 + 0.4) + 3e-6 * (places / 0.3 - 1)
    readings = [Reading("laser", (float(x),), (1,), float(v)) for x, v in zip(places, truth, strict=True)]
    estimate, dense = concluded(case, readings).estimate(), np.linspace(0, 0.6, 301)[:, None]
    found = estimate.deviation(dense, np.ones_like(dense))[:, 0]
    true = 5e-6 * np.sin(2 * np.pi * dense[:, 0] / 0.05 + 0.4) + 3e-6 * (dense[:, 0] / 0.3 - 1)
    assert np.sqrt(np.mean((found - true) ** 2)) < 0.5e-6
