"""The best reading on random machines of two and three joints, against an exhaustive lattice of a million poses."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Literal

import numpy as np

import axiscal_core as ac
from axiscal_core.state import State
from axiscal_core.step import best_step
from tests.core.strangers import Probe


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
        return State(self.case, wanted, self.case.taken(self.after, "a test"))


def random_case(generator: np.random.Generator) -> Begun:
    """Return a machine of two or three joints, stacked or with lever arms and rotary axes, after a few readings."""
    machine = _machine(generator, int(generator.integers(2, 4)))
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
    chosen = best_step(begun.case, begun.after, begun.criterion)
    return max(float(gains.max()) for gains in _exhaustive(begun, points)) / float(begun.state.gains(chosen)[0]) - 1


def _exhaustive(begun: Begun, points: int) -> list[ac.Array]:
    axes, state = begun.case.machine.axes, begun.state
    grid = np.meshgrid(*(np.linspace(*axis.travel, round(points ** (1 / len(axes)))) for axis in axes), indexing="ij")
    poses = np.stack([g.ravel() for g in grid], axis=1)
    reverses = any(term.error.kind == "reversal" for _, term in begun.case.machine.curves)
    signs = itertools.product([1.0, -1.0], repeat=len(axes)) if reverses else [(1.0,) * len(axes)]
    return [state.gains(ac.Places("s", poses, np.tile(side, (len(poses), 1)))) for side in signs]


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
