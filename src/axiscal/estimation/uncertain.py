"""How well the tool point is known, expanded: the figure that a campaign is judged by and a report begins with."""

from __future__ import annotations

from axiscal.accuracy.expanded import Expanded, expanded
from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.knowledge import Knowledge
from axiscal.numerics.threads import one_thread


@one_thread()
def expanded_uncertainty(known: Estimation) -> Expanded:
    """Return the expanded uncertainties of what readings made known: sizes averaged over."""
    wide = known.banded
    return expanded(wide.case.yardstick, wide.knowledge.belief)


def as_standard(case: Case, knowledge: Knowledge, wanted: float) -> float:
    """Return the RMS standard uncertainty that stands for an expanded one, m, by the factor of what is known now."""
    rms = case.yardstick.measure(knowledge.belief).rms
    return wanted / expanded(case.yardstick, knowledge.belief).factor(rms)
