"""Second stage: the implausible readings, which cannot be right whatever the machine is like."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.estimation.case import Case
from axiscal.inference.implausible import Plausibility, limit, nearest_first
from axiscal.inference.outliers import NOTHING, Doubt
from axiscal.measurement.reading import Reading

_LEARNABLE = 4.0
"""How many times larger than stated an error may be where its std is to be learnt."""


@dataclass(frozen=True, eq=False, slots=True)
class Judged:
    """plausibility : what readings may be after those judged; implausible : by index from 0"""

    plausibility: Plausibility
    implausible: Mapping[int, Doubt]


def judged(case: Case, readings: Sequence[Reading]) -> Judged:
    """Return the implausible readings; those nearest to their middle are judged first."""
    order, mean = nearest_first(readings), np.zeros(case.errors.size)
    mean = mean if case.inherited is None else case.inherited.mean
    slack = _LEARNABLE if case.description.sure == "roughly" else 1.0
    plausible = Plausibility.stated(case.observation, case.errors.prior_covariance(), mean, slack)
    after = plausible.after([readings[index] for index in order])
    most = limit(after.sizes)
    far = {index: size for index, size in sorted(zip(order, after.sizes, strict=True)) if size > most}
    return Judged(after, _doubts(readings, far))


def _doubts(readings: Sequence[Reading], sizes: Mapping[int, float]) -> dict[int, Doubt]:
    return {i: Doubt(i, size, NOTHING, True) for i, size in sizes.items() if not readings[i].accepted}
