"""Case and knowledge of which the bands are printed: the posterior with all sizes averaged over."""

from __future__ import annotations

from typing import NamedTuple

from axiscal.belief import Belief
from axiscal.estimation.case import Case
from axiscal.estimation.knowledge import Knowledge
from axiscal.promise.posterior import Posterior


class Banded(NamedTuple):
    """Case and knowledge of which the bands are printed."""

    case: Case
    knowledge: Knowledge


def banded(case: Case, knowledge: Knowledge, found: Posterior | None) -> Banded:
    """Return the posterior as knowledge of errors and set-ups' unknowns.

    case : at the sizes as learnt; knowledge : with these; found : None before the first reading
    """
    if found is None:
        return Banded(case, knowledge)
    spread = found.agreement.inflation * (found.covariance + found.covariance.T) / 2
    return Banded(case, Knowledge(knowledge.observation.bare, Belief(found.mean, spread)))
