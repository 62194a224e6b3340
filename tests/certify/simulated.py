"""Random machines for a running LinuxCNC, each with programs of three to five readings: quick, for time is real."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.measurement.reading import Place
from axiscal.measurement.setup import Setup
from tests.certify.gcode import plan_on, random_machine, setups_of
from tests.linuxcnc.lab import Joint

PROGRAMS = 8
"""For each machine: one LinuxCNC runs them one after the other."""

ACCELERATION = 5e4
"""mm/s², deg/s²"""
_BEYOND = 1e-6
"""mm or deg, of LinuxCNC's limits beyond the travel: where it stands at the end of a program is off by rounding."""


@dataclass(frozen=True)
class Job:
    """A program, with the plan that it is of.  places : numbered from 1"""

    text: str
    setup: Setup
    places: tuple[Place, ...]


@dataclass(frozen=True)
class Simulated:
    """A machine with its programs, and the LinuxCNC that runs them.

    joints : in the order of their numbers; order : index of each of the machine's axes among them
    """

    machine: Machine
    joints: tuple[Joint, ...]
    order: tuple[int, ...]
    jobs: tuple[Job, ...]


def random_simulated(seed: int) -> Simulated:
    """Return axes of any names and travels, in any order of moves, with readings at the ends of their travels too."""
    rng = np.random.default_rng(seed)
    drawn = random_machine(rng)
    machine = replace(drawn, axes=tuple(_quick(axis, rng) for axis in drawn.axes))
    letters = [name for name in "XYZABC" if name in {axis.name for axis in machine.axes}]
    ends = [_written(machine.axis(name)) for name in letters]
    limits = [(low - _BEYOND, high + _BEYOND) for low, high in ends]
    joints = tuple(Joint(n, *each, 5000.0, ACCELERATION) for n, each in zip(letters, limits, strict=True))
    order = tuple(letters.index(axis.name) for axis in machine.axes)
    jobs: list[Job] = []
    while len(jobs) < PROGRAMS:
        plan = plan_on(machine, rng)
        settle, reading = float(rng.choice([0.1, 0.15])), float(rng.choice([0.0, 0.15]))
        driving = plan.setups[0].driving
        driving = replace(driving, feed=None if driving.feed is None else 0.1, dwell=bool(rng.random() < 0.9))
        quick = [replace(each, driving=driving, settle=settle, reading_time=reading) for each in plan.setups]
        plan = replace(plan, setups=tuple(quick))
        few = min(len(plan.places), int(rng.integers(3, 6)))
        plan = replace(plan, places=tuple(replace(each, setup=plan.places[0].setup) for each in plan.places[:few]))
        (setup,), (program,) = setups_of(plan), plan.programs("linuxcnc")
        jobs.append(Job(program.text, setup, plan.places))
    return Simulated(machine, joints, order, tuple(jobs))


def _quick(axis: Axis, rng: np.random.Generator) -> Axis:
    """Return an axis that is fast, and whose travel holds zero, where LinuxCNC homes it."""
    low, high = axis.travel
    shift = min(max(0.0, low), high) if low > 0 else max(high, low) if high < 0 else 0.0
    speed = float(rng.uniform(5, 30) if axis.rotary else rng.uniform(0.5, 2))
    return replace(axis, travel=(low - shift, high - shift), speed=speed)


def _written(axis: Axis) -> tuple[float, float]:
    """Return the travel in mm or deg, without the noise of binary numbers, as somebody would type it."""
    low, high = (round(math.degrees(end) if axis.rotary else 1e3 * end, 9) for end in axis.travel)
    return low, high
