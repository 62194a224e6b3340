"""The next measurement: no better reading in a dense lattice, gains as plain falls of the criterion."""

import itertools
from dataclasses import dataclass
from typing import Literal

import mpmath
import numpy as np
import pytest

import axiscal_core as ac
from axiscal_core import step
from axiscal_core.criterion import Goal
from axiscal_core.roots import largest
from axiscal_core.state import State, joint_gains
from tests.core.strangers import Arm, Probe


def test_a_flat_ratio_and_what_is_no_polynomial() -> None:
    found = largest(lambda t: (2 * (1 + t**2), 1 + t**2), np.array([0.0, 1.0, 2.0]), 3)
    assert found is not None
    assert found[1] == pytest.approx(2.0, rel=1e-15)
    assert largest(lambda t: (np.abs(t - 0.3), np.ones(len(t))), np.array([0.0, 1.0]), 9) is None


@dataclass(frozen=True)
class Begun:
    """A machine in the middle of its calibration."""

    case: ac.Case
    after: ac.Places
    criterion: Literal["joint", "volume"]

    @property
    def state(self) -> State:
        """What is known."""
        wanted = self.case.goal(self.criterion, "a test")
        return step.begun(self.case, wanted).after(self.case.taken(self.after, "a test"))


def random_case(generator: np.random.Generator, joints: int) -> Begun:
    """Return a machine of so many joints, stacked or with lever arms and rotary axes, after a few readings."""
    machine = _machine(generator, joints)
    unknowns = {"zero": 1.0} if generator.random() < 0.5 else {}
    noise = float(10.0 ** generator.uniform(-3, 0))
    probe = Probe("s", [axis.name for axis in machine.axes], noise=noise, unknowns=unknowns)
    case = ac.Case(machine, [probe], usual="off", sure="exactly", aligned=False)
    joint = generator.random() < 0.5
    low, high = np.array([axis.travel for axis in machine.axes]).T
    poses, sides = np.zeros((2, int(generator.integers(0, 25)), len(low)))
    for i in range(len(poses)):
        poses[i], sides[i] = generator.uniform(low, high), generator.choice([-1.0, 1.0], len(low))
    return Begun(case, ac.Places("s", poses, sides), "joint" if joint else "volume")


def shortfall(begun: Begun, points: int) -> float:
    """Return by how much the best of an exhaustive lattice beats the chosen reading, as a share of its gain."""
    chosen = step.best_step(begun.case, begun.after, begun.criterion)
    gain = float(step.gains_of(begun.case, begun.state, chosen)[0])
    return max(float(gains.max()) for gains in _exhaustive(begun, points)) / gain - 1


def _exhaustive(begun: Begun, points: int) -> list[ac.Array]:
    axes, state = begun.case.machine.axes, begun.state
    grid = np.meshgrid(*(np.linspace(*axis.travel, round(points ** (1 / len(axes)))) for axis in axes), indexing="ij")
    poses = np.stack([g.ravel() for g in grid], axis=1)
    signs = itertools.product([1.0, -1.0], repeat=len(axes)) if begun.case.machine.reversing else [(1.0,) * len(axes)]
    places = [ac.Places("s", poses, np.tile(side, (len(poses), 1))) for side in signs]
    return [step.gains_of(begun.case, state, each) for each in places]


def _machine(generator: np.random.Generator, count: int) -> ac.Machine:
    stacked = generator.random() < 0.5
    axes = [_axis(generator, name, not stacked and generator.random() < 0.4) for name in "XYZ"[:count]]
    errors = [
        ac.Error("EZ" + a.name, float(generator.uniform(0.5, 2)), knots=int(generator.integers(3, 9))) for a in axes
    ]
    if generator.random() < 0.3:
        errors.append(ac.Error(f"EZ{axes[0].name}_reversal", float(generator.uniform(0.1, 1))))
    if not stacked:
        tilts = generator.choice(["A", "B"], count)
        errors += [
            ac.Error(f"E{tilt}{a.name}", float(generator.uniform(0.1, 1)), knots=int(generator.integers(3, 7)))
            for tilt, a in zip(tilts, axes, strict=True)
        ]
    return ac.Machine(axes, errors, tool=0.3)


