"""The machine as it is: levers against differences of the exact chain, and the bound on what first order leaves out."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import MovedErrors, deviation_of, deviations_of, levers_at
from axiscal.machine import builtin_names, load_machine
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
