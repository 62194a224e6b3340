"""What instruments see: rows against the virtual machine's own readings, untold sides, cells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.machine import load_machine
from axiscal.machine.axis import iso_axis
from axiscal.measurement.candidates import breaks_along
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.instruments.displacement import Displacement
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places, Reading
from axiscal.measurement.reading_rows import seen
from axiscal.measurement.setup import Setup, Unknown
from axiscal.measurement.simulation import VirtualMachine
from axiscal.numerics import Array
from axiscal_core.errors import Error
from axiscal_core.machine import Machine
from tests.generators.known import known_to_be, truth_of
from tests.generators.machines import random_machine, random_poses


def mounted(machine: Machine, instrument: str, direction: tuple[float, float, float]) -> Setup:
    """Return a set-up that may move every axis and has every unknown that it can have."""
    linear = any(not axis.rotary for axis in machine.axes)
    kinds = INSTRUMENTS[instrument].unknown_reads
    usual = [kind for kind in kinds if kind != "growth" and (linear or kind != "slope")]
    unknowns = tuple(Unknown(kind, 1e-4) for kind in usual)
    count = len(machine.axes)
    park = tuple(sum(axis.travel) / 2 for axis in machine.axes)
    times, raster = (0.0, 0.0, 0.0), (0.0,) * count
    moves, station = tuple(range(count)), (3.0, -2.0, 1.5)
    kind = INSTRUMENTS[instrument]
    return kind("s", machine, direction, moves, park, 0.3e-6, unknowns, *times, raster, "both", station=station)


def at(*pose: float) -> Places:
    """Return one place of the first set-up, from the positive side of all axes."""
    return Places.one(0, np.array(pose), np.ones(len(pose)))


def _direction(seed: int) -> tuple[float, float, float]:
    x, y, z = np.random.default_rng(seed).standard_normal(3)
    length = float(np.sqrt(x * x + y * y + z * z))
    return float(x) / length, float(y) / length, float(z) / length


def virtual(model: Machine, setups: tuple[Setup, ...], unknowns: Array) -> VirtualMachine:
    """Return the machine whose unknowns, the set-ups' own behind the errors, have these values."""
    offsets, start = {}, model.size
    for setup in setups:
        offsets[setup.name] = {u.name: float(unknowns[start + i]) for i, u in enumerate(setup.unknowns)}
        start += len(setup.unknowns)
    return VirtualMachine(model, truth_of(known_to_be(model, unknowns[: model.size])).curves, offsets)


@pytest.mark.parametrize("instrument", sorted(INSTRUMENTS))
@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.long)])
def test_rows_are_the_differences_of_what_a_virtual_machine_reads(instrument: str, seed: int) -> None:
    """All unknowns at once, each in a direction drawn for it, by central differences; two set-ups may mix columns."""
    model, rng = random_machine(seed, count=2 + seed % 2), np.random.default_rng(seed)
    beside = (0.03, -0.05, 0.02) if issubclass(INSTRUMENTS[instrument], Displacement) else None
    one = replace(mounted(model, instrument, _direction(seed)), noise=0.0, offset=beside)
    setups = (replace(one, name="other", direction=(1.0, 0.0, 0.0)), one)
    observation, step = Observation(model, setups), 1e-6
    poses, approaches = random_poses(model, 1, rng)
    pose, approach = tuple(map(float, poses[0])), tuple(map(int, approaches[0]))
    rows = seen(observation, [Reading("s", pose, approach, 0.0)])[0].rows
    for towards in rng.uniform(-1, 1, (6, observation.size)):
        ends = [virtual(model, setups, sign * step * towards) for sign in (1, -1)]
        up, down = (np.array(machine.read_all(one, pose, approach, rng)) for machine in ends)
        assert np.abs((up - down) / (2 * step) - rows @ towards).max() < 1e-8


def test_an_untold_side_widens_a_reading_by_half_the_reversal() -> None:
    """With +½ and −½ of the reversal equally likely, the variance is a quarter of the reversal's."""
    model = load_machine("one-axis")
    setup = replace(mounted(model, "interferometer", (1.0, 0.0, 0.0)), unknowns=())
    observation, middle = Observation(model, (setup,)), np.array([[0.5]])
    places = [Places.of_setup(0, middle, np.full((1, 1), side)) for side in (1.0, 0.0)]
    told, untold = (observation.variances(observation.numbers(each))[0] for each in places)
    reversal = model.by_name["EXX_reversal"]
    drawn = np.random.default_rng(3).normal(0.0, np.sqrt(reversal.covariance[0, 0]), 200_000)
    sides = np.random.default_rng(4).choice([-0.5, 0.5], 200_000)
    assert untold - told == pytest.approx(np.var(drawn * sides), rel=0.02, abs=0.0)
    assert untold - told == pytest.approx((reversal.covariance[0, 0] + reversal.rest**2) / 4, rel=1e-6, abs=0.0)


@pytest.mark.parametrize("position", [0.0, 1.0])
def test_the_ends_of_the_travel_lie_in_its_cells(position: float) -> None:
    model = load_machine("one-axis")
    numbers = Observation(model, (mounted(model, "probe", (1.0, 0.0, 0.0)),)).numbers(at(position))
    (column,) = np.flatnonzero(numbers.reach[0])
    assert (numbers.cell[0, column], numbers.reach[0, column]) == (round(position * 159), 1.0)


def test_breaks_are_knots() -> None:
    axis = iso_axis("X", False, (0.0, 0.4))
    machine = Machine((axis,), (Error("EXX", 1e-6, knots=3, rest=1e-6),), 0.0, name="m")
    observation = Observation(machine, (mounted(machine, "probe", (1.0, 0.0, 0.0)),))
    assert breaks_along(observation, 0, 0) == pytest.approx([0.0, 0.2, 0.4])
