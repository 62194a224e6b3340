"""The most probable scales after readings: marginal likelihood times weak priors, by its exact gradient."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.inference.evidence import Evidence
from axiscal.inference.scales import Scale, Scales, log_prior_precision
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import lowest
from axiscal.numerics.threads import one_thread

_FARTHEST = 4.6
_STEP = 1e-3
_STEPS, _FEW_STEPS = 200, 40
_FLATTEST = 0.3
_MOST = 300


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


@one_thread()
def fit(
    observation: Observation,
    readings: Sequence[Reading],
    scales: tuple[Scale, ...],
    prior: tuple[Array, Array] | None = None,
) -> Fit:
    """Return the most probable scales.

    observation : the stated model, before any cell is visited; scales : those that vary, at least one
    prior : mean and covariance of the errors, where they are not the stated ones
    Of many readings a part tells them, drawn the same way each time: what the others would add is seconds of waiting.
    """
    evidence = Evidence(observation, drawn(readings, _MOST), scales, prior)
    objective = _objective(evidence, scales)
    best = min(
        (lowest(objective, start, -_FARTHEST, _FARTHEST, _STEPS) for start in _starts(scales)),
        key=lambda at: objective(at)[0],
    )
    variances = _variances(lambda logs: objective(logs)[1], best)
    cautious = [_cautious(*each) for each in zip(scales, best, variances, strict=True)]
    found = Scales(scales, tuple(np.exp(best)), tuple(np.exp(cautious)))
    return Fit(found, evidence.log_density(0 * best)[0], evidence.log_density(best)[0])


def drawn(readings: Sequence[Reading], most: int) -> list[Reading]:
    """Return all readings, or so many of them, drawn the same way each time."""
    if len(readings) <= most:
        return list(readings)
    chosen = np.sort(np.random.default_rng(0).choice(len(readings), most, replace=False))
    return [readings[int(i)] for i in chosen]


def roughly(evidence: Evidence, scales: tuple[Scale, ...]) -> Array:
    """Return the logarithms of the scales' factors that a few steps find, good enough to judge by, (n,)."""
    return lowest(_objective(evidence, scales), np.zeros(len(scales)), -_FARTHEST, _FARTHEST, _FEW_STEPS)


def _objective(evidence: Evidence, scales: tuple[Scale, ...]) -> Callable[[Array], tuple[float, Array]]:
    """Return minus the logarithm of likelihood times prior, and its gradient, as a function of the logarithms (n,)."""
    precision = log_prior_precision(scales)

    def objective(logs: Array) -> tuple[float, Array]:
        value, slope = evidence.log_density(logs)
        pull = precision @ logs
        return 0.5 * float(logs @ pull) - value, pull - slope

    return objective


def _cautious(scale: Scale, log: float, variance: float) -> float:
    """Return the logarithm that the bands use: of the root mean square, and a quarter of a standard deviation more.

    A length is taken shorter by one standard deviation.
    """
    spread = float(np.sqrt(variance))
    return log - spread if scale.kind == "length" else log + variance + spread / 4


def _variances(slope: Callable[[Array], Array], at: Array) -> Array:
    """Return the variances of the logarithms by the curvature at the most probable ones (Laplace), (n,)."""
    steps = _STEP * np.eye(len(at))
    curvature = np.array([(slope(at + step) - slope(at - step)) / (2 * _STEP) for step in steps])
    values, vectors = np.linalg.eigh((curvature + curvature.T) / 2)
    variances: Array = (vectors**2) @ (1.0 / np.maximum(values, _FLATTEST))
    return variances


def _starts(scales: tuple[Scale, ...]) -> list[Array]:
    """Two hills are usual: a smooth curve with much rest, and a rough one with little."""
    rough = np.array([{"length": -1.0, "rest": -1.0}.get(scale.kind, 0.0) for scale in scales])
    return [np.zeros(len(scales)), rough]
