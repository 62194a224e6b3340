"""The chain against its second writing from the bed outward, and against ISO 841."""

import numpy as np
import pytest

from axiscal.machine import load_machine
from axiscal.machine.kinematics import tool_motion
from axiscal_core.rigid import SmallMotions
from tests.generators.machines import random_machine, random_poses, twin_tool


@pytest.mark.parametrize("seed", range(15))
def test_the_exact_motion_agrees_with_the_second_writing(seed: int) -> None:
    """Errors of a hundredth, so that every product of errors counts."""
    machine, rng = random_machine(seed), np.random.default_rng(seed)
    poses, _ = random_poses(machine, 5, rng)
    errors = 0.01 * rng.standard_normal((len(machine.axes), 5, 9))
    found = tool_motion(machine, poses, SmallMotions(errors[:, :, :3], errors[:, :, 3:6], errors[:, :, 6:]))
    for i, pose in enumerate(poses):
        expected = twin_tool(machine, pose, errors[:, i]).real
        assert np.abs(found.translation[i] - expected[:3, 3]).max() < 1e-14
        assert np.abs(found.rotation[i] - expected[:3, :3]).max() < 1e-14


@pytest.mark.parametrize("name", ["one-axis", "three-axis-mill", "printer-gantry"])
def test_a_positive_coordinate_moves_the_tool_positively_over_the_workpiece(name: str) -> None:
    """ISO 841, primed axes or not."""
    machine = load_machine(name)
    poses, _ = random_poses(machine, 7, np.random.default_rng(1))
    moved = machine.frames(poses).tcp + np.array([0.0, 0.0, machine.tool_length])
    expected = sum(np.outer(poses[:, k], axis.direction) for k, axis in enumerate(machine.axes))
    assert np.abs(moved - expected).max() < 1e-15
