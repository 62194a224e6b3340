"""The machine as it is: levers against differences of the exact chain, and the bound on what first order leaves out."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.errors.actual import MovedErrors, deviation_of, deviations_of, levers_at
from axiscal.errors.linear_bound import linear_along, linear_to, linear_ways, longest_arm
from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import whole_travel
from axiscal.machine import builtin_names, load_machine
from axiscal.machine.kinematics import frames
from axiscal.numerics import Array, rigid
from tests.generators.machines import random_machine, random_poses

_STEP = 1e-4


def _drawn(model: ErrorModel, rng: np.random.Generator, factor: float) -> Array:
    return factor * np.sqrt(np.diagonal(model.prior_covariance())) * rng.standard_normal(model.size)


@pytest.mark.parametrize("seed", range(6))
def test_levers_of_a_machine_with_large_errors_are_the_differences_of_the_exact_chain(seed: int) -> None:
    model, rng = ErrorModel(random_machine(seed)), np.random.default_rng(seed)
    poses, _ = random_poses(model.machine, 3, rng)
    sides, at = np.zeros_like(poses), _drawn(model, rng, 100.0)
    levers = levers_at(model, at, poses).straight
    rows = np.stack([model.along(levers[:, :, c], poses, sides) for c in range(3)], axis=1)
    for i in range(0, model.size, 5):
        one = _STEP * np.eye(model.size)[i]
        up, down = (deviation_of(model, at + sign * one, poses, sides).displacement for sign in (1, -1))
        assert np.abs((up - down) / (2 * _STEP) - rows[:, :, i]).max() < 1e-7


@pytest.mark.parametrize("seed", range(3))
def test_many_machines_at_once_deviate_as_each_of_them(seed: int) -> None:
    """So many poses that they are not all looked at together."""
    model, rng = ErrorModel(random_machine(seed)), np.random.default_rng(seed)
    poses, sides = random_poses(model.machine, 3000, rng)
    machines = np.array([_drawn(model, rng, 30.0) for _ in range(5)])
    found = list(deviations_of(model, machines, poses, sides))
    for machine, one in zip(machines, found, strict=True):
        for mine, alone in zip(one, deviation_of(model, machine, poses, sides), strict=True):
            np.testing.assert_allclose(mine, alone, rtol=0, atol=1e-14)


@pytest.mark.parametrize("name", builtin_names())
def test_levers_of_some_errors_are_theirs_among_all(name: str) -> None:
    model, rng = ErrorModel(load_machine(name)), np.random.default_rng(4)
    poses, _ = random_poses(model.machine, 5, rng)
    some = rng.permutation(len(model.terms))[: len(model.terms) // 2]
    for errors in (model, MovedErrors(model.machine, _drawn(model, rng, 10.0))):
        np.testing.assert_array_equal(errors.levers_of(some.tolist(), poses), errors.levers(poses)[some])
        assert errors.levers_of([], poses).shape == (0, 5, 3)


@pytest.mark.parametrize("name", builtin_names())
def test_levers_without_errors_are_the_nominal_ones(name: str) -> None:
    model = ErrorModel(load_machine(name))
    poses, _ = random_poses(model.machine, 5, np.random.default_rng(1))
    found = levers_at(model, np.zeros(model.size), poses)
    assert np.abs(found.straight - model.levers(poses)).max() < 1e-15
    assert np.abs(found.angular - model.angular_levers(poses)).max() < 1e-15


def test_left_jacobian_is_the_derivative_of_the_rotation() -> None:
    rng = np.random.default_rng(2)
    for size in (1e-9, 5e-3, 0.02, 2.0):
        vector = size * rng.standard_normal((1, 3))
        jacobian = rigid.left_jacobian(vector)[0]
        for c in range(3):
            step = 1e-6 * np.eye(3)[c]
            turned = (rigid.rotation(vector + step) - rigid.rotation(vector - step))[0] / 2e-6
            spin = turned @ rigid.rotation(vector)[0].T
            assert [spin[2, 1], spin[0, 2], spin[1, 0]] == pytest.approx(jacobian[:, c], abs=1e-8)


@pytest.mark.parametrize(("name", "factor"), [("dmu60", 1.0), ("dmu60", 10.0), ("three-axis-mill", 30.0)])
def test_no_machine_is_farther_from_linear_than_the_bound(name: str, factor: float) -> None:
    model, rng = ErrorModel(load_machine(name)), np.random.default_rng(3)
    box, worst = whole_travel(model), 0.0
    for _ in range(40):
        poses, sides = random_poses(model.machine, 100, rng)
        at = _drawn(model, rng, factor)
        sizes = np.array([np.abs(f.rows(f.coordinates(poses)) @ at[f.columns]).max() for f in model.terms])
        exact = deviation_of(model, at, poses, sides).displacement
        left = np.linalg.norm(exact - model.rows(poses, sides) @ at, axis=1).max()
        worst = max(worst, left / linear_to(model, sizes, box))
    assert 0.02 < worst < 1.0


@pytest.mark.parametrize("name", builtin_names())
@pytest.mark.parametrize("factor", [1.0, 20.0])
def test_no_machine_is_farther_from_linear_along_a_direction_than_its_bound(name: str, factor: float) -> None:
    model, rng = ErrorModel(load_machine(name)), np.random.default_rng(4)
    _held_along(model, rng, factor)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(12))
def test_nor_is_a_made_up_machine(seed: int) -> None:
    _held_along(ErrorModel(random_machine(seed)), np.random.default_rng(seed), 5.0)


def _held_along(model: ErrorModel, rng: np.random.Generator, factor: float) -> None:
    """Hold the exact chain of machines that are drawn, and of those with every error at its size, to the bounds."""
    box, worst = whole_travel(model), 0.0
    for _ in range(15):
        poses, sides = random_poses(model.machine, 60, rng)
        at = _drawn(model, rng, factor)
        sizes = np.array([np.abs(f.rows(f.coordinates(poses)) @ at[f.columns]).max() for f in model.terms])
        left = deviation_of(model, at, poses, sides).displacement - model.rows(poses, sides) @ at
        bound = linear_ways(model, sizes, box)
        assert np.all(np.abs(left).max(axis=0) <= bound * (1 + 1e-9) + 1e-15)
        worst = max(worst, float((np.abs(left).max(axis=0) / np.maximum(bound, 1e-15)).max()))
    assert worst > 5e-4


def test_a_height_over_a_bed_is_nearer_to_linear_than_the_tool_in_space() -> None:
    model = ErrorModel(load_machine("printer-gantry"))
    sizes = np.array([2 * np.sqrt(np.diag(f.covariance).max()) for f in model.terms])
    box = (*whole_travel(model),)
    low = tuple((0.0, 1e-3) if axis.name == "Z" else side for axis, side in zip(model.machine.axes, box, strict=True))
    along, space = (linear_along(model, sizes, low, ways) for ways in ((False, False, True), (True, True, True)))
    assert along < space / 5
    assert space == linear_to(model, sizes, low)


@pytest.mark.parametrize("seed", range(8))
def test_no_arm_is_longer_than_the_longest(seed: int) -> None:
    machine = random_machine(seed)
    poses, _ = random_poses(machine, 200, np.random.default_rng(seed))
    at = frames(machine, poses)
    arms = np.linalg.norm(at.tcp - at.origins, axis=2).max()
    assert arms <= longest_arm(machine, tuple(axis.travel for axis in machine.axes)) * (1 + 1e-12)
