"""H(t) and the machine as it is: against exact derivatives, the prior of a turn, large errors."""

from dataclasses import replace

import numpy as np
import pytest

from axiscal.errors.volume import deviation_of
from axiscal.machine import load_machine, machine_from_text
from axiscal.measurement.observation import deviations_of
from axiscal.numerics import Array
from axiscal_core.errors import Error
from axiscal_core.machine import Machine
from axiscal_core.splines import CyclicSpline
from tests.generators.machines import random_machine, random_poses, twin_derivative


@pytest.mark.parametrize("seed", range(10))
def test_rows_are_the_exact_derivative_on_random_machines(seed: int) -> None:
    """Any chain, primed axes, rotary origins, reversals and location errors; derivatives by complex steps."""
    model, rng = random_machine(seed), np.random.default_rng(seed)
    poses, approaches = random_poses(model, 2, rng)
    rows, angular = model.rows_at(poses, approaches), model.rows_at(poses, approaches, angular=True)
    for i, (pose, approach) in enumerate(zip(poses, approaches, strict=True)):
        position, turned = twin_derivative(model, pose, approach)
        assert np.abs(rows[i] - position).max() < 1e-13
        assert np.abs(angular[i] - turned).max() < 1e-13


@pytest.mark.parametrize("length", [0.2, 1.0, 3.0, 30.0])
@pytest.mark.parametrize("knots", [4, 13, 60])
def test_the_prior_of_a_full_turn_is_a_covariance_that_closes(length: float, knots: int) -> None:
    model = replace(load_machine("dmu60"), errors=(Error("ECC", 1.0, knots=knots, length=length),))
    (function,) = model.curves
    assert isinstance(function.spline, CyclicSpline)
    assert function.covariance[0, 1] == pytest.approx(function.covariance[0, -1])
    assert np.linalg.eigvalsh(function.covariance)[0] > -1e-12 * knots


def test_a_straight_line_and_a_constant_on_the_same_knots_are_told_apart() -> None:
    """Two knots and a constant span the same travel, but have two control values and one."""
    text = """
    chain = "w-b-X-t"
    [axes.X]
    travel = ["0 mm", "100 mm"]
    [errors]
    EXX = { std = "10 um", knots = 2 }
    EXX_reversal = { std = "3 um" }
    """
    model = machine_from_text(text, "two knots")
    row = model.rows_at(np.array([[0.025]]), np.array([[1.0]]))[0, 0]
    assert row == pytest.approx([0.75, 0.25, 0.5])


_STEP = 1e-4


def _drawn(model: Machine, rng: np.random.Generator, factor: float) -> Array:
    return factor * np.sqrt(np.diagonal(model.covariance())) * rng.standard_normal(model.size)


@pytest.mark.parametrize("seed", range(3))
def test_many_machines_at_once_deviate_as_each_of_them(seed: int) -> None:
    """So many poses that they are not all looked at together."""
    model, rng = random_machine(seed), np.random.default_rng(seed)
    poses, sides = random_poses(model, 3000, rng)
    machines = np.array([_drawn(model, rng, 30.0) for _ in range(5)])
    found = list(deviations_of(model, machines, poses, sides))
    for machine, one in zip(machines, found, strict=True):
        for mine, alone in zip(one, deviation_of(model, machine, poses, sides), strict=True):
            np.testing.assert_allclose(mine, alone, rtol=0, atol=1e-14)
