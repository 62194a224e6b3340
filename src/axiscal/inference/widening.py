"""What it adds to the bands that the scales are only known from the readings.

With the mean m̂ at the most probable scales, over the draws l of a mixture (law of total variance about m̂):

    C = Σ w_l [ C_l + (m_l − m̂)(m_l − m̂)ᵀ ],     m_l = S K⁻¹ y,  C_l = P_l − S K⁻¹ Sᵀ,  S = P_l Gᵀ

P_l the prior of errors and set-ups' unknowns at the scales, K the covariance of the readings. What C has beyond the
covariance at the most probable scales is kept as a factor, so that it can be added to a belief that has seen more
readings than the scales were learnt from; where it is less, nothing is taken away.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from axiscal.inference.evidence import Evidence
from axiscal.inference.mixture import Mixture
from axiscal.inference.scales import Kind, Scale
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import solution
from axiscal.numerics.gaussian import positive_root

_NOTHING = 1e-4
"""Share of a smoothness that moves no band."""


@dataclass(frozen=True, eq=False, slots=True)
class Widening:
    """factor : (k, r) E, E Eᵀ is added to the covariance of errors and set-ups' unknowns

    rests : of errors by name, root mean squares over the scales, m or rad; size : of the mixture (ESS)
    """

    factor: Array
    rests: Mapping[str, float]
    size: float


class AtScales(NamedTuple):
    mean: Array
    covariance: Array


class Possible(NamedTuple):
    """What readings leave possible of scales, for curves of one smoothness.

    evidence : with that; mixture : of the scales; share : how probable the smoothness is beside the others
    """

    evidence: Evidence
    mixture: Mixture
    share: float


def widening(possible: Sequence[Possible], rests: Mapping[str, float]) -> Widening:
    """Return what the mixtures add to the first one's most probable scales.  rests : as in `Widening`"""
    mode = posterior(possible[0].evidence, possible[0].mixture.logs[0])
    whole = np.zeros_like(mode.covariance)
    for evidence, mixture, share in possible:
        for logs, weight in mixture.parts() if share > _NOTHING else ():
            each = posterior(evidence, logs)
            moved = each.mean - mode.mean
            whole += share * weight * (each.covariance + np.outer(moved, moved))
    size = 1.0 / sum(share**2 / mixture.size for _, mixture, share in possible)
    return Widening(positive_root(whole - mode.covariance, np.diag(whole)), rests, size)


def rests_with_detail(possible: Sequence[Possible], scales: Sequence[Scale]) -> dict[str, float]:
    """Return the root mean square of each rest over the mixtures, by the name of its error, m or rad.

    Of a curve whose length was learnt no less than what its spline leaves between its knots at that length: readings
    that are as far apart as the knots lie on the spline whatever is between them, and teach no rest.
    """
    found, lengths = dict[str, float](), {scale.owner for scale in scales if scale.kind == "length"}
    for index, scale in enumerate(scales):
        if scale.kind != "rest":
            continue
        square = 0.0
        for evidence, mixture, share in possible:
            function = next((f for f in evidence.functions if f.name == scale.owner and f.name in lengths), None)
            draws, weights = mixture.kept()
            learnt = scale.stated * np.exp(draws[:, index])
            least = 0.0 if function is None else evidence.unfollowed(function, draws)
            for rest, weight in zip(np.maximum(learnt, least).tolist(), weights.tolist(), strict=True):
                square += share * weight * rest**2
        found[scale.owner] = float(np.sqrt(square))
    return found


def mean_squares(possible: Sequence[Possible], scales: Sequence[Scale], kind: Kind) -> dict[str, float]:
    """Return the root mean square of each scale of a kind over the mixtures, by its owner, m or rad."""
    found = dict[str, float]()
    for index, scale in enumerate(scales):
        if scale.kind == kind:
            square = sum(share * mixture.mean_square(index) for _, mixture, share in possible)
            found[scale.owner] = scale.stated * float(np.sqrt(square))
    return found


def posterior(evidence: Evidence, logs: Array) -> AtScales:
    """Return what readings make of errors and set-ups' unknowns at some scales."""
    prior, rows = evidence.prior(logs), evidence.rows
    lower = evidence.root(logs)
    half = solution(lower, rows @ prior)
    return AtScales(half.T @ solution(lower, evidence.values), prior - half.T @ half)
