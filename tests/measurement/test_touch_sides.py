"""From where spheres are touched, by vectors of the tests' own."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.measurement.touched import touch_frames
from tests.generators.kinematics import stem
from tests.generators.machines import random_machine, random_poses


@pytest.mark.parametrize("seed", range(6))
def test_sides_are_square_to_each_other_and_to_the_stem_on_any_machine(seed: int) -> None:
    """Also where no linear axis goes across the stem, or there is none."""
    machine = random_machine(seed, count=2)
    poses, _ = random_poses(machine, 5, np.random.default_rng(seed))
    for pose, ways in zip(poses, touch_frames(machine, poses), strict=True):
        np.testing.assert_allclose(ways @ ways.T, np.eye(3), atol=1e-12)
        np.testing.assert_allclose(ways[2], stem(machine, pose), atol=1e-12)
