"""The best reading on random machines of two and three joints, against an exhaustive lattice of a million poses."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import volume_moments, whole_travel
from axiscal.estimation.accuracy.criterion import Root, joint_root
from axiscal.estimation.belief import Belief
from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.machine.entry import ErrorEntry
from axiscal.measurement.candidates import spread
from axiscal.measurement.observation import Observation
from axiscal.measurement.setup import Setup, Unknown
from axiscal.numerics import Array
from axiscal.planning.gains.covariance import Covariance
from axiscal.planning.gains.gain import Scorer
from axiscal.planning.step.best_step import best_of

_BLOCK = 20_000


@dataclass(frozen=True)
class Case:
    """A machine in the middle of its calibration."""

    observation: Observation
    belief: Belief
    root: Root


def random_case(generator: np.random.Generator) -> Case:
    """Return a machine of two or three joints, stacked or with lever arms and rotary axes, after a few readings."""
    machine = _machine(generator, int(generator.integers(2, 4)))
    model = ErrorModel(machine)
    observation = Observation(model, (_setup(generator, machine),))
    root = (
        joint_root(model) if generator.random() < 0.5 else Root.of_gram(volume_moments(model, whole_travel(model)).gram)
    )
    belief = Belief(np.zeros(observation.size), observation.prior_covariance())
    for _ in range(int(generator.integers(0, 25))):
        pose, approach = _random_poses(generator, observation, 1)
        seen = observation.rows(0, pose, approach)
        belief = belief.update(seen.rows, 0.0, seen.variances)
    return Case(observation, belief, root)


def shortfall(case: Case, points: int) -> float:
    """Return by how much the best of an exhaustive lattice beats the chosen reading, as a share of its gain."""
    scorer = Covariance.from_factor(case.observation, case.belief.factor, case.root).scorer()
    machine = case.observation.machine
    step = best_of(scorer, spread(machine, case.observation.setups, 1500))
    return max(float(gains.max()) for gains in _exhaustive(case, scorer, points)) / step.gain - 1


def _exhaustive(case: Case, scorer: Scorer, points: int) -> list[Array]:
    axes = case.observation.machine.axes
    per_axis = round(points ** (1 / len(axes)))
    grid = np.meshgrid(*(np.linspace(*axis.travel, per_axis) for axis in axes), indexing="ij")
    poses = np.stack([g.ravel() for g in grid], axis=1)
    reverses = any(f.kind == "reversal" for f in case.observation.errors.functions)
    signs = np.array(list(itertools.product([1.0, -1.0], repeat=len(axes)))) if reverses else np.ones((1, len(axes)))
    shares = math.ceil(len(poses) / _BLOCK)
    return [scorer.gains_at(0, p, np.tile(s, (len(p), 1))) for s in signs for p in np.array_split(poses, shares)]


def _machine(generator: np.random.Generator, count: int) -> Machine:
    stacked = generator.random() < 0.5
    axes = tuple(_axis(generator, name, not stacked and generator.random() < 0.4) for name in "XYZ"[:count])
    errors = [ErrorEntry("EZ" + a.name, generator.uniform(0.5, 2), knots=int(generator.integers(3, 9))) for a in axes]
    if generator.random() < 0.3:
        errors.append(ErrorEntry(f"EZ{axes[0].name}_reversal", generator.uniform(0.1, 1)))
    if not stacked:
        tilts = generator.choice(["A", "B"], count)
        errors += [
            ErrorEntry(f"E{tilt}{a.name}", generator.uniform(0.1, 1), knots=int(generator.integers(3, 7)))
            for tilt, a in zip(tilts, axes, strict=True)
        ]
    return Machine("random", axes, 0.3, tuple(errors), "", "")


def _axis(generator: np.random.Generator, name: str, rotary: bool) -> Axis:
    if rotary:
        start = generator.uniform(-3, 0)
        letter = {"X": "A", "Y": "B", "Z": "C"}[name]
        return Axis.named(letter, True, (start, start + generator.uniform(1, 2 * np.pi)), origin=(0.2, 0.1, -0.4))
    return Axis.named(name, False, (0.0, generator.uniform(0.3, 3)))


def _setup(generator: np.random.Generator, machine: Machine) -> Setup:
    moves = tuple(range(len(machine.axes)))
    unknowns = (Unknown("zero", 1.0),) if generator.random() < 0.5 else ()
    noise = 10.0 ** generator.uniform(-3, 0)
    park = tuple(sum(axis.travel) / 2 for axis in machine.axes)
    return Setup("s", "probe", (0.0, 0.0, 1.0), moves, park, noise, unknowns, 0, 0, 0, (0.0,) * len(moves), "both")


def _random_poses(generator: np.random.Generator, observation: Observation, count: int) -> tuple[Array, Array]:
    axes = observation.machine.axes
    low, high = np.array([axis.travel for axis in axes]).T
    poses = generator.uniform(low, high, (count, len(axes)))
    return poses, generator.choice([-1.0, 1.0], (count, len(axes)))
