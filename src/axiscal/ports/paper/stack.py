"""The paper's machine: linear joints stacked on each other, all moving along x, whose height errors add up.

One joint is the paper's single spline (B&H section V, figures 4 and 5), three are its sample machine (figures 6 and
7). The parts are those of every calibration; only the unit is the paper's, which has none: 1 there is 1 mm here.

All of the paper's simulations, run once: what the figures, the table and the JSON document are made of.
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
from axiscal.language.stages import stage
from axiscal.machine import Machine, load_machine, machine_from_text
from axiscal.measurement.candidates import spread
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.planning.step.best_step import best_step

SCHEMA = "axiscal-reproduce/1"
SINGLE_READINGS = 10
"""As the paper has it."""
STACKED_READINGS = 24
"""As the paper has it."""
SHOWN_SINGLE = (0, 3, 7)
"""As the paper's figure 4 has it."""
SHOWN_STACKED = (0, 5, 12, 19)
"""As the paper's figure 6 has it."""
SIMULATED = 2000
"""Splines drawn at random: their mean error is known to a few percent."""
_SEED = 1
"""Any seed: the page is to be the same every time."""


@dataclass(frozen=True, eq=False, slots=True)
class Simulated:
    """One machine with a truth that the estimate never sees.

    truth : (size,) control values, m; values : (m,) of its readings, m
    beliefs : before the first reading and after each
    """

    truth: Array
    values: Array
    beliefs: tuple[Belief, ...]


@dataclass(frozen=True, eq=False)
class Experiment:
    """The single spline and the stacked machine, under the paper's criterion."""

    single: GreedyPlan
    stacked: GreedyPlan

    @cached_property
    def spline(self) -> Simulated:
        """The spline of figure 4."""
        return _simulated(self.single, _SEED)

    @cached_property
    def figure_machine(self) -> Simulated:
        """The machine of figure 7."""
        return _simulated(self.stacked, _SEED)

    @cached_property
    def spline_errors(self) -> Array:
        """Squared error of the spline of figure 4, (readings + 1,)."""
        return self.single.squared_errors(self.spline.truth, _SEED)

    @cached_property
    def squared_errors(self) -> Array:
        """Squared errors of many simulated splines, (SIMULATED, readings + 1)."""
        truths = self.single.stack.prior.sample(np.random.default_rng(0), SIMULATED)
        return np.array([self.single.squared_errors(truth, seed) for seed, truth in enumerate(truths)])


@stage("the readings of the paper's figures")
def run() -> Experiment:
    """Return the experiment with its readings chosen."""
    return Experiment(greedy(one_joint(), SINGLE_READINGS), greedy(three_joints(), STACKED_READINGS))


def document(experiment: Experiment) -> dict[str, object]:
    """Return the figures as the JSON document of `--json`; lengths and heights have the paper's unit, which is none."""
    errors, stacked = experiment.squared_errors, experiment.stacked
    return {
        "schema": SCHEMA,
        "single_spline": {
            "positions": experiment.single.positions[:, 0].tolist(),
            "J": experiment.single.overall_variances,
            "mean_squared_error": errors.mean(axis=0).tolist(),
            "mean_squared_error_std": (errors.std(axis=0, ddof=1) / np.sqrt(len(errors))).tolist(),
            "simulated_splines": len(errors),
        },
        "stacked": {
            "positions": stacked.positions.tolist(),
            "J": stacked.overall_variances,
            "height_variance": stacked.height_variances,
            "J_no_reading_takes_away": stacked.stack.variance_left,
        },
    }


def _simulated(plan: GreedyPlan, seed: int) -> Simulated:
    truth = plan.stack.prior.sample(np.random.default_rng(seed), 1)[0]
    values = plan.read(truth, seed)
    return Simulated(truth, values, plan.believed(values))


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
        seen = self.observation.rows(0, *self.candidates.in_setup(0))
        return unseen_factor(self.prior.factor, seen.rows / np.sqrt(seen.variances)[:, None])

    @property
    def variance_left(self) -> float:
        """Limit of J for endless readings, paper units."""
        return self.joint.criterion(self.unseen) / UNIT**3

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
        """The paper's J (B&H eq. 26, 36), before the first reading and after each."""
        return [self.stack.joint.criterion(belief.factor) / UNIT**3 for belief in self.beliefs]

    @property
    def height_variances(self) -> list[float]:
        """The mean variance of the height before the first reading and after each."""
        return [self.stack.volume.criterion(belief.factor) / UNIT**2 for belief in self.beliefs]

    def read(self, truth: Array, seed: int) -> Array:
        """Return the readings of one simulated machine, (m,) m.

        truth : (size,) control values, m; seed : of the noise
        """
        noise = self.stack.setup.noise * np.random.default_rng(seed).standard_normal(len(self.rows))
        return self.rows @ truth + noise

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


def one_joint() -> Stack:
    """Return the paper's single spline: seven control points on 0 to 10, readings of variance 0.01."""
    return Stack(machine_from_text(_ONE_JOINT, "the paper's joint"), std=0.1)


def three_joints() -> Stack:
    """Return the paper's sample machine: three such splines, readings of variance 0.0001."""
    return Stack(load_machine("paper-three-stacked"), std=0.01)


def greedy(stack: Stack, count: int) -> GreedyPlan:
    """Return so many readings, each chosen to make tr(VᵀV C) least (B&H eq. 27, 37)."""
    steps, beliefs = [], [stack.prior]
    for _ in range(count):
        step = best_step(Knowledge(stack.observation, beliefs[-1]), stack.joint, stack.candidates)
        steps.append(step)
        beliefs.append(beliefs[-1].update(step.row, 0.0, step.variance))
    return GreedyPlan(stack, np.array([s.pose for s in steps]), np.array([s.row for s in steps]), tuple(beliefs))
