"""Fourth stage: where the stations stand that distances are read to, and about which machine readings are linear."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from axiscal.estimation.absorbed import Absorbed, absorbed
from axiscal.estimation.case import Case
from axiscal.estimation.learnt import Learnt
from axiscal.estimation.nonlinearity import GAUSSIAN, SETTLED, indices, moved_by
from axiscal.inference.outliers import Doubt
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array

_ROUNDS = 12
_LINEAR = 1e-2
"""RMS over all directions, in σ, of what the exact machine would change: less is not worth a second round."""


def located(learnt: Learnt, readings: Sequence[Reading], implausible: Mapping[int, Doubt]) -> Absorbed:
    """Return what readings make known, linearised about the machine and the stations that they show until these stay.

    A distance is linear about the place that its station is taken to be at, so a better place makes a better estimate;
    and where the machine's errors are large, the exact chain differs from its rows by what they are. Where a round asks
    for more than the one before it, it and those after it go half as far: the rounds would swing.
    """
    known = absorbed(Absorbed.nothing(learnt.case, learnt.verdict), readings, implausible)
    share, last = 1.0, np.inf
    for _ in range(_ROUNDS):
        mean = known.knowledge.belief.mean
        asked = _moved(known, readings, implausible, known.case.linear_about(mean))
        share, last = (share / 2 if asked > last else share), asked
        settled = asked < (SETTLED if known.case.about is not None else _LINEAR)
        better = known.case.located(mean) if settled else known.case.linear_about(_towards(known.case, mean, share))
        if better is None:
            break
        known = absorbed(Absorbed.nothing(better, learnt.verdict), readings, implausible)
    return known


def _towards(case: Case, mean: Array, share: float) -> Array:
    """Return a mean that is a share of the way from where readings are linearised now.  mean : (size,)"""
    count = case.errors.size + len(case.observation.unknowns)
    start = np.zeros(count) if case.about is None else case.about.point
    result = mean.copy()
    result[:count] = start + share * (mean[:count] - start)
    return result


def bent(known: Absorbed, readings: Sequence[Reading], implausible: Mapping[int, Doubt]) -> Absorbed:
    """Return what is known with rows taken at the machine as it is believed, where those of the nominal one mislead."""
    about = known.case.about
    if about is None or float(np.max(indices(known, readings), initial=0.0)) <= GAUSSIAN:
        return known
    for _ in range(_ROUNDS):
        case = known.case.linear_about(known.knowledge.belief.mean, bent=True)
        done = (
            known.case.about is not None
            and known.case.about.bent
            and _moved(known, readings, implausible, case) < SETTLED
        )
        if done:
            break
        known = absorbed(Absorbed.nothing(case, known.verdict), readings, implausible)
    return known


def _moved(known: Absorbed, readings: Sequence[Reading], implausible: Mapping[int, Doubt], better: Case) -> float:
    weights = np.array(known.weights(0, len(readings), implausible))
    return moved_by(known, readings, weights, better)
