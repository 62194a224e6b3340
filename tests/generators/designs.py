"""Small problems for the tests of design: the paper's splines, and a machine with levers, reversal and rests."""

from dataclasses import fields, replace

import numpy as np

from axiscal.errors.volume import Volume, even_poses, whole_travel
from axiscal.estimation.accuracy.yardstick import Yardstick
from axiscal.estimation.case import Knowledge
from axiscal.machine.axis import iso_axis
from axiscal.measurement.candidates import spread
from axiscal.measurement.instruments.displacement import Indicator
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.measurement.reading_rows import blank_readings
from axiscal.measurement.setup import Setup, Unknown
from axiscal.numerics import Array
from axiscal.planning.plan.task import Goal, Task
from axiscal_core import criterion
from axiscal_core.errors import Error
from axiscal_core.instrument import Approach
from axiscal_core.machine import Machine
from axiscal_core.normal import Normal


def splines(axes: int, knots: int, noise: float, candidates: int = 2000) -> Task:
    """Return stacked natural splines on [0, 10] m, C0 = I, criterion `joint`."""
    names = "XYZUV"[:axes]
    machine = Machine(tuple(iso_axis(n, False, (0.0, 10.0)) for n in names), _errors(names, knots), 0.0, name="m")
    setup = _setup("s", machine, noise, (), "+")
    return problem(machine, (setup,), candidates, joint=True)


def levered(candidates: int = 300) -> Task:
    """Return a table that turns under two slides: levers, reversal, rests, and two set-ups with a zero each."""
    axes = (
        iso_axis("C", True, (-1.0, 2.0), origin=(0.1, 0.2, 0.0)),
        iso_axis("X", False, (0.0, 0.6)),
        iso_axis("Z", False, (0.0, 0.4)),
    )
    errors = (
        Error("EXX", 1e-5, knots=5, rest=1e-6),
        Error("EZX", 1e-5, knots=4),
        Error("EBX", 2e-5, knots=4),
        Error("EXZ", 1e-5, knots=4, rest=5e-7),
        Error("ECC", 3e-5, knots=5, rest=1e-6),
        Error("B0Z", 2e-5),
        Error("EXX_reversal", 3e-6),
    )
    machine = Machine(axes, errors, 0.15, name="m")
    zero = (Unknown("zero", 1e-4),)
    setups = (
        _setup("x", machine, 1e-6, zero, "both", (1.0, 0.0, 0.0)),
        _setup("z", machine, 2e-6, zero, "both", (0.0, 0.0, 1.0)),
    )
    return problem(machine, setups, candidates)


def problem(machine: Machine, setups: tuple[Setup, ...], candidates: int, joint: bool = False) -> Task:
    """Return the problem before the first reading."""
    model = machine
    observation = Observation(model, setups)
    sample, nothing = even_poses(whole_travel(model), 2000), np.zeros((model.size, 0))
    yardstick = Yardstick(Volume(model, sample), model, nothing, nothing)
    root = criterion.joint(model, model.size).root if joint else yardstick.root
    belief = Normal(np.zeros(observation.size), observation.prior_covariance())
    return Task(observation, belief, root, yardstick, spread(machine, setups, candidates))


def random_poses(asked: Task, generator: np.random.Generator, count: int) -> tuple[Array, Array]:
    """Return poses and approaches anywhere in the travels, each (count, axes)."""
    low, high = np.array([axis.travel for axis in asked.observation.machine.axes]).T
    return generator.uniform(low, high, (count, len(low))), generator.choice([-1.0, 1.0], (count, len(low)))


def read(asked: Task, generator: np.random.Generator, count: int) -> Task:
    """Return the problem after some readings in random places."""
    for _ in range(count):
        setup = int(generator.integers(len(asked.observation.setups)))
        asked = read_at(asked, Places.of_setup(setup, *random_poses(asked, generator, 1)))
    return asked


def read_at(asked: Task, places: Places) -> Task:
    """Return the problem after readings at places; their values are nought."""
    setups, before = asked.observation.setups, Knowledge(asked.observation, asked.belief, asked.cells)
    known = before.read(blank_readings(setups, places.listed(setups)))
    return replace(asked, belief=known.belief, cells=known.cells)


def rms_of(asked: Task, rms: float, unsure: float = 1.0) -> Goal:
    """Return whether readings bring an RMS, m.  unsure : factor by which it may yet become larger"""

    def left(places: Places) -> float:
        factor = asked.after(places).known
        return asked.yardstick.measure_factor(factor).rms

    return Goal(lambda places: left(places) <= rms, lambda places: unsure * left(places) <= rms)


def _errors(names: str, knots: int) -> tuple[Error, ...]:
    return tuple(Error(f"EZ{name}", 1.0, knots=knots) for name in names)


def _setup(
    name: str,
    machine: Machine,
    noise: float,
    unknowns: tuple[Unknown, ...],
    approach: Approach,
    direction: tuple[float, float, float] = (0.0, 0.0, 1.0),
) -> Setup:
    count = len(machine.axes)
    park = tuple(sum(axis.travel) / 2 for axis in machine.axes)
    times = (600.0, 1.0, 3.0)
    return Indicator(
        name, machine, direction, tuple(range(count)), park, noise, unknowns, *times, (0.0,) * count, approach
    )


def of_kind(setup: Setup, kind: type[Setup]) -> Setup:
    """Return a set-up of another instrument that stands as one does."""
    return kind(**{each.name: getattr(setup, each.name) for each in fields(setup)})
