"""H(t) and the machine as it is: against exact derivatives, cases on paper, the paper's splines, second order."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import deviation_of, deviations_of, levers_at
from axiscal.machine import Machine, load_machine, machine_from_text
from axiscal.machine.entry import ErrorEntry
from axiscal.numerics import Array
from axiscal_core.splines import CyclicSpline
from tests.generators.machines import random_machine, random_poses, twin_derivative

UM, URAD, MM = 1e-6, 1e-6, 1e-3


@pytest.mark.parametrize("seed", range(10))
def test_rows_are_the_exact_derivative_on_random_machines(seed: int) -> None:
    """Any chain, primed axes, rotary origins, reversals and location errors; derivatives by complex steps."""
    model, rng = ErrorModel(random_machine(seed)), np.random.default_rng(seed)
    poses, approaches = random_poses(model.machine, 2, rng)
    rows, angular = model.rows(poses, approaches), model.angular_rows(poses, approaches)
    for i, (pose, approach) in enumerate(zip(poses, approaches, strict=True)):
        position, turned = twin_derivative(model, pose, approach)
        assert np.abs(rows[i] - position).max() < 1e-13
        assert np.abs(angular[i] - turned).max() < 1e-13


def with_errors(machine: Machine, *names: str) -> ErrorModel:
    """Return the model of a machine that has just these errors, straight lines where they are curves."""
    return ErrorModel(replace(machine, errors=tuple(ErrorEntry(name, 1.0, knots=4) for name in names)))


def _effect(model: ErrorModel, value: float, pose: dict[str, float], approach: float = 0.0) -> Array:
    """Return the TCP deviation where the only error has this value everywhere."""
    t = np.array([[pose.get(axis.name, 0.0) for axis in model.machine.axes]])
    result: Array = model.rows(t, np.full_like(t, approach))[0] @ np.full(model.size, value)
    return result


MILL = load_machine("three-axis-mill")
DMU = load_machine("dmu60")
ON_PAPER = [
    # The table of the mill strays by +10 µm in x: the tool stands 10 µm in −x of where it should over the workpiece.
    ("table strays", MILL, "EXX", 10 * UM, {"X": 0.3}, (-10 * UM, 0, 0)),
    ("head strays", MILL, "EXZ", 10 * UM, {"Z": 0.2}, (10 * UM, 0, 0)),
    # The table pitches by 10 µrad about y; the TCP is 120 mm below the origin at Z 0, 280 mm above it at Z 400.
    ("table pitches, head down", MILL, "EBX", 10 * URAD, {}, (1.2 * UM, 0, 0)),
    ("table pitches, head up", MILL, "EBX", 10 * URAD, {"Z": 0.4}, (-2.8 * UM, 0, 0)),
    # Its carriage has gone 300 mm to −x of the machine, the TCP is 300 mm to +x of it: −εb × 300 mm = … in z: +3 µm.
    ("table pitches at x 300", MILL, "EBX", 10 * URAD, {"X": 0.3}, (1.2 * UM, 0, 3 * UM)),
    # Abbe: the head pitches about x; the TCP is only the tool's length below it, whatever Z is.
    ("head pitches", MILL, "EAZ", 10 * URAD, {"Z": 0.4}, (0, 1.2 * UM, 0)),
    ("head rolls about the tool", MILL, "ECZ", 10 * URAD, {"Z": 0.4, "X": 0.3}, (0, 0, 0)),
    # Y turned by +30 µrad about z out of square: 400 mm of travel carry −x by 12 µm, on either side of the bed.
    ("Y out of square on the mill", MILL, "C0Y", 30 * URAD, {"Y": 0.4}, (-12 * UM, 0, 0)),
    ("Y out of square on the five-axis", DMU, "C0Y", 30 * URAD, {"Y": 0.2}, (-6 * UM, 0, 0)),
    ("Z out of square", MILL, "B0Z", 30 * URAD, {"Z": 0.4}, (12 * UM, 0, 0)),
    ("Z out of square to Y", MILL, "A0Z", 30 * URAD, {"Z": 0.4}, (0, -12 * UM, 0)),
    # The line of the table C sits 15 µm to +x: so does the workpiece, in directions that turn with it.
    ("table line off, C 0", DMU, "X0C", 15 * UM, {}, (-15 * UM, 0, 0)),
    ("table line off, C 90", DMU, "X0C", 15 * UM, {"C": np.pi / 2}, (0, -15 * UM, 0)),
    ("table line off, C 180", DMU, "X0C", 15 * UM, {"C": np.pi}, (15 * UM, 0, 0)),
    # The table is 10 µrad ahead; the TCP is 100 mm in x off its line: 1 µm to −y as the table sees it at C 0.
    ("table ahead", DMU, "ECC", 10 * URAD, {"X": 0.1}, (0, -1 * UM, 0)),
    ("table ahead, C 90", DMU, "ECC", 10 * URAD, {"X": 0.1, "C": np.pi / 2}, (1 * UM, 0, 0)),
    # The swivel line tilts about x; the TCP is 80 mm above it and 50 mm along it.
    ("swivel line tilts", DMU, "A0B", 10 * URAD, {"Y": 0.05}, (0, 0.8 * UM, -0.5 * UM)),
]


@pytest.mark.parametrize(("what", "machine", "name", "value", "pose", "expected"), ON_PAPER)
def test_cases_worked_out_on_paper(
    what: str, machine: Machine, name: str, value: float, pose: dict[str, float], expected: tuple[float, ...]
) -> None:
    assert _effect(with_errors(machine, name), value, pose) == pytest.approx(expected, abs=1e-12), what


@pytest.mark.parametrize("length", [0.2, 1.0, 3.0, 30.0])
@pytest.mark.parametrize("knots", [4, 13, 60])
def test_the_prior_of_a_full_turn_is_a_covariance_that_closes(length: float, knots: int) -> None:
    model = ErrorModel(replace(DMU, errors=(ErrorEntry("ECC", 1.0, knots=knots, length=length),)))
    (function,) = model.functions
    assert isinstance(function.basis, CyclicSpline)
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
    model = ErrorModel(machine_from_text(text, "two knots"))
    row = model.rows(np.array([[0.025]]), np.array([[1.0]]))[0, 0]
    assert row == pytest.approx([0.75, 0.25, 0.5])


_STEP = 1e-4


def _drawn(model: ErrorModel, rng: np.random.Generator, factor: float) -> Array:
    return factor * np.sqrt(np.diagonal(model.prior_covariance())) * rng.standard_normal(model.size)


@pytest.mark.parametrize("seed", range(3))
def test_levers_of_a_machine_with_large_errors_are_the_differences_of_the_exact_chain(seed: int) -> None:
    model, rng = ErrorModel(random_machine(seed)), np.random.default_rng(seed)
    poses, _ = random_poses(model.machine, 3, rng)
    sides, at = np.zeros_like(poses), _drawn(model, rng, 100.0)
    levers = levers_at(model, at, poses)[0]
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
