"""The chain against its second writing from the bed outward, and against what one works out on paper."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.errors.model import ErrorModel
from axiscal.machine import builtin_names, load_machine
from axiscal.machine.kinematics import SmallMotions, frames, tool_motion
from axiscal.numerics import Array, rigid
from tests.generators.machines import random_machine, random_poses, twin_tool


def _still(axes: int, poses: int) -> SmallMotions:
    return SmallMotions(*(np.zeros((axes, poses, 3)) for _ in range(3)))


@pytest.mark.parametrize("seed", range(40))
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


@pytest.mark.parametrize("seed", range(40))
def test_the_nominal_tool_is_where_the_frames_say(seed: int) -> None:
    machine = random_machine(seed)
    poses, _ = random_poses(machine, 5, np.random.default_rng(seed))
    expected = tool_motion(machine, poses, _still(len(machine.axes), 5)).translation
    assert np.abs(frames(machine, poses).tcp - expected).max() < 1e-15


@pytest.mark.parametrize("name", builtin_names())
def test_with_all_axes_at_zero_the_tool_hangs_below_the_origin(name: str) -> None:
    machine = load_machine(name)
    found = frames(machine, np.zeros((1, len(machine.axes))))
    assert np.abs(found.tcp - [0, 0, -machine.tool]).max() < 1e-15
    assert np.abs(found.rotations - np.eye(3)).max() < 1e-15


@pytest.mark.parametrize("name", ["one-axis", "three-axis-mill", "printer-gantry"])
def test_a_positive_coordinate_moves_the_tool_positively_over_the_workpiece(name: str) -> None:
    """ISO 841, primed axes or not."""
    machine = load_machine(name)
    poses, _ = random_poses(machine, 7, np.random.default_rng(1))
    moved = frames(machine, poses).tcp + np.array([0.0, 0.0, machine.tool])
    expected = sum(np.outer(poses[:, k], axis.direction) for k, axis in enumerate(machine.axes))
    assert np.abs(moved - expected).max() < 1e-15


def test_the_table_of_a_five_axis_machine_turns_as_worked_out_on_paper() -> None:
    """C' at 90°: the workpiece turns by −90°, so a tool 100 mm in +x of the table axis is over its +y side."""
    machine = load_machine("dmu60")
    pose = np.zeros((1, 5))
    pose[0, machine.index("C")] = np.pi / 2
    pose[0, machine.index("X")] = 0.1
    assert np.abs(frames(machine, pose).tcp[0] - [0.0, 0.1, -0.12]).max() < 1e-15


def test_the_swivel_of_a_five_axis_machine_turns_as_worked_out_on_paper() -> None:
    """B' at 90° about (0, 0, −200): the TCP at (0, 0, −120) is 80 mm above that line and goes to 80 mm in +x of it."""
    machine = load_machine("dmu60")
    pose = np.zeros((1, 5))
    pose[0, machine.index("B")] = np.pi / 2
    assert np.abs(frames(machine, pose).tcp[0] - [0.08, 0.0, -0.2]).max() < 1e-15


@pytest.mark.parametrize("scale", [1e-12, 1e-4, 1.0, 3.1])
def test_rotations_are_orthogonal_and_turn_by_their_length(scale: float) -> None:
    vector = scale * np.random.default_rng(2).standard_normal((20, 3))
    found = rigid.rotation(vector)
    assert np.abs(found @ np.swapaxes(found, 1, 2) - np.eye(3)).max() < 1e-14
    assert np.abs(np.linalg.det(found) - 1).max() < 1e-14
    assert np.abs(np.einsum("mij,mj->mi", found, vector) - vector).max() < 1e-14 * max(scale, 1.0) * 4
    trace = np.trace(found, axis1=1, axis2=2)
    assert np.abs(trace - (1 + 2 * np.cos(np.linalg.norm(vector, axis=1)))).max() < 1e-13


def test_a_quarter_turn_about_z_takes_x_to_y() -> None:
    turn: Array = rigid.rotation(np.array([[0.0, 0.0, np.pi / 2]]))
    assert np.abs(turn[0] @ [1, 0, 0] - [0, 1, 0]).max() < 1e-15
    moved = rigid.Motion(turn, np.array([[5.0, 0.0, 0.0]]))
    assert np.abs(moved.apply(np.array([1.0, 0.0, 0.0])) - [[5.0, 1.0, 0.0]]).max() < 1e-15
    assert np.abs(moved.shifted(np.array([1.0, 0.0, 0.0])).translation - [[5.0, 1.0, 0.0]]).max() < 1e-15


def test_a_model_without_errors_is_empty() -> None:
    machine = load_machine("one-axis")
    bare = type(machine)(machine.name, machine.axes, machine.tool, (), machine.chain, "")
    model = ErrorModel(bare)
    assert model.size == 0
    assert model.rows(np.zeros((2, 1)), np.zeros((2, 1))).shape == (2, 3, 0)
