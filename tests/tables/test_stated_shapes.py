"""What repeats and what steps is in the tables as part of its error motion."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.errors.model import ErrorModel
from axiscal.estimation.belief import Belief
from axiscal.estimation.machine_estimate import Estimate
from axiscal.machine.description import machine_from_text
from axiscal.tables.volumetric import curves, tip_control

_MACHINE = """chain = "w-X'-b-Y-Z-t"
[axes.X]
travel = ["0 mm", "400 mm"]
[axes.Y]
travel = ["0 mm", "300 mm"]
[axes.Z]
travel = ["0 mm", "200 mm"]
[errors]
EXX = { std = "8 um", length = "200 mm" }
EXX_reversal = { std = "2 um" }
EXX_pitch = { std = "4 um", period = "100 mm" }
EXX_step = { std = "3 um", at = ["250 mm"] }
EYY_pitch = { std = "4 um", period = "100 mm" }
"""


def test_tables_by_name_take_the_whole_error_motion_away() -> None:
    model = ErrorModel(machine_from_text(_MACHINE, "m"))
    mean = model.prior_root() @ np.random.default_rng(2).standard_normal(model.size)
    for function in model.functions:
        if function.kind == "reversal":
            mean[function.columns] = 0.0
    box = tuple(axis.travel for axis in model.machine.axes)
    estimate = Estimate(model, Belief(mean, 1e-18 * np.eye(model.size)), box)
    found = curves(estimate, {k: np.linspace(*axis.travel, 801) for k, axis in enumerate(model.machine.axes)})
    assert set(found) == {"EXX", "EYY"}
    low, high = np.array(box).T
    poses = np.random.default_rng(3).uniform(low, high, (50, 3))
    poses = poses[np.abs(poses[:, 0] - 0.25) > 2e-3]
    added = tip_control(model, found)(poses, np.ones_like(poses))
    deviation = model.rows(poses, np.ones_like(poses)) @ mean
    assert added == pytest.approx(-deviation, abs=5e-8)
