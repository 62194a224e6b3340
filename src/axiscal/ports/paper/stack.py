"""The paper's machine: linear joints stacked on each other, all moving along x, whose height errors add up.

One joint is the paper's single spline (B&H section V, figures 4 and 5), three are its sample machine (figures 6 and
7). The parts are those of every calibration; only the unit is the paper's, which has none: 1 there is 1 mm here.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from axiscal.errors.gauge import unseen_factor
from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import volume_moments, whole_travel
from axiscal.estimation.accuracy import criterion
from axiscal.estimation.accuracy.criterion import Root
from axiscal.estimation.belief import Belief
from axiscal.estimation.knowledge import Knowledge
from axiscal.machine import Machine, load_machine, machine_from_text
from axiscal.measurement.candidates import spread
from axiscal.measurement.observation import Observation
from axiscal.measurement.place import Places
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.planning.step.best_step import best_step

UNIT = 1e-3
"""What the paper calls 1, in metres."""
_CANDIDATES = 2000
"""Candidates from which the exact step begins."""

_ONE_JOINT = """
name = "One joint of the paper"
chain = "w-b-X-t"
[axes.X]
travel = ["0 mm", "10 mm"]
[errors]
EZX = { std = "1 mm", knots = 7 }
"""


@dataclass(frozen=True, eq=False)
class Stack:
    """Stacked joints and a dial that reads the height of their sum.

    machine : with one height error per joint; std : of a reading, paper units
    """

    machine: Machine
    std: float

    @cached_property
    def errors(self) -> ErrorModel:
        """The splines of all joints."""
        return ErrorModel(self.machine)

    @cached_property
    def setup(self) -> Setup:
        """The dial: it reads the height, and every joint may move."""
        middle = tuple(sum(axis.travel) / 2 for axis in self.machine.axes)
        moves, raster, noise = tuple(range(len(middle))), (0.0,) * len(middle), self.std * UNIT
        return Setup("height", "indicator", (0.0, 0.0, 1.0), moves, middle, noise, (), 0.0, 0.0, 0.0, raster, "+")

    @cached_property
    def observation(self) -> Observation:
        """The linear map from control values to readings (B&H eq. 29-30)."""
        return Observation(self.errors, (self.setup,))

    @cached_property
    def prior(self) -> Belief:
        """Independent control values of variance 1 and mean 0 (B&H eq. 16)."""
        return Belief(np.zeros(self.errors.size), self.errors.prior_covariance())

    @cached_property
    def joint(self) -> Root:
        """V of the paper's criterion, the variances of all splines, summed (B&H eq. 26, 36)."""
        return criterion.joint_root(self.errors)

    @cached_property
    def volume(self) -> Root:
        """V of the criterion `volume`, the mean variance of the height."""
        return criterion.Root.of_gram(volume_moments(self.errors, whole_travel(self.errors)).gram)

    @cached_property
    def candidates(self) -> Places:
        """Where the search for the next reading begins."""
        return spread(self.machine, (self.setup,), _CANDIDATES)

    @cached_property
    def unseen(self) -> Array:
        """Factor (size, r) of the covariance that no number of readings takes away."""
        seen = self.observation.rows(0, *self.candidates.of(0))
        return unseen_factor(self.prior.factor, seen.rows / np.sqrt(seen.variances)[:, None])

    def rows(self, poses: Array) -> Array:
        """Return what readings at poses would see.  poses : (m, q) m; returns (m, size)."""
        return self.observation.rows(0, poses, np.ones_like(poses)).rows

    def overall_variance(self, belief: Belief) -> float:
        """Return the paper's J (B&H eq. 26, 36), in its units: variance times length."""
        return self.joint.value(belief.factor) / UNIT**3

    def height_variance(self, belief: Belief) -> float:
        """Return the mean variance of the height over the travel, paper units."""
        return self.volume.value(belief.factor) / UNIT**2

    @property
    def variance_left(self) -> float:
        """Limit of J for endless readings, paper units."""
        return self.joint.value(self.unseen) / UNIT**3

    @property
    def length(self) -> float:
        """The travel of all joints, summed, paper units."""
        return sum(axis.length for axis in self.machine.axes) / UNIT


