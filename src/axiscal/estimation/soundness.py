"""Whether an estimation that was read from a file fits together: counts, shapes, numbers that are any.

What was written by this program does. What somebody made up, or a disk has changed, may not, and would end in a defect
at whichever product of matrices it meets first.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.belief import Belief, Innovations
from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.knowledge import Knowledge
from axiscal.inference.implausible import Plausibility
from axiscal.inference.outliers import Doubt
from axiscal.numerics import Array

_LEAST = float(np.finfo(float).tiny)
"""A standard deviation of nought divides."""


def is_sound(found: Estimation) -> bool:
    """Return whether an estimation fits together; may raise what a part of another kind raises."""
    times, judged, learnt, known = found.stages
    count = len(found.readings)
    counts = (times.given, times.readings, times.ends, found.innovations, known.innovations, judged.plausibility.sizes)
    doubts = [*found.outliers, *judged.implausible.values(), *learnt.verdict.doubts, *known.verdict.doubts]
    cases = (found.stated, found.case, found.banded.case, learnt.case, known.case)
    weights = (*learnt.verdict.weights, *known.verdict.weights)
    return (
        all(len(each) == count for each in counts)
        and all(isinstance(case, Case) for case in cases)
        and all(map(_is_known, (found.knowledge, found.banded.knowledge, known.knowledge)))
        and _are_surprises((*found.innovations, *known.innovations))
        and all(_is_doubt(doubt, count) for doubt in doubts)
        and all(0.0 <= weight <= 1.0 for weight in weights)
        and max(len(learnt.verdict.weights), len(known.verdict.weights)) <= count
        and _are_numbers([found.accuracy, times.ends, judged.plausibility.sizes])
        and _is_plausibility(judged.plausibility)
    )


def _is_known(knowledge: Knowledge) -> bool:
    return _is_belief(knowledge.belief, knowledge.observation.size)


def _is_belief(belief: Belief, size: int) -> bool:
    """Return whether a belief is one over so many numbers."""
    upper, diagonal = belief.factors
    shapes = belief.mean.shape, upper.shape, diagonal.shape
    fits = shapes == ((size,), (size, size), (size,))
    return fits and _are_numbers([belief.mean, upper, diagonal]) and _at_least([diagonal], 0.0)


def _are_surprises(every: Sequence[Innovations]) -> bool:
    """Return whether each has a standard deviation above nought for each value."""
    alike = all(each.value.ndim == 1 and each.value.shape == each.std.shape for each in every)
    stds = [each.std for each in every]
    return alike and _are_numbers([each.value for each in every]) and _are_numbers(stds) and _at_least(stds, _LEAST)


def _is_doubt(doubt: Doubt, count: int) -> bool:
    return isinstance(doubt, Doubt) and 0 <= doubt.reading < count


def _is_plausibility(plausibility: Plausibility) -> bool:
    size, unknowns = plausibility.observation.errors.size, plausibility.unknowns
    shapes = plausibility.mean.shape, plausibility.covariance.shape
    fits = unknowns is None or _is_belief(unknowns, len(plausibility.observation.unknowns))
    return fits and shapes == ((size,), (size, size)) and _are_numbers([plausibility.mean, plausibility.covariance])


def _are_numbers(parts: Sequence[object]) -> bool:
    """Return whether all numbers of all parts are finite."""
    return bool(np.all(np.isfinite(_together(parts))))


def _at_least(parts: Sequence[object], least: float) -> bool:
    return bool(np.all(_together(parts) >= least))


def _together(parts: Sequence[object]) -> Array:
    """Return all numbers in a row."""
    return np.concatenate([np.zeros(0), *(np.ravel(np.asarray(part, dtype=float)) for part in parts)])
