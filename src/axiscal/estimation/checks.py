"""Check readings: kept out, predicted from the others, and compared before they are used.

The checks are the readings without which the machine would be known nearly as well, found one after the other: leaving
out a number with row φ and variance σ² adds |V C φ|²/(σ² − φᵀCφ) to the criterion. What they show is the factor
√(χ²/n) between what was seen and what was promised, χ² = eᵀ S⁻¹ e of their errors e with covariance S, and its interval
from χ²_n.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.case import Case
from axiscal.inference.fit import drawn
from axiscal.inference.reading_set import ReadingSet
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import chi_square_limit, chi_square_tail, solution
from axiscal.numerics.gaussian import lower_root

_FEWEST, _SHARE, _FEW, _MANY = 10, 5, 3, 12
"""Of ten readings or more every fifth is a check, at least three and at most twelve: the others predict them."""
_MOST = 300
"""Readings that are looked at: of time, for it grows with their cube."""
_TAIL = 0.025
"""Either side of an interval of 95 %."""
_LEAST = 1e-9
"""Share of its noise that a number leaves open at the least: rounding, where nothing else tells of it."""


@dataclass(frozen=True, slots=True)
class Checks:
    """What check readings say of a promise, m.

    count : of the readings; found : the promise as they show it, between low and high with 95 %
    chance : how probable it is that right promises are missed by so much
    """

    count: int
    promised: float
    found: float
    low: float
    high: float
    chance: float


def checked(case: Case, readings: Sequence[Reading], promised: float) -> Checks | None:
    """Return what check readings say; None where there are too few readings to spare some.

    readings : those that are believed; promised : what is compared, m
    """
    if len(readings) < _FEWEST:
        return None
    numbers = ReadingSet(case.observation, drawn(readings, _MOST))
    prior = case.inherited
    root = case.prior.factor[: case.errors.size]
    values = numbers.values if prior is None else numbers.values - numbers.rows[:, : len(prior.mean)] @ prior.mean
    features, noise = numbers.features(root), numbers.noise + numbers.extra_variance
    wanted = case.yardstick.root.matrix @ root
    kept_out = _least_missed(features, noise, numbers.reading, wanted)
    square, count = _square(features @ features.T + np.diag(noise), values, kept_out), int(kept_out.sum())
    found = promised * math.sqrt(square / count)
    low, high = (promised * math.sqrt(square / chi_square_limit(count, tail)) for tail in (_TAIL, 1 - _TAIL))
    readings_out = len(np.unique(numbers.reading[kept_out]))
    return Checks(readings_out, promised, found, low, high, chi_square_tail(count, square))


def _least_missed(features: Array, noise: Array, reading: NDArray[np.intp], wanted: Array) -> NDArray[np.bool_]:
    """Return which numbers are kept out, (m,).  wanted : V F (w, r) over the errors, the first of the features"""
    many = int(np.clip((reading[-1] + 1) // _SHARE, _FEW, _MANY))
    covariance = np.linalg.inv(np.eye(features.shape[1]) + (features.T / noise) @ features)
    out = np.zeros(len(noise), dtype=bool)
    for _ in range(many):
        seen = features @ covariance
        open_ = np.maximum(noise - np.sum(seen * features, axis=1), _LEAST * noise)
        missed = np.sum((seen[:, : wanted.shape[1]] @ wanted.T) ** 2, axis=1) / open_
        of_reading = np.bincount(reading, np.where(out, np.inf, missed))
        mine = reading == int(np.argmin(of_reading))
        out |= mine
        for number in np.flatnonzero(mine):
            gain = covariance @ features[number]
            left = max(float(noise[number] - features[number] @ gain), _LEAST * float(noise[number]))
            covariance = covariance + np.outer(gain, gain) / left
    return out


def _square(covariance: Array, values: Array, out: NDArray[np.bool_]) -> float:
    """Return eᵀ S⁻¹ e of the numbers that are out, predicted from the others."""
    lower = lower_root(covariance[np.ix_(~out, ~out)])
    half = solution(lower, covariance[np.ix_(~out, out)])
    errors = values[out] - half.T @ solution(lower, values[~out])
    spread = covariance[np.ix_(out, out)] - half.T @ half
    white = solution(lower_root(spread), errors)
    return float(white @ white)
