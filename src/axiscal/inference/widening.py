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
from axiscal.numerics.gaussian import lower_root, positive_root


@dataclass(frozen=True, eq=False, slots=True)
class Widening:
    """factor : (k, r) E, E Eᵀ is added to the covariance of errors and set-ups' unknowns

    rests : of errors by name, root mean squares over the scales, m or rad; size : of the mixture (ESS)
    """

    factor: Array
    rests: Mapping[str, float]
    size: float


class Posterior(NamedTuple):
    mean: Array
    covariance: Array


def widening(evidence: Evidence, mixture: Mixture, rests: Mapping[str, float]) -> Widening:
    """Return what the mixture adds.  rests : as in `Widening`"""
    mode = posterior(evidence, mixture.logs[0])
    whole = np.zeros_like(mode.covariance)
    for logs, weight in mixture.parts():
        each = posterior(evidence, logs)
        moved = each.mean - mode.mean
        whole += weight * (each.covariance + np.outer(moved, moved))
    return Widening(positive_root(whole - mode.covariance, np.diag(whole)), rests, mixture.size)


def mean_squares(mixture: Mixture, scales: Sequence[Scale], kind: Kind) -> dict[str, float]:
    """Return the root mean square of each scale of a kind over a mixture, by its owner, m or rad."""
    mine = [(index, scale) for index, scale in enumerate(scales) if scale.kind == kind]
    return {scale.owner: scale.stated * float(np.sqrt(mixture.mean_square(index))) for index, scale in mine}


def posterior(evidence: Evidence, logs: Array) -> Posterior:
    """Return what readings make of errors and set-ups' unknowns at some scales."""
    prior, rows = evidence.prior(logs), evidence.rows
    lower = lower_root(evidence.covariance(logs))
    half = solution(lower, rows @ prior)
    return Posterior(half.T @ solution(lower, evidence.values), prior - half.T @ half)
