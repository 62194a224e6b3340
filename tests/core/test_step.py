"""The next measurement: published sequences, certified gains along a line, no better reading in a dense lattice."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

import axiscal_core as ac
from axiscal_core.criterion import Goal
from axiscal_core.roots import largest
from axiscal_core.state import State, joint_gains
from tests.certify.machines import random_case, shortfall
from tests.certify.one_joint import GainPolynomials, Problem
from tests.certify.one_joint_cases import judged, random_problem
from tests.core.strangers import Arm, Probe

CASES, LIMIT = 60, 1e-9


def test_a_flat_ratio_and_what_is_no_polynomial() -> None:
    found = largest(lambda t: (2 * (1 + t**2), 1 + t**2), np.array([0.0, 1.0, 2.0]), 3)
    assert found is not None
    assert found[1] == pytest.approx(2.0, rel=1e-15)
    assert largest(lambda t: (np.abs(t - 0.3), np.ones(len(t))), np.array([0.0, 1.0]), 9) is None


def test_the_step_reaches_the_certified_gain(record_property: Callable[[str, object], None]) -> None:
    verdicts = [judged(_problem(seed)) for seed in range(20_000, 20_000 + CASES)]
    record_property("certified one-joint cases", len(verdicts))
    assert max(v.deficit for v in verdicts) < LIMIT
    assert max(v.misstated for v in verdicts) < LIMIT
    assert len(verdicts) == CASES


def _problem(seed: int) -> Problem:
    """Return the random joint of this seed."""
    return random_problem(np.random.default_rng(seed))


def test_the_certifier_computes_the_gain_that_dense_algebra_gives() -> None:
    rng = np.random.default_rng(5)
    case = Problem(np.array([0.0, 1.0, 2.5, 3.0]), False, rng.normal(size=(4, 4)), np.eye(4), 0.5)
    for each in (case, dataclasses.replace(case, cyclic=True, factor=np.eye(3), root=np.eye(3))):
        polynomials = GainPolynomials(each)
        covariance = each.factor @ each.factor.T
        for knot, row in zip(each.knots, np.eye(len(covariance)), strict=False):
            gain = row @ covariance @ covariance @ row / (0.5 + row @ covariance @ row)
            assert float(polynomials.gain_at(float(knot))) == pytest.approx(gain, rel=1e-12)


@pytest.mark.parametrize(
    "seed", [0, 1, 53, 63, *(pytest.param(s, marks=pytest.mark.long) for s in (70, 88, 96, 139, 153, 238))]
)
def test_no_pose_of_a_dense_lattice_gains_more(seed: int) -> None:
    """On random machines; `make certify` asks it of many."""
    assert shortfall(random_case(np.random.default_rng(seed)), 20_000) <= 1e-9


def _robot() -> ac.Case:
    """An axis that turns and one that goes, seen by a dial and by a tracker."""
    axes = [ac.Axis.turning("C", "z", (-2.0, 2.5)), ac.Axis.linear("X", "x", (0.1, 0.5))]
    errors = [ac.Error("ECC", "50 urad"), ac.Error("EXX", "8 um"), ac.Error("EBX", "30 urad"), ac.Error("EXC", "5 um")]
    dial = Probe("dial", "C", noise="1 um")
    dial.along = (0.0, 1.0, 0.0)
    arm = Arm("arm", "CX", noise="5 um", unknowns={f"zero_{a}": "1 mm" for a in "xyz"})
    arm.station = (-0.8, 0.3, 0.2)
    return ac.Case(ac.Machine(axes, errors, tool=0.2), [dial, arm], usual="off", sure="exactly")


@pytest.mark.parametrize("moves", [("dial", "C"), ("arm", "CX")])
def test_nothing_gains_more_where_axes_turn_and_readings_have_three_numbers(moves: tuple[str, str]) -> None:
    case = _robot()
    begun = ac.Places(["arm", "dial", "arm"], [[0.3, 0.2], [-1.0, 0.3], [2.0, 0.45]], [[1, 1]] * 3)
    best = case.next(begun)
    state, low, high = State(case, case.volume, case.numbers(begun)), *np.array([a.travel for a in case.machine.axes]).T
    tried = low + np.random.default_rng(1).random((30_000, 2)) * (high - low)
    if moves[0] == "dial":
        tried[:, 1] = (low + high)[1] / 2
    assert state.gains(ac.Places(moves[0], tried)).max() <= state.gains(best)[0] * (1 + 1e-9)


def test_gains_of_what_is_open_beyond_the_digits_are_those_of_the_digits_there_are() -> None:
    """One unknown by which four numbers differ is open by 10¹³ of the noise: rounding leaves no sign of the rest."""
    seen = np.array([0.3, -0.2, 2.0, -1.0])
    below = 1e13 * np.outer(seen, seen) + 1e-4 * np.diag([-1.0, 1.0, -1.0, 1.0])
    above = 1e20 * np.outer(seen, seen)
    assert joint_gains(above[None], below[None])[0] == pytest.approx(1e7, rel=3e-3)


def test_gains_are_falls_of_the_criterion() -> None:
    """J after each reading, by the plain update of a normal."""
    case = _robot()
    places = case.lattice_of(case.instruments[1], 7)
    goal = Goal(np.random.default_rng(2).normal(size=(3, case.size)))
    for i, gain in enumerate(State(case, goal).gains(places)):
        n = case.numbers(places.at([i]))
        after = case.prior.read(n.rows, n.shown, n.noise**2).covariance
        assert gain == pytest.approx(goal.value(case.prior.covariance) - goal.value(after), rel=1e-6)
