"""Virtual machines scatter as the prior says, and displays move in steps."""

from dataclasses import replace

import numpy as np
import pytest

from axiscal.exceptions import ReadingError
from axiscal.machine import load_machine
from axiscal.measurement.instruments.displacement import Probe
from axiscal.measurement.setup import Setup, Unknown
from axiscal.measurement.simulation import Simulator, TruthCurve
from axiscal.numerics import Array
from axiscal_core.machine import Machine
from tests.generators.machines import random_machine, random_poses
from tests.generators.one_axis import observed


def _setup(machine: Machine, noise: float = 0.3e-6, unknowns: tuple[Unknown, ...] = ()) -> Setup:
    count = len(machine.axes)
    park = tuple(sum(axis.travel) / 2 for axis in machine.axes)
    everywhere, still = tuple(range(count)), (0.0,) * count
    return Probe("s", machine, (1.0, 0.0, 0.0), everywhere, park, noise, unknowns, 0.0, 0.0, 0.0, still, "both")


def _scatter(drawn: Array, expected: Array) -> float:
    """Return the largest distance of sample and expected covariance, in standard errors of the sample's."""
    found, variance = np.cov(drawn.T), np.diagonal(expected)
    error = np.sqrt((np.outer(variance, variance) + expected**2) / (len(drawn) - 1))
    return float(np.max(np.abs(found - expected)[error > 0] / error[error > 0]))


@pytest.mark.long
def test_drawn_curves_scatter_as_the_prior_says_rests_included() -> None:
    whole = load_machine("one-axis")
    machine = replace(whole, errors=tuple(replace(e, rest=8e-6 if e.rest else None) for e in whole.stated))
    model, positions = machine, np.array([0.0, 0.003, 0.03, 0.2, 0.2001, 0.77, 1.0])
    simulator = Simulator(machine, ())
    drawn = np.array([simulator.drawn(seed).values(positions[:, None])[0] for seed in range(3000)])
    curve = model.by_name["EXX"]
    rows, cells = curve.spline.rows(positions), np.floor((positions + 2e-4) / curve.sides[0].cell).astype(int)
    cells = np.minimum(cells, 159)
    expected = rows @ curve.covariance @ rows.T + curve.rest**2 * (cells[:, None] == cells)
    assert _scatter(drawn, expected) < 5
    assert np.abs(drawn.mean(axis=0)).max() < 5 * np.sqrt(expected.max() / 3000)


def test_a_seed_makes_one_machine() -> None:
    machine = load_machine("dmu60")
    simulator = Simulator(machine, (_setup(machine, unknowns=(Unknown("zero", 1e-4),)),))
    poses, approaches = random_poses(machine, 10, np.random.default_rng(1))
    first, again, other = (simulator.drawn(seed) for seed in (3, 3, 4))
    assert np.array_equal(first.deviation(poses, approaches), again.deviation(poses, approaches))
    assert first.offsets == again.offsets != other.offsets
    assert not np.array_equal(first.deviation(poses, approaches), other.deviation(poses, approaches))


def test_a_reading_is_the_deviation_along_the_direction_with_the_set_ups_own_and_noise() -> None:
    machine = load_machine("three-axis-mill")
    setup = _setup(machine, noise=2e-6, unknowns=(Unknown("zero", 1e-4), Unknown("slope", 1e-4)))
    virtual, rng = Simulator(machine, (setup,)).drawn(5), np.random.default_rng(6)
    pose, approach = (0.1, 0.2, 0.3), (1, -1, 1)
    drawn = np.array([virtual.read_all(setup, pose, approach, rng)[0] for _ in range(400)])
    own = virtual.offsets["s"]["zero"] + virtual.offsets["s"]["slope"] * (0.1 - 0.3)
    expected = virtual.deviation(np.array([pose]), np.array([approach], dtype=float))[0, 0] + own
    assert abs(drawn.mean() - expected) < 5 * 2e-6 / np.sqrt(400)
    assert drawn.std() == pytest.approx(2e-6, rel=0.1)


@pytest.mark.parametrize("seed", range(3))
def test_the_turn_that_is_read_is_the_turn_of_the_tool(seed: int) -> None:
    machine, rng = random_machine(seed), np.random.default_rng(seed)
    virtual, model = Simulator(machine, ()).drawn(seed), machine
    poses, approaches = random_poses(machine, 10, rng)
    small = np.zeros((10, 3))
    for i, (pose, approach) in enumerate(zip(poses, approaches, strict=True)):
        levers = model.effects(model.levers(pose[None], angular=True)[:, 0], approach[None].repeat(3, axis=0))
        small[i] = virtual.values(pose[None])[:, 0] @ levers
    assert np.abs(virtual.does(poses, approaches).rotation - small).max() < 1e-7


def test_given_curves_are_followed_between_their_points() -> None:
    curve = TruthCurve(np.array([0.0, 0.5, 1.0]), np.array([0.0, 4e-6, 2e-6]))
    virtual = Simulator(load_machine("one-axis"), ()).with_curves({"EXX": curve}, seed=1)
    found = virtual.deviation(np.array([[0.0], [0.25], [0.75], [1.0]]), np.zeros((4, 1)))
    assert found[:, 0] == pytest.approx([0.0, 2e-6, 3e-6, 2e-6], abs=1e-15)
    assert not found[:, 1:].any()


def test_a_curve_of_an_axis_that_is_not_there_is_refused() -> None:
    curve = TruthCurve(np.array([0.0, 1.0]), np.array([0.0, 0.0]))
    with pytest.raises(ReadingError, match="error of axis Y"):
        Simulator(load_machine("one-axis"), ()).with_curves({"EYY": curve}, seed=1)


def test_a_simulated_display_shows_whole_steps() -> None:
    observation = observed('resolution = "5 um"\nunknowns = {}')
    machine, rng = Simulator(observation.machine, observation.setups).drawn(1), np.random.default_rng(0)
    shown = np.array([machine.read_all(observation.setups[0], (x,), (1,), rng)[0] for x in np.linspace(0, 1, 20)])
    assert np.ptp(shown) > 5e-6
    assert np.round(shown / 5e-6) * 5e-6 == pytest.approx(shown, abs=1e-15)
