"""The test while measuring: whether the readings so far contradict the model, however often one looks."""

from __future__ import annotations

from axiscal.estimation.believed import plausible_with_sides
from axiscal.estimation.estimation import Estimation
from axiscal.inference.contradiction import MOST, Watched, watched
from axiscal.inference.fit import drawn
from axiscal.numerics.threads import one_thread


@one_thread()
def watched_so_far(known: Estimation) -> Watched:
    """Return the e-value after the readings so far, all that can be, and what explains them best.

    Where a verdict compared just these it has found it.
    """
    every, ruling = plausible_with_sides(known), known.ruling
    if ruling is not None and ruling.readings == tuple(drawn(every, MOST)):
        found = ruling.comparison
        return Watched(found.explanations, found.evalue, found.highest)
    return watched(known.case.observation, every, known.case.inherited)
