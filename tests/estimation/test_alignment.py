"""A part is aligned before it is machined: against fitting the rigid motion of every drawn machine by least squares."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.description.target import PartVolume
from axiscal.errors.model import ErrorModel
from axiscal.estimation.accuracy.alignment import Alignment, sampled_moments
from axiscal.machine import load_machine
from tests.generators.kinematics import in_travel, tip

DMU = load_machine("dmu60")
MODEL = ErrorModel(DMU)
PART = PartVolume(((-0.2, 0.2), (-0.2, 0.2), (-0.1, 0.1)), 0.2, ((0.0, 2 * np.pi), (-np.pi / 6, np.radians(100))))


def test_poses_of_a_part_have_the_tool_point_in_it_and_spread_over_it() -> None:
    poses = PART.poses(DMU, 400)
    tips = np.array([tip(DMU, pose) for pose in poses])
    assert len(poses) == 400
    assert all(in_travel(DMU, pose) for pose in poses)
    assert np.all(np.hypot(tips[:, 0], tips[:, 1]) <= 0.2 + 1e-9)
    assert np.all(np.abs(tips[:, 2]) <= 0.1 + 1e-9)
    assert np.ptp(tips, axis=0) == pytest.approx([0.4, 0.4, 0.2], rel=0.1)


def test_what_is_left_is_what_the_best_rigid_motion_of_each_machine_leaves() -> None:
    poses, rng = PART.poses(DMU, 150), np.random.default_rng(1)
    alignment = Alignment(MODEL, poses)
    weight = sampled_moments(MODEL, poses, alignment).gram
    tips = np.array([tip(DMU, pose) for pose in poses])
    for _ in range(3):
        drawn = MODEL.prior_root() @ rng.standard_normal(MODEL.size)
        for function in MODEL.functions:
            if function.kind == "reversal":
                drawn[function.columns] = 0.0
        deviations = MODEL.rows(poses, np.zeros_like(poses)) @ drawn
        columns = [np.tile(way, (len(poses), 1)).ravel() for way in np.eye(3)]
        columns += [np.cross(way, tips).ravel() for way in np.eye(3)]
        fitted, residuals, *_ = np.linalg.lstsq(np.array(columns).T, deviations.ravel(), rcond=None)
        assert drawn @ weight @ drawn == pytest.approx(float(residuals[0]) / len(poses), rel=1e-8)
        left = deviations.ravel() - np.array(columns).T @ fitted
        np.testing.assert_allclose(alignment.left(poses, deviations).ravel(), left, atol=1e-12)
