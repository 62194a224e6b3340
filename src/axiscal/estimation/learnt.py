"""Third stage: the posterior of errors, set-ups' unknowns and sizes, and the readings that are bad."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.estimation.case import Case
from axiscal.estimation.progressed import progressed
from axiscal.inference.outliers import NOTHING, Doubt, Verdict
from axiscal.measurement.reading import Reading
from axiscal.promise.posterior import Posterior, posterior
from axiscal.promise.problem import problem

UNDISPUTED = Verdict((), ())
"""Every reading counts."""


@dataclass(frozen=True, eq=False, slots=True)
class Learnt:
    """case : with the sizes as learnt; verdict : how much each of the readings counts

    found : the posterior; None before the first reading
    """

    case: Case
    verdict: Verdict = UNDISPUTED
    found: Posterior | None = None


def learnt(case: Case, readings: Sequence[Reading], implausible: Mapping[int, Doubt]) -> Learnt:
    """Return the posterior of readings, those that are implausible left out.  case : as stated"""
    if not readings:
        return Learnt(case)
    case = progressed(case, readings, implausible)
    found = posterior_of(case, readings, implausible)
    return Learnt(case.rescaled(found.sizes), verdict_of(found, len(readings)), found)


def posterior_of(case: Case, readings: Sequence[Reading], implausible: Mapping[int, Doubt]) -> Posterior:
    """Return the posterior of readings where a case has them linear.  case : with the sizes as stated"""
    posed = problem(case.observation, readings, case.sizes, case.inherited, case.description.usual)
    sure = [index for index, reading in enumerate(readings) if reading.accepted]
    return posterior(posed, implausible, sure)


def verdict_of(found: Posterior, count: int) -> Verdict:
    """Return the bad readings as doubts, and which of so many readings count."""
    weights = np.ones(count)
    weights[list(found.bad)] = NOTHING
    doubts = tuple(Doubt(index, each.z, NOTHING) for index, each in found.bad.items())
    return Verdict(doubts, tuple(weights.tolist()))
