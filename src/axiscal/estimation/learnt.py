"""Third stage: how much each reading counts, and the scales of priors and noise that are to be learnt."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np

from axiscal.estimation.case import Case
from axiscal.estimation.progressed import progressed
from axiscal.inference.fit import Fit
from axiscal.inference.outliers import FEWEST, Doubt, Verdict, verdict
from axiscal.inference.slips_or_scales import fit_without_slips
from axiscal.measurement.reading import Reading

_GROWTH = 1.34
UNDISPUTED = Verdict((), ())
"""Every reading counts."""


@dataclass(frozen=True, eq=False, slots=True)
class Learnt:
    """case : with the scales as learnt; verdict : how much each of the readings counts

    fit : the scales, None where none were learnt; count : number of readings that they were learnt from
    """

    case: Case
    verdict: Verdict = UNDISPUTED
    fit: Fit | None = None
    count: int = 0


def counts_to_learn_from(case: Case, count: int) -> list[int]:
    """Return the numbers of readings, up to a count, after which scales and turns are learnt anew: by a third more."""
    due: list[int] = []
    while (case.variable or case.bends) and (
        following := max(FEWEST, ceil((due[-1] if due else 0) * _GROWTH))
    ) <= count:
        due.append(following)
    return due


def learnt(case: Case, readings: Sequence[Reading], implausible: Mapping[int, Doubt]) -> Learnt:
    """Return what readings say of scales and of each other: first the scales, for what stands out depends on them.

    case : as stated; readings : to learn from, those that are implausible among them
    """
    case = progressed(case, readings, implausible)
    found = weighed(case, readings, implausible)
    doubtful = {*implausible, *(doubt.reading for doubt in found.doubts)}
    plausible = sum(index not in implausible for index in range(len(readings)))
    if not case.variable or plausible < FEWEST:
        return Learnt(case, found, None, len(readings))
    trusted = [reading for index, reading in enumerate(readings) if index not in doubtful]
    others = [readings[index] for index in sorted(doubtful - implausible.keys())]
    scales = fit_without_slips(case.observation, trusted, others, case.variable, case.inherited)
    rescaled = case.rescaled(scales.scales)
    return Learnt(rescaled, weighed(rescaled, readings, implausible), scales, len(readings))


def weighed(case: Case, readings: Sequence[Reading], implausible: Mapping[int, Doubt]) -> Verdict:
    """Return how much each reading counts by what the others say, implausible ones apart."""
    kept = [index for index in range(len(readings)) if index not in implausible]
    found, weights = verdict(case.observation, [readings[index] for index in kept], case.inherited)
    of_all = np.ones(len(readings))
    of_all[kept] = weights
    return Verdict(tuple(doubt._replace(reading=kept[doubt.reading]) for doubt in found), tuple(of_all.tolist()))
