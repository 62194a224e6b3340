"""The bands of what is known where scales were learnt: of all that remain possible, not of the likeliest alone."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from axiscal.belief import Belief
from axiscal.estimation.case import Case
from axiscal.estimation.knowledge import Knowledge
from axiscal.inference.fit import Fit
from axiscal.numerics import Array


class Banded(NamedTuple):
    """Case and knowledge of which the bands are printed."""

    case: Case
    knowledge: Knowledge


def banded(case: Case, knowledge: Knowledge, fit: Fit | None) -> Banded:
    """Return case and knowledge with the same means, and with bands that count that the scales are only learnt.

    case, knowledge : at the most probable scales; fit : None where none were learnt
    """
    if fit is None:
        return Banded(case, knowledge)
    wider = case.with_rests(fit.widening.rests)
    observation = replace(knowledge.observation, errors=wider.errors)
    return Banded(wider, Knowledge(observation, _widened(knowledge.belief, fit.widening.factor)))


def _widened(belief: Belief, factor: Array) -> Belief:
    """Return the belief with E Eᵀ added to the covariance of its first coefficients.  factor : (k, r) E"""
    covariance = belief.covariance
    covariance[: len(factor), : len(factor)] += factor @ factor.T
    return Belief(belief.mean, (covariance + covariance.T) / 2) if np.any(factor) else belief
