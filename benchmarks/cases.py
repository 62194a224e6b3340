"""The problems that benchmarks share: stacked splines as in the paper, and the built-in five-axis machine."""

from __future__ import annotations

import numpy as np

import axiscal_core as ac
from axiscal.errors.gauge import unseen_factor
from axiscal.errors.volume import Volume, even_poses, whole_travel
from axiscal.estimation.accuracy.yardstick import Yardstick
from axiscal.machine import load_machine
from axiscal.machine.axis import iso_axis
from axiscal.measurement.candidates import spread
from axiscal.measurement.instruments.displacement import Indicator, Probe
from axiscal.measurement.observation import Observation
from axiscal.measurement.setup import Setup, Unknown
from axiscal.planning.plan.task import Task
from axiscal_core import criterion
from axiscal_core.errors import Error
from axiscal_core.machine import Machine
from axiscal_core.normal import Normal
from benchmarks.peers.problems import Stacked


def stacked(case: Stacked, candidates: int, volume: bool = False) -> Task:
    """Return one of the cases under the criterion `joint`, or `volume`."""
    names = "XYZUV"[: case.axes]
    axes = tuple(iso_axis(name, False, (0.0, 10.0)) for name in names)
    errors = tuple(Error(f"EZ{name}", 1.0, knots=case.knots) for name in names)
    machine = Machine(axes, errors, 0.0, name="stacked")
    count = case.axes
    moves, park, raster = tuple(range(count)), (5.0,) * count, (0.0,) * count
    setup = Indicator("s", machine, (0.0, 0.0, 1.0), moves, park, case.noise, (), 0.0, 0.0, 1.0, raster, "+")
    return _problem(machine, (setup,), candidates, not volume)


def alone(case: Stacked) -> ac.Case:
    """Return one of the cases for the core."""
    axes = [ac.Axis.linear(name, "x", (0.0, 10.0)) for name in "XYZUV"[: case.axes]]
    machine = ac.Machine(axes, [ac.Error(f"EZ{axis.name}", 1.0, knots=case.knots) for axis in axes])
    dial = ac.Laser("s", machine.axis_names, along="z", noise=case.noise, unknowns={"zero": 0.0}, approach="+")
    return ac.Case(machine, [dial], usual="off", sure="exactly", aligned=False)


def five_axis(candidates: int) -> Task:
    """Return the built-in machine with all error motions, and a probe along each direction that goes everywhere."""
    machine = load_machine("dmu60")
    count = len(machine.axes)
    park = tuple(sum(axis.travel) / 2 for axis in machine.axes)
    zero = (Unknown("zero", 1e-4),)
    directions = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
    setups = tuple(
        Probe(name, machine, way, tuple(range(count)), park, 1e-6, zero, 600.0, 1.0, 2.0, (0.0,) * count, "both")
        for name, way in directions.items()
    )
    return _problem(machine, setups, candidates, False)


def _problem(machine: Machine, setups: tuple[Setup, ...], candidates: int, joint: bool) -> Task:
    model = machine
    observation = Observation(model, setups)
    belief = Normal(np.zeros(observation.size), observation.prior_covariance())
    coarse = spread(machine, setups, 1000)
    seen = observation.numbers(coarse)
    rows = seen.rows / np.sqrt(observation.variances(seen))[:, None]
    sample = even_poses(whole_travel(model), 4000)
    unseen = unseen_factor(belief.factor, rows)[: model.size]
    yardstick = Yardstick(Volume(model, sample), model, unseen, unseen)
    root = criterion.joint(model, model.size).root if joint else yardstick.root
    return Task(observation, belief, root, yardstick, spread(machine, setups, candidates))
