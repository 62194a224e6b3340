"""The scales after readings: the most probable ones, by the exact gradient of likelihood times weak priors, and how far
others remain possible.

Curves of several kinds f (how smooth) are averaged over by Z_f = ∫ p(y | θ, f) p(θ) dθ, which the draws of their scales
give; the model goes on with the likeliest of them, its bands count all.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from axiscal.inference.evidence import Evidence
from axiscal.inference.mixture import Mixture, mixture
from axiscal.inference.scales import Scale, Scales, log_prior_precision
from axiscal.inference.together import unfollowed
from axiscal.inference.widening import Possible, Widening, mean_squares, rests_with_detail, widening
from axiscal.machine.entry import JAGGED, ROUGH, SMOOTH
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import lowest
from axiscal.numerics.threads import one_thread

_FARTHEST = 4.6
_STEPS, _FEW_STEPS = 200, 40
"""Iterations; whatever they reach is a set of scales like any other, and is judged by the readings."""
_MOST = 300
FAMILIES = (SMOOTH, ROUGH, JAGGED)
"""Kinds of curves that are averaged over, each as probable as the others beforehand."""


@dataclass(frozen=True, eq=False, slots=True)
class Fit:
    """The most probable scales.

    stated, found : log marginal likelihood as stated, and at the scales
    widening : what it adds to the bands that other scales remain possible; possible : draws of these
    families : how probable curves of each smoothness are, by ν; empty where none is averaged over
    """

    scales: Scales
    stated: float
    found: float
    widening: Widening
    possible: Mixture
    families: Mapping[float, float] = field(default_factory=dict)

    @property
    def gain(self) -> float:
        """By how much the readings are more probable than under what was stated: twice the log of the ratio."""
        return 2.0 * (self.found - self.stated)

    @property
    def averaged(self) -> float:
        """Return log p(y), averaged over the scales by their prior, for curves as smooth as is likeliest."""
        weak = log_prior_precision(self.scales.of)
        return self.possible.whole + 0.5 * float(np.linalg.slogdet(weak / (2 * np.pi))[1])


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
    stated = Evidence(observation, drawn(readings, _MOST), scales, prior)
    names: tuple[float | None, ...] = FAMILIES if stated.averages else (None,)
    evidences = [stated.with_smoothness(name) for name in names]
    each = [_possible(evidence, scales) for evidence in evidences]
    shares = np.exp(np.array([one.whole for one in each]) - max(one.whole for one in each))
    parts = zip(names, evidences, each, (shares / shares.sum()).tolist(), strict=True)
    order = sorted(parts, key=lambda part: -part[3])
    possible = [Possible(*part[1:]) for part in order]
    evidence, likeliest, _ = possible[0]
    best = likeliest.logs[0]
    found = Scales(scales, tuple(np.exp(best)), order[0][0])
    likelihoods = stated.log_likelihood(0 * best), evidence.log_likelihood(best)
    wider = widening(possible, _rests(observation, readings, scales, possible))
    families = {name: share for name, _, _, share in order if name is not None}
    return Fit(found, *likelihoods, wider, likeliest, families)


def _possible(evidence: Evidence, scales: tuple[Scale, ...]) -> Mixture:
    """Return the scales that readings leave possible for curves of one smoothness."""
    objective = _objective(evidence, scales)
    best = min(
        (lowest(objective, start, -_FARTHEST, _FARTHEST, _STEPS) for start in _starts(scales)),
        key=lambda at: objective(at)[0],
    )
    weak = log_prior_precision(scales)
    return mixture(
        lambda logs: evidence.log_likelihood(logs) - 0.5 * float(logs @ weak @ logs),
        best,
        evidence.curvature(best) + weak,
        weak,
        len(evidence.values),
    )


def _rests(
    observation: Observation, readings: Sequence[Reading], scales: tuple[Scale, ...], possible: Sequence[Possible]
) -> Mapping[str, float]:
    """Return the rests that the bands count, by the name of their error: as learnt, and what no sum of curves holds."""
    rests = rests_with_detail(possible, scales)
    stated = {function.name: function.rest for function in observation.errors.terms}
    noises = mean_squares(possible, scales, "noise")
    for name, beyond in unfollowed(observation, readings, noises).items():
        rests[name] = float(np.hypot(rests.get(name, stated[name]), beyond))
    return rests


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


def _starts(scales: tuple[Scale, ...]) -> list[Array]:
    """Two hills are usual: a smooth curve with much rest, and a rough one with little."""
    rough = np.array([{"length": -1.0, "rest": -1.0}.get(scale.kind, 0.0) for scale in scales])
    return [np.zeros(len(scales)), rough]
