"""Fourth stage: where the stations stand that distances are read to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from axiscal.estimation.absorbed import Absorbed, absorbed
from axiscal.estimation.learnt import Learnt
from axiscal.inference.outliers import Doubt
from axiscal.measurement.reading import Reading

_ROUNDS = 12


def located(learnt: Learnt, readings: Sequence[Reading], implausible: Mapping[int, Doubt]) -> Absorbed:
    """Return what readings make known, with stations moved to the places that they show until these stay.

    A distance is linear about the place that its station is taken to be at, so a better place makes a better estimate.
    """
    case = learnt.case
    for _ in range(_ROUNDS):
        known = absorbed(Absorbed.nothing(case, learnt.verdict), readings, implausible)
        moved = case.located(known.knowledge.belief.mean)
        if moved is None:
            return known
        case = moved
    return absorbed(Absorbed.nothing(case, learnt.verdict), readings, implausible)
