"""The most probable scales after readings: marginal likelihood times weak priors, by its exact gradient."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.inference.evidence import Evidence
from axiscal.inference.scales import Scale, Scales, log_prior_precision
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array

_FARTHEST = np.log(100.0)
_STEPS = 200


@dataclass(frozen=True, eq=False, slots=True)
class Fit:
    """The most probable scales.

    stated, found : log marginal likelihood as stated, and at the scales
    """

    scales: Scales
    stated: float
    found: float

    @property
    def gain(self) -> float:
        """By how much the readings are more probable than under what was stated: twice the log of the ratio."""
        return 2.0 * (self.found - self.stated)


def fit(observation: Observation, readings: Sequence[Reading], scales: tuple[Scale, ...]) -> Fit:
    """Return the most probable scales.

    observation : the stated model, before any cell is visited; scales : those that vary, at least one
    """
    from scipy.optimize import minimize

    evidence, precision = Evidence(observation, readings, scales), log_prior_precision(scales)

    def objective(logs: Array) -> tuple[float, Array]:
        value, slope = evidence.log_density(logs)
        pull = precision @ logs
        return 0.5 * float(logs @ pull) - value, pull - slope

    bounds = [(-_FARTHEST, _FARTHEST)] * len(scales)
    starts = _starts(scales)
    runs = [
        minimize(objective, s, jac=True, method="L-BFGS-B", bounds=bounds, options={"maxiter": _STEPS}) for s in starts
    ]
    best = min(runs, key=lambda run: float(run.fun))
    logs: Array = best.x
    return Fit(Scales(scales, tuple(np.exp(logs))), evidence.log_density(0 * logs)[0], evidence.log_density(logs)[0])


def _starts(scales: tuple[Scale, ...]) -> list[Array]:
    """Two hills are usual: a smooth curve with much rest, and a rough one with little."""
    rough = np.array([{"length": -1.0, "rest": -1.0}.get(scale.kind, 0.0) for scale in scales])
    large = np.array([{"std": 0.7, "rest": 1.5}.get(scale.kind, 0.0) for scale in scales])
    return [np.zeros(len(scales)), rough, large]
