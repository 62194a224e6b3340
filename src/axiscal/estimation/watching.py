"""The test while measuring: whether the readings so far contradict the model, however often one looks."""

from __future__ import annotations

from axiscal.estimation.believed import plausible_with_sides
from axiscal.estimation.estimation import Estimation
from axiscal.inference.contradiction import Watched, watched
from axiscal.numerics.threads import one_thread


@one_thread()
def watched_so_far(known: Estimation) -> Watched:
    """Return the e-value after the readings so far, all that can be, and what explains them best."""
    return watched(known.case.observation, plausible_with_sides(known), known.case.inherited)