def _axis(generator: np.random.Generator, name: str, rotary: bool) -> ac.Axis:
    if rotary:
        start = generator.uniform(-3, 0)
        letter = {"X": "A", "Y": "B", "Z": "C"}[name]
        travel = float(start), float(start + generator.uniform(1, 2 * np.pi))
        return ac.Axis.turning(letter, name.lower(), travel, origin=(0.2, 0.1, -0.4), on_workpiece=True)
    return ac.Axis.linear(name, name.lower(), (0.0, float(generator.uniform(0.3, 3))))


@pytest.mark.parametrize(
    ("joints", "seed"),
    [
        *((1, seed) for seed in range(8)),
        *((2, seed) for seed in range(4)),
        *((3, seed) for seed in range(2)),
    ],
)
def test_no_pose_of_a_dense_lattice_gains_more(joints: int, seed: int) -> None:
    assert shortfall(random_case(np.random.default_rng(seed), joints), 20_000) <= 1e-9


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
    state = step.begun(case, case.volume).after(case.numbers(begun))
    low, high = np.array([a.travel for a in case.machine.axes]).T
    tried = low + np.random.default_rng(1).random((30_000, 2)) * (high - low)
    if moves[0] == "dial":
        tried[:, 1] = (low + high)[1] / 2
    gains, gain = (step.gains_of(case, state, each) for each in (ac.Places(moves[0], tried), best))
    assert gains.max() <= gain[0] * (1 + 1e-9)


@pytest.mark.parametrize("noise", [1e-3, 1e-9])
def test_the_next_place_is_that_of_sixty_digits(noise: float) -> None:
    """Covariance, and gains all along the axis, by the update in the space of numbers; rests are shared by cells."""
    digits = mpmath.MPContext()
    digits.dps = 60
    exact = np.vectorize(digits.mpf, otypes=[object])
    machine = ac.Machine([ac.Axis.linear("X", "x", (0, 10))], [ac.Error("EXX", std=1.0, length=4.0)])
    case = ac.Case(machine, [ac.Laser("dial", "X", noise=noise, unknowns={"zero": 0.5})], sure="exactly")
    goal, along = case.goal("volume", "a test"), ac.Places("dial", np.linspace(0, 10, 23)[:, None], [[1]] * 23)
    prior, weight, n = exact(case.prior.covariance), exact(goal.root), case.numbers(along)
    read = ac.Places("dial", [[5.0], [5.0]], [[1], [-1]])
    for _ in range(9):
        taken = case.numbers(read)
        k = taken.rows @ prior @ taken.rows.T + exact(case.shared(taken, taken)) + np.diag(exact(taken.noise) ** 2)
        inverse = np.array(digits.inverse(digits.matrix(k.tolist())).tolist())
        half, across = taken.rows @ prior, taken.rows @ prior @ n.rows.T + exact(case.shared(taken, n))
        covariance = prior - half.T @ inverse @ half
        state = step.begun(case, goal).after(taken)
        np.testing.assert_allclose(np.diag(state.covariance), np.diag(covariance).astype(float), rtol=1e-9)
        alone = [x @ prior @ x for x in n.rows] + np.diag(exact(case.shared(n, n))) + exact(n.noise) ** 2
        alone -= np.sum(across * (inverse @ across), axis=0)
        reach = weight @ (prior @ n.rows.T - half.T @ inverse @ across)
        gains = (np.sum(reach**2, axis=0) / alone).astype(float)
        np.testing.assert_allclose(step.gains_of(case, state, along), gains, rtol=1e-9, atol=1e-13)  # of J before, 1
        best = case.next(read)
        assert step.gains_of(case, state, best)[0] >= gains.max() * (1 - 1e-9)
        read = read + best


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
    weight = np.random.default_rng(2).normal(size=(3, case.size))
    for i, gain in enumerate(step.gains_of(case, step.begun(case, Goal(weight)), places)):
        n = case.numbers(places.at([i]))
        after = case.prior.read(n.rows, n.shown, n.noise**2).covariance
        fallen = weight @ (case.prior.covariance - after) @ weight.T
        assert gain == pytest.approx(np.trace(fallen), rel=1e-6)
