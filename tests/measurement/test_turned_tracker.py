"""A tracker that was set down by eye: turned by 20 mrad, and the machine is found as if it stood straight."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from axiscal.answers.prediction import tcp_prediction
from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from tests.generators.texts import campaign_text, machine_text, setup_text

MACHINE = machine_text(
    "w-X'-Y'-b-Z-t",
    {"X": (0, 600), "Y": (0, 400), "Z": (-400, 0)},
    {"EXX EYY EZZ": ("15 um", 7, 250), "EYX": "8 um", "C0Y": "60 urad"},
    curve=(5, 300),
    tool=0,
)
STATION = np.array([0.3, -1.5, -0.2])
UNKNOWNS = {f"zero_{axis}": "3 mm" for axis in "xyz"} | {f"turn_{axis}": "20 mrad" for axis in "xyz"}
TRACKER = setup_text(
    "tracker", "tracker", noise="2 um", station=["300 mm", "-1500 mm", "-200 mm"], unknowns={**UNKNOWNS}
)


def off(at: Array) -> Array:
    """By how much the tool is off on the workpiece, m."""
    x, y, z = at.T
    rows = 12e-6 * np.sin(x / 0.11), 10e-6 * np.sin(y / 0.08) + 6e-6 * (x / 0.6) ** 2, 11e-6 * np.cos(z / 0.09)
    return np.stack(rows, axis=1)


def test_the_machine_is_found_although_the_tracker_is_turned() -> None:
    rng, turn = np.random.default_rng(4), Rotation.from_rotvec([0.019, -0.021, 0.023])
    case = Case(campaign_from_texts(campaign_text("m", TRACKER, target={"readings": 6}), "c.toml", MACHINE, "m"))
    drawn = [(rng.uniform((0, 0, -0.4), (0.6, 0.4, 0)), rng.normal(0, 2e-6, 3)) for _ in range(60)]
    at, noise = (np.array(each) for each in zip(*drawn, strict=True))
    seen = turn.apply(at + off(at) - STATION) + STATION - at + noise
    readings = [
        Reading("tracker", tuple(pose), (0, 0, 0), value, others=tuple(others))
        for pose, (value, *others) in zip(at.tolist(), seen.tolist(), strict=True)
    ]
    known = concluded(case, readings)
    assert not known.outliers
    elsewhere = np.random.default_rng(9).uniform((0, 0, -0.4), (0.6, 0.4, 0), (40, 3))
    left = tcp_prediction(known, elsewhere, np.ones_like(elsewhere))[0] - off(elsewhere)
    missed = float(np.sqrt(np.mean(np.sum((left - left.mean(axis=0)) ** 2, axis=1))))
    assert missed < 3.5e-6
    assert missed < 1.6 * known.accuracy.rms < 16e-6
