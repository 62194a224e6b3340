"""A part is aligned before it is machined: against fitting the rigid motion of every drawn machine by least squares."""

import numpy as np
import pytest

from axiscal.description.target import PartVolume
from axiscal.errors.volume import Alignment, Counted, Volume, whole_travel
from axiscal.machine import load_machine
from axiscal_core.points import even_points
from tests.generators.kinematics import in_travel, tip

DMU = load_machine("dmu60")
MODEL = DMU
PART = PartVolume(((-0.2, 0.2), (-0.2, 0.2), (-0.1, 0.1)), 0.2, ((0.0, 2 * np.pi), (-np.pi / 6, np.radians(100))))


def test_poses_of_a_part_have_the_tool_point_in_it_and_spread_over_it() -> None:
    poses = PART.poses(DMU, 400)
    tips = np.array([tip(DMU, pose) for pose in poses])
    assert len(poses) == 400
    assert all(in_travel(DMU, pose) for pose in poses)
    assert np.all(np.hypot(tips[:, 0], tips[:, 1]) <= 0.2 + 1e-9)
    assert np.all(np.abs(tips[:, 2]) <= 0.1 + 1e-9)
    assert np.ptp(tips, axis=0) == pytest.approx([0.4, 0.4, 0.2], rel=0.1)


@pytest.mark.parametrize("counted", [(True, True, True), (False, False, True)], ids=["part", "bed"])
def test_what_is_left_is_what_the_best_rigid_motion_of_each_machine_leaves(counted: Counted) -> None:
    """Of a bed the height alone counts: it is levelled by a plane."""
    model = MODEL if all(counted) else load_machine("printer-gantry")
    low, high = np.array(whole_travel(model)).T
    poses = PART.poses(DMU, 150) if all(counted) else low + (high - low) * even_points(150, len(low))
    rng, alignment = np.random.default_rng(1), Alignment(model, poses, counted)
    weight = Volume(model, poses, counted, alignment).moments.gram
    tips = np.array([tip(model, pose) for pose in poses])
    motions = [np.tile(way, (len(poses), 1)) for way in np.eye(3)] + [np.cross(way, tips) for way in np.eye(3)]
    columns = np.array([motion[:, counted].ravel() for motion in motions]).T
    for _ in range(3):
        drawn = model.root() @ rng.standard_normal(model.size)
        for function in model.curves:
            if function.kind == "reversal":
                drawn[function.columns] = 0.0
        deviations = model.rows_at(poses, np.zeros_like(poses)) @ drawn
        shown = deviations[:, counted].ravel()
        left = shown - columns @ np.linalg.lstsq(columns, shown, rcond=None)[0]
        assert drawn @ weight @ drawn == pytest.approx(float(left @ left) / len(poses), rel=1e-6)
        np.testing.assert_allclose(alignment.left(poses, deviations)[:, counted].ravel(), left, atol=1e-9)
