"""Third stage: the posterior of errors, set-ups' unknowns and sizes, and the readings that are bad."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.estimate.heavy_tails import Volume
from axiscal.estimate.posterior import Posterior, posterior
from axiscal.estimate.problem import problem
from axiscal.estimation.case import Case
from axiscal.estimation.progressed import progressed
from axiscal.inference.outliers import NOTHING, Doubt, Verdict
from axiscal.measurement.reading import Reading

UNDISPUTED = Verdict((), ())
"""Every reading counts."""


@dataclass(frozen=True, eq=False, slots=True)
class Learnt:
    """case : with the sizes as learnt, root mean squares; verdict : how much each of the readings counts

    found : the posterior; None before the first reading
    """

    case: Case
    verdict: Verdict = UNDISPUTED
    found: Posterior | None = None


def learnt(
    case: Case, readings: Sequence[Reading], implausible: Mapping[int, Doubt], before: Posterior | None = None
) -> Learnt:
    """Return the posterior of readings, those that are implausible left out.

    case : as stated; before : the posterior of nearly the same readings, whose draws are used while they are good
    """
    if not readings:
        return Learnt(case)
    case = progressed(case, readings, implausible)
    found = posterior_of(case, readings, implausible, before)
    return Learnt(case.rescaled(found.sizes), verdict_of(found, len(readings)), found)


def posterior_of(
    case: Case, readings: Sequence[Reading], implausible: Mapping[int, Doubt], before: Posterior | None = None
) -> Posterior:
    """Return the posterior of readings where a case has them linear.  case : with the sizes as stated"""
    posed = problem(case.observation, readings, case.sizes, case.inherited, case.description.usual)
    sure = [index for index, reading in enumerate(readings) if reading.accepted]
    return posterior(posed, before, implausible, sure, volume_of(case))


def volume_of(case: Case) -> Volume:
    """Return what unknowns and rests do over the volume of a case.  case : with the sizes as stated"""
    yardstick, terms = case.yardstick, case.errors.terms
    size_at = case.sizes.indices("rest", [term.name for term in terms])
    varies = size_at >= 0
    levers = np.array([yardstick.moments.levers[term.name] for term in terms])
    rests = np.array([term.rest for term in terms]) ** 2 * levers
    return Volume(yardstick.root.matrix, rests[varies], size_at[varies])


def verdict_of(found: Posterior, count: int) -> Verdict:
    """Return the bad readings as doubts, and which of so many readings count."""
    weights = np.ones(count)
    weights[list(found.bad)] = NOTHING
    doubts = tuple(Doubt(index, each.z, NOTHING) for index, each in found.bad.items())
    return Verdict(doubts, tuple(weights.tolist()))