@dataclass(frozen=True, eq=False, slots=True)
class GreedyPlan:
    """Readings chosen one after another, each the best there is (B&H eq. 27, 37).

    stack : what is measured; poses : (m, q) m; rows : (m, size)
    beliefs : before the first reading and after each; only their covariances mean anything, for no value is known yet
    """

    stack: Stack
    poses: Array
    rows: Array
    beliefs: tuple[Belief, ...]

    @property
    def positions(self) -> Array:
        """The poses in paper units, (m, q)."""
        return self.poses / UNIT

    @property
    def overall_variances(self) -> list[float]:
        """J before the first reading and after each."""
        return [self.stack.overall_variance(belief) for belief in self.beliefs]

    @property
    def height_variances(self) -> list[float]:
        """The mean variance of the height before the first reading and after each."""
        return [self.stack.height_variance(belief) for belief in self.beliefs]

    def read(self, truth: Array, seed: int) -> Array:
        """Return the readings of one simulated machine, (m,) m.

        truth : (size,) control values, m; seed : of the noise
        """
        noise = self.stack.setup.noise * np.random.default_rng(seed).standard_normal(len(self.rows))
        values: Array = self.rows @ truth + noise
        return values

    def believed(self, values: Array) -> tuple[Belief, ...]:
        """Return the beliefs before and after each reading.  values : (m,) m"""
        beliefs = [self.stack.prior]
        for row, value in zip(self.rows, values, strict=True):
            beliefs.append(beliefs[-1].update(row, value, self.stack.setup.noise**2))
        return tuple(beliefs)

    def squared_errors(self, truth: Array, seed: int) -> Array:
        """Return the squared error of the estimate, integrated along the splines, before and after each reading."""
        errors = np.array([belief.mean - truth for belief in self.believed(self.read(truth, seed))])
        squares: Array = np.sum((errors @ self.stack.joint.matrix.T) ** 2, axis=1) / UNIT**3
        return squares

    def lattice_excess(self, points: int) -> Array:
        """Return by how much the best of an even lattice gains more than each reading chosen, relative to it: (m,).

        points : of the lattice along each joint; negative where the reading chosen is better
        """
        along = [np.linspace(*axis.travel, points) for axis in self.stack.machine.axes]
        rows = self.stack.rows(np.stack([g.ravel() for g in np.meshgrid(*along, indexing="ij")], axis=1))
        excess = [
            np.max(_gains(before, rows, self.stack)) / _gains(before, row[None], self.stack)[0] - 1
            for before, row in zip(self.beliefs, self.rows, strict=False)
        ]
        return np.array(excess)


def one_joint() -> Stack:
    """Return the paper's single spline: seven control points on 0 to 10, readings of variance 0.01."""
    return Stack(machine_from_text(_ONE_JOINT, "the paper's joint"), std=0.1)


def three_joints() -> Stack:
    """Return the paper's sample machine: three such splines, readings of variance 0.0001."""
    return Stack(load_machine("paper-three-stacked"), std=0.01)


def greedy(stack: Stack, root: Root, count: int) -> GreedyPlan:
    """Return so many readings, each chosen to make tr(VᵀV C) least (B&H eq. 27, 37)."""
    steps, beliefs = [], [stack.prior]
    for _ in range(count):
        step = best_step(Knowledge(stack.observation, beliefs[-1]), root, stack.candidates)
        steps.append(step)
        beliefs.append(beliefs[-1].update(step.row, 0.0, step.variance))
    return GreedyPlan(stack, np.array([s.pose for s in steps]), np.array([s.row for s in steps]), tuple(beliefs))


def _gains(belief: Belief, rows: Array, stack: Stack) -> Array:
    """Return ΔJ of readings under the paper's criterion."""
    along = rows @ belief.factor
    reach = along @ stack.joint.of(belief.factor).T
    gains: Array = np.sum(reach**2, axis=1) / (stack.setup.noise**2 + np.sum(along**2, axis=1))
    return gains
