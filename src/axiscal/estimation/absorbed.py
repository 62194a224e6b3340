"""Readings taken into what is known, one by one or many at once, which is the same."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.belief import Innovations
from axiscal.estimation.case import Case
from axiscal.estimation.knowledge import Knowledge
from axiscal.estimation.learnt import UNDISPUTED
from axiscal.estimation.updating import blocks, widened
from axiscal.inference.outliers import Doubt, Verdict
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import seen

MANY = 16
"""Fewer readings than this are taken in one by one: as fast, and a campaign in progress goes on where it was."""


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Absorbed:
    """case : with the set-ups that were read from other sides than they say; verdict : how much the readings count

    innovations : of each reading in the knowledge
    """

    case: Case
    verdict: Verdict
    knowledge: Knowledge
    innovations: tuple[Innovations, ...] = ()

    @classmethod
    def nothing(cls, case: Case, verdict: Verdict = UNDISPUTED) -> Absorbed:
        """Return what is known before the first reading."""
        return cls(case, verdict, case.knowledge)

    def weights(self, start: int, stop: int, implausible: Mapping[int, Doubt]) -> list[float]:
        """Return how much readings count: an implausible one, whose value may be of any size, not at all."""
        said = (*self.verdict.weights[start:stop], *[1.0] * (stop - max(start, len(self.verdict.weights))))
        return [0.0 if start + index in implausible else weight for index, weight in enumerate(said)]


def absorbed(before: Absorbed, readings: Sequence[Reading], implausible: Mapping[int, Doubt]) -> Absorbed:
    """Return what is known after readings.  readings : all; the first of them are in what was known before"""
    start, known = len(before.innovations), before
    weights = before.weights(start, len(readings), implausible)
    if len(weights) >= MANY:
        for case, part in blocks(before.case, before.knowledge, readings[start:], weights):
            known = Absorbed(case, before.verdict, part.after, known.innovations + part.innovations)
        return known
    for reading, weight in zip(readings[start:], weights, strict=True):
        known = _after_one(known, reading, weight)
    return known


def _after_one(before: Absorbed, reading: Reading, weight: float) -> Absorbed:
    opened = before.knowledge.opened([reading])
    numbers = seen(opened.observation, [reading])
    expected = opened.belief.predict(numbers.rows)
    surprise = Innovations(numbers.values - expected.mean, np.hypot(expected.std, np.sqrt(numbers.variances)))
    belief = opened.belief.update(numbers.rows, numbers.values, numbers.variances / weight) if weight else opened.belief
    after = Knowledge(opened.observation, belief)  # a surprise is to be seen at its full size
    return Absorbed(widened(before.case, reading), before.verdict, after, (*before.innovations, surprise))
