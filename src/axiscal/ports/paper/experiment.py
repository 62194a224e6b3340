"""All of the paper's simulations, run once: what the figures, the table and the JSON document are made of."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from axiscal.estimation.belief import Belief
from axiscal.language.stages import stage
from axiscal.numerics import Array
from axiscal.ports.paper.stack import GreedyPlan, greedy, one_joint, three_joints

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
_LATTICE_SINGLE, _LATTICE_STACKED = 10_001, 41
"""Points with which the exact step is compared, a side."""


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
    """The single spline, and the stacked machine under the paper's criterion and under `volume`."""

    single: GreedyPlan
    stacked: GreedyPlan
    stacked_volume: GreedyPlan

    @cached_property
    def spline(self) -> Simulated:
        """The spline of figure 4."""
        return _simulated(self.single, _SEED)

    @cached_property
    def machine(self) -> Simulated:
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

    @cached_property
    def lattice_excess(self) -> tuple[float, float]:
        """The most by which a point of a fine lattice beats a reading chosen; one joint, three joints."""
        single, stacked = (
            plan.lattice_excess(points)
            for plan, points in ((self.single, _LATTICE_SINGLE), (self.stacked, _LATTICE_STACKED))
        )
        return float(single.max()), float(stacked.max())

    @property
    def lattice_sizes(self) -> tuple[int, int]:
        """How many points these lattices have."""
        return _LATTICE_SINGLE, _LATTICE_STACKED**3


@stage("the readings of the paper's figures")
def run() -> Experiment:
    """Return the experiment with its readings chosen."""
    one, three = one_joint(), three_joints()
    return Experiment(
        greedy(one, one.joint, SINGLE_READINGS),
        greedy(three, three.joint, STACKED_READINGS),
        greedy(three, three.volume, STACKED_READINGS),
    )


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
        "stacked": {**_sequence(stacked), "J_no_reading_takes_away": stacked.stack.variance_left},
        "stacked_volume": _sequence(experiment.stacked_volume),
        "best_lattice_point_over_chosen": {
            "single_spline": experiment.lattice_excess[0],
            "stacked": experiment.lattice_excess[1],
        },
    }


def table(experiment: Experiment) -> str:
    """Return the same as a table for people."""
    single, stacked, volume = experiment.single, experiment.stacked, experiment.stacked_volume
    mean = experiment.squared_errors.mean(axis=0)
    lines = [
        "One spline, 7 control points, variance of a reading 0.01 (figures 4 and 5)",
        f"{'reading':>7} {'position':>9} {'J':>10} {'mean squared error':>19}",
        *(
            f"{k:7d} {position:>9} {value:10.5f} {error:19.5f}"
            for k, (position, value, error) in enumerate(
                zip(_texts(single), single.overall_variances, mean, strict=True)
            )
        ),
        "",
        "Three stacked joints, variance of a reading 0.0001 (figures 6 and 7)",
        f"{'':7} {'chosen under joint, the criterion of the paper':<39}   {'chosen under volume'}",
        f"{'reading':>7} {'joints at':>20} {'J':>9} {'height':>8}   {'joints at':>20} {'J':>9} {'height':>8}",
        *(
            f"{k:7d} {at:>20} {a:9.5f} {b:8.5f}   {also:>20} {c:9.5f} {d:8.5f}"
            for k, (at, a, b, also, c, d) in enumerate(zip(*_columns(stacked), *_columns(volume), strict=True))
        ),
        "",
        f"J keeps {stacked.stack.variance_left:.5f}: two combinations of the three constants show in no reading.",
        "height: its standard deviation, RMS over the travel.",
    ]
    return "\n".join(lines)


def _columns(plan: GreedyPlan) -> tuple[list[str], list[float], list[float]]:
    return _texts(plan), plan.overall_variances, [v**0.5 for v in plan.height_variances]


def _texts(plan: GreedyPlan) -> list[str]:
    return ["–", *(" ".join(f"{x:.4f}"[:6] for x in position) for position in plan.positions)]


def _sequence(plan: GreedyPlan) -> dict[str, object]:
    return {
        "positions": plan.positions.tolist(),
        "J": plan.overall_variances,
        "height_variance": plan.height_variances,
    }


def _simulated(plan: GreedyPlan, seed: int) -> Simulated:
    truth = plan.stack.prior.sample(np.random.default_rng(seed), 1)[0]
    values = plan.read(truth, seed)
    return Simulated(truth, values, plan.believed(values))
