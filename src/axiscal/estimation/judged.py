"""Second stage: the implausible readings, which cannot be right whatever the machine is like."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.estimation.case import Case
from axiscal.inference.implausible import IMPLAUSIBLE, Plausibility, limit, nearest_first
from axiscal.inference.outliers import NOTHING, Doubt
from axiscal.measurement.reading import Reading

_LEARNABLE = 4.0
"""How many times larger than stated an error may be where its std is to be learnt."""


@dataclass(frozen=True, eq=False, slots=True)
class Judged:
    """plausibility : what readings may be after those judged; implausible : by index from 0"""

    plausibility: Plausibility
    implausible: Mapping[int, Doubt]

    @classmethod
    def none(cls, case: Case) -> Judged:
        """Return the judgement of no readings."""
        mean = np.zeros(case.errors.size) if case.inherited is None else case.inherited.mean
        slack = _LEARNABLE if case.description.sure == "roughly" else 1.0
        return cls(Plausibility.stated(case.observation, case.errors.prior_covariance(), mean, slack), {})


def judged(readings: Sequence[Reading], before: Judged) -> Judged:
    """Return the implausible readings, each judged by those that came before it.

    readings : all; before : the judgement of the first of them
    """
    start = len(before.plausibility.sizes)
    after = before.plausibility.after(readings[start:])
    far = {
        index: after.sizes[index]
        for index in range(start, len(readings))
        if after.sizes[index] > IMPLAUSIBLE and after.sizes[index] > limit(after.sizes[: index + 1])
    }
    return Judged(after, {**before.implausible, **_doubts(readings, far)})


def judged_at_once(case: Case, readings: Sequence[Reading]) -> Judged:
    """Return the implausible ones where no reading is to follow; those nearest to their middle are judged first."""
    order = nearest_first(readings)
    after = Judged.none(case).plausibility.after([readings[index] for index in order])
    most = limit(after.sizes)
    far = {index: size for index, size in sorted(zip(order, after.sizes, strict=True)) if size > most}
    return Judged(after, _doubts(readings, far))


def _doubts(readings: Sequence[Reading], sizes: Mapping[int, float]) -> dict[int, Doubt]:
    return {i: Doubt(i, size, NOTHING, True) for i, size in sizes.items() if not readings[i].accepted}
