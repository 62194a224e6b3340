"""The realtime core against the product's error map, exact kinematics, and what is said of it."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.estimation.machine_estimate import Estimate
from axiscal.machine.description import machine_from_text
from axiscal.measurement.simulation import VirtualMachine
from axiscal.numerics import Array
from axiscal.ports.linuxcnc.volumetric_tables import LinuxcncVolumetric
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.round_trip import drawn_and_known
from axiscal_core.machine import Machine
from tests.figures import held
from tests.generators.known import known_to_be, truth_of
from tests.generators.machines import random_machine
from tests.generators.texts import machine_text
from tests.tables.core_library import NEEDS_GCC, Core, stated

pytestmark = NEEDS_GCC
CHAINS = [seed for seed in range(400) if {"X", "Y", "Z"} <= {axis.name for axis in random_machine(seed).axes}][:6]
"""Random chains with three linear axes: rotary ones on both sides of the bed, off centre, and between linear ones."""
LATHE = {
    "EXX": "20 um",
    "EZZ": "20 um",
    "EXZ": "15 um",
    "EYX": "15 um",
    "B0Z": "0.2 mrad",
    "EBZ": "60 urad",
    "ECC": "30 urad",
}
LATHES = ("w-b-Z-X-t", "w-C'-b-Z-X-t")
UNITS = {"mm": 1e3, "in": 1e3 / 25.4}


@pytest.fixture(scope="module")
def core(tmp_path_factory: pytest.TempPathFactory) -> Core:
    return Core(tmp_path_factory.mktemp("core"))


def drawn(seed: int, size: float | None = None) -> tuple[Estimate, VirtualMachine]:
    """A random machine and the belief of somebody who knows it; size : RMS of its deviation, m."""
    model = random_machine(seed)
    mean = np.linalg.cholesky(model.covariance()) @ np.random.default_rng(seed).standard_normal(model.size)
    if size is not None:
        poses, approaches = places(model, 500)
        deviation = model.rows_at(poses, approaches) @ mean
        mean *= size / np.sqrt(np.mean(np.sum(deviation**2, axis=1)))
    estimate = known_to_be(model, mean)
    return estimate, truth_of(estimate)


def places(model: Machine, count: int) -> tuple[Array, Array]:
    """Poses at which the linear axes span space, and sides from which they are approached."""
    rng = np.random.default_rng(7)
    low, high = np.array([axis.travel for axis in model.axes]).T
    poses: Array = rng.uniform(low, high, (4 * count, len(low)))
    linear = [k for k, axis in enumerate(model.axes) if not axis.rotary]
    rotations = model.frames(poses).rotations
    moves = np.stack([rotations[k] @ np.array(model.axes[k].direction) for k in linear], axis=2)
    poses = poses[np.abs(np.linalg.det(moves)) > 0.3][:count]
    assert len(poses) > count / 4
    return poses, rng.choice([-1.0, 1.0], poses.shape)


def shown(estimate: Estimate, values: Array, unit: str = "mm") -> Array:
    """Return coordinates in the units of a configuration, row by row."""
    factors = [np.degrees(1.0) if axis.rotary else UNITS[unit] for axis in estimate.machine.axes]
    return np.ascontiguousarray(values * factors)


def text_of(estimate: Estimate, unit: str = "mm") -> str:
    return LinuxcncVolumetric().make(estimate, ExportOptions(unit=unit)).files["axiscal.vcomp"]


def tool_of(estimate: Estimate) -> Array:
    return np.array([0.0, 0.0, -1e3 * estimate.machine.tool_length])


def lathe(chain: str) -> Estimate:
    travels = {axis: ends for axis, ends in {"X": (0, 150), "Z": (-400, 0), "C": (0, 360)}.items() if axis in chain}
    errors = {name: std for name, std in LATHE.items() if "C" in chain or name != "ECC"}
    return drawn_and_known(machine_from_text(machine_text(chain, travels, errors)))


@pytest.mark.parametrize(
    ("machine", "unit"),
    [*((seed, "mm") for seed in CHAINS), *((seed, "in") for seed in CHAINS[:2]), *((each, "mm") for each in LATHES)],
)
def test_one_round_takes_the_map_of_the_errors_away(core: Core, machine: int | str, unit: str) -> None:
    """H(t) A plus what the joints do to first order is nothing along any linear axis: 1e-6 um over 1,000 poses.

    Of a lathe, with and without a spindle that is an axis, what is left leads out of the plane of X and Z.
    """
    estimate = drawn(machine)[0] if isinstance(machine, int) else lathe(machine)
    model, axes = estimate.model, estimate.machine.axes
    poses, approaches = places(model, 1000) if isinstance(machine, int) else anywhere(model, 1000)
    assert core.load(text_of(estimate, unit).encode()) == (None, text_of(estimate, unit).count("\n"))
    tool = np.array([0.0, 0.0, -estimate.machine.tool_length * UNITS[unit]])
    added, faults, outside = core.correct(shown(estimate, poses, unit), approaches, tool, once=True)
    assert not np.any(faults)
    assert not np.any(outside)
    nominal = estimate.machine.frames(poses)
    left = model.rows_at(poses, approaches) @ estimate.mean
    ways = [nominal.rotations[k] @ np.array(axis.direction) for k, axis in enumerate(axes)]
    for k, (axis, column) in enumerate(zip(axes, added.T, strict=True)):
        lever = np.cross(ways[k], nominal.tcp - nominal.origins[k]) * np.pi / 180
        left = left + column[:, None] * (lever if axis.rotary else ways[k] / UNITS[unit])
    if not any(axis.rotary for axis in axes):  # nothing is added at machine zero
        left = left - left[0]
    for along in (way for way, axis in zip(ways, axes, strict=True) if not axis.rotary):
        apart = 1e6 * np.max(np.abs(np.sum(left * along, axis=1)))
        held("core against the levers of the error model", apart, 1e-6, "um")


def anywhere(model: Machine, count: int) -> tuple[Array, Array]:
    rng, (low, high) = np.random.default_rng(2), np.array([axis.travel for axis in model.axes]).T
    return rng.uniform(low, high, (count, len(low))), rng.choice([-1.0, 1.0], (count, len(low)))


@pytest.mark.parametrize("machine", [*CHAINS[:4], *LATHES])
def test_the_core_adds_what_is_said(core: Core, machine: int | str) -> None:
    """To 1e-9 mm, also beyond the travels, and between two sides."""
    estimate = drawn(machine)[0] if isinstance(machine, int) else lathe(machine)
    core.load(text_of(estimate).encode())
    poses, _ = (places if isinstance(machine, int) else anywhere)(estimate.model, 300)
    joints = shown(estimate, poses)
    joints += np.random.default_rng(3).uniform(-8, 8, joints.shape)
    ways = np.random.default_rng(4).uniform(-1, 1, poses.shape)
    added, faults, _ = core.correct(joints, ways, tool_of(estimate))
    good = faults == 0
    assert np.mean(good) > 0.8
    expected = stated(estimate.machine, estimate.mean, joints[good], ways[good])
    held("what is said against core", np.max(np.abs(expected - added[good])), 1e-9, "mm or deg")


def test_linear_axes_that_do_not_span_space_are_a_fault(core: Core) -> None:
    """A rotary axis between linear ones at 90 deg lays one of them along another."""
    for seed in CHAINS:
        estimate, _ = drawn(seed)
        text = text_of(estimate)
        low, high = np.array(estimate.box).T
        poses = np.random.default_rng(2).uniform(low, high, (3000, len(low)))
        core.load(text.encode())
        joints = shown(estimate, poses)
        _, faults, _ = core.correct(joints, np.zeros_like(joints), tool_of(estimate))
        if np.any(faults):
            assert set(faults) == {0, 4}
            return
    pytest.fail("no chain with a rotary axis between linear ones")


def test_positions_that_are_not_finite_are_a_fault(core: Core) -> None:
    estimate, _ = drawn(CHAINS[0])
    core.load(text_of(estimate).encode())
    joints = shown(estimate, places(estimate.model, 8)[0])
    joints[1, 0], joints[2, 1] = np.nan, np.inf
    _, faults, _ = core.correct(joints, np.zeros_like(joints), np.array([0.0, 0.0, -80.0]))
    assert list(faults[:4]) == [0, 2, 2, 0]
    _, faults, _ = core.correct(joints[:1], np.zeros_like(joints[:1]), np.array([0.0, np.nan, -80.0]))
    assert faults[0] == 2


def test_full_turns_and_ends(core: Core) -> None:
    """A full-turn axis gives the same after each turn; beyond a travel it is said."""
    seed = next(s for s in CHAINS if any(axis.cyclic for axis in random_machine(s).axes))
    estimate, _ = drawn(seed)
    text = text_of(estimate)
    core.load(text.encode())
    machine, tool = estimate.machine, tool_of(estimate)
    poses, _ = places(estimate.model, 50)
    cyclic = next(k for k, axis in enumerate(machine.axes) if axis.cyclic)
    joints, ways = shown(estimate, poses), np.zeros_like(poses)
    found = []
    for turns in (-1, 0, 2):
        further = joints.copy()
        further[:, cyclic] += 360 * turns
        added, _, outside = core.correct(further, ways, tool)
        found.append(added)
        assert not np.any(outside & (1 << cyclic))
    assert np.max(np.abs(np.array(found) - found[1])) < 1e-12
    linear = next(k for k, axis in enumerate(machine.axes) if not axis.rotary)
    joints[:, linear] = shown(estimate, np.array([[axis.travel[1] for axis in machine.axes]]))[0, linear]
    for beyond in (-0.01, 0.01):
        joints[:, linear] += beyond
        _, _, outside = core.correct(joints, ways, tool)
        assert np.all((outside & (1 << linear) > 0) == (beyond > 0))
        joints[:, linear] += 0.01


def test_the_side_turns_when_the_axis_has_come_back_by_the_dead_band(core: Core) -> None:
    """Nothing before the first motion, no turn within the dead band, and the side arrives exactly, without a step."""
    forth = np.concatenate([np.zeros(5), np.linspace(0, 0.1, 101), np.full(60, 0.1)])
    jitter = 0.1 - 0.0004 * (np.arange(60) % 2)
    back = np.concatenate([0.1 - np.linspace(0, 0.05, 51), np.full(60, 0.05)])
    seconds = 0.012
    found = core.sides(np.concatenate([forth, jitter, back]), 0.0005, seconds, 1e-3)
    assert np.all(found[:5] == 0)
    assert np.all(found[len(forth) - 1 : len(forth) + 60] == 1.0)
    assert found[-1] == -1.0
    speed, acceleration = np.diff(found), np.abs(np.diff(found, 2))
    assert np.max(acceleration) <= 8 / seconds**2 * 1e-6 * (1 + 1e-9)
    turned = np.flatnonzero(speed[len(forth) + 60 :] < 0)
    assert len(turned) == pytest.approx(seconds / 1e-3, abs=1)


def test_without_drives_no_side_turns_however_the_feedback_trembles(core: Core) -> None:
    """The drive sags by 2 mm and trembles; switched on again the side turns with the first motion the other way."""
    forth, back = np.linspace(0, 0.1, 101), -1.9 - np.linspace(0, 0.05, 51)
    sagging = 0.1 - np.linspace(0, 2.0, 400) + 0.01 * (-1.0) ** np.arange(400)
    sagging[-1] = -1.9
    at = np.concatenate([forth, np.full(30, 0.1), sagging, np.full(30, -1.9), back, np.full(60, -1.95)])
    powered = np.ones(len(at))
    powered[131:531] = 0.0
    found = core.sides(at, 0.0005, 0.012, 1e-3, powered)
    assert np.all(found[131:561] == 1.0)
    assert found[-1] == -1.0
    trembling = core.sides(at, 0.0005, 0.012, 1e-3)
    assert np.count_nonzero(np.diff(np.sign(trembling[131:531]))) > 2  # which the pin is for
    never = core.sides(at[131:531], 0.0005, 0.012, 1e-3, np.zeros(400))
    assert np.all(never == 0.0)


def test_a_side_that_turns_on_its_way_never_steps(core: Core) -> None:
    """An axis that swings faster than its side follows: the acceleration stays, and the side stays between its ends."""
    at = 0.01 * np.sin(np.arange(4000) * 1e-3 * 2 * np.pi * 31)
    found = core.sides(at, 0.0005, 0.02, 1e-3)
    assert np.max(np.abs(np.diff(found, 2))) <= 8 / 0.02**2 * 1e-6 * (1 + 1e-9)
    assert np.max(np.abs(found)) <= 1.2
    assert np.ptp(found[2000:]) > 0.5


def test_the_gain_is_the_quintic_and_turns_back_without_a_step(core: Core) -> None:
    u = np.arange(1, 1001) / 1000
    whole = core.gains(np.ones(1000), 1.0, 1e-3)
    assert whole == pytest.approx(6 * u**5 - 15 * u**4 + 10 * u**3, abs=1e-12)
    assert whole[-1] == 1.0
    back = core.gains(np.r_[np.ones(500), np.zeros(1500)], 1.0, 1e-3)
    assert back[-1] == 0.0
    assert np.max(np.abs(np.diff(back, 2))) < 2 * np.max(np.abs(np.diff(whole, 2)))  # it has to stop first
    assert np.min(back) > -0.05
