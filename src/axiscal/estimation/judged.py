"""Second stage: the implausible readings, which cannot be right whatever the machine is like."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from axiscal.estimation.case import Case
from axiscal.estimation.inference.implausible import limit, nearest_first, surprises
from axiscal.estimation.inference.outliers import Doubt
from axiscal.measurement.reading import Reading

_LEARNABLE = 4.0
"""How many times larger than stated an error may be where its std is to be learnt."""


def judged(case: Case, readings: Sequence[Reading]) -> Mapping[int, Doubt]:
    """Return the implausible readings by index from 0; those nearest to their middle are judged first."""
    order, mean = nearest_first(readings), np.zeros(case.errors.size)
    mean = mean if case.inherited is None else case.inherited.mean
    slack = _LEARNABLE if case.description.sure == "roughly" else 1.0
    taken, covariance = [readings[index] for index in order], case.errors.prior_covariance()
    sizes = surprises(case.observation, mean, slack**2 * covariance, taken)
    far = np.array(sizes) > limit(sizes)
    if slack > 1 and np.any(far):  # what is printed, and which unit it tells, is by what is stated
        sizes = surprises(case.observation, mean, covariance, taken)
    found = {index: sizes[at] for at, index in enumerate(order) if far[at]}
    return {i: Doubt(i, size, True) for i, size in sorted(found.items()) if not readings[i].accepted}
