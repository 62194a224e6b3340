"""Fifth stage: the readings since the scales were learnt, and whether one of them shows that another one is bad."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import reduce

import numpy as np

from axiscal.estimation.absorbed import MANY, Absorbed, absorbed
from axiscal.estimation.learnt import weighed
from axiscal.estimation.updating import widened
from axiscal.inference.outliers import SURPRISING, Doubt
from axiscal.measurement.reading import Reading

_AHEAD = 64
"""So many readings are taken in before they are searched for one that surprises."""
_SURPRISING = 2.0
"""Standard deviations from which a new reading makes us weigh all again: one in twenty does by chance."""
_EACH, _GROWTH = 200, 10
"""Of more readings than these, all are weighed again each time they have grown by a tenth, and what is known is found
from these weights: it costs more, and one says less. One that may itself be doubted is looked at as it comes."""


def reviewed(before: Absorbed, readings: Sequence[Reading], implausible: Mapping[int, Doubt]) -> Absorbed:
    """Return what is known after readings; where one surprises, how much each counts is found anew.

    readings : all; the first of them are in what was known before
    Nothing before the last count at which all are weighed again is left in the answer: it is begun there.
    """
    count, due = len(readings), _due_before(len(readings) + 1)
    known = before if due <= len(before.innovations) else _found_anew(before, readings[:due], implausible)
    while (start := len(known.innovations)) < count:
        stop = start + (_AHEAD if count - start >= MANY else 1)
        known = _looked_at(absorbed(known, readings[:stop], implausible), start, readings, implausible)
    return known


def _found_anew(before: Absorbed, readings: Sequence[Reading], implausible: Mapping[int, Doubt]) -> Absorbed:
    """Return what is known after readings by what they say of each other now.  readings : all"""
    case = reduce(widened, readings[len(before.innovations) :], before.case)
    return absorbed(Absorbed.nothing(case, weighed(case, readings, implausible)), readings, implausible)


def _worth_a_look(count: int, size: float) -> bool:
    """Return whether the last of so many readings makes us weigh all again as it comes.  size : of its surprise"""
    return size >= (_SURPRISING if count <= _EACH else SURPRISING)


def _due_before(count: int) -> int:
    """Return the last number of readings before a count after which all are weighed again; 0 while they are few."""
    due, following = 0, _EACH
    while following < count:
        due, following = following, following + following // _GROWTH
    return due


def _looked_at(known: Absorbed, start: int, readings: Sequence[Reading], implausible: Mapping[int, Doubt]) -> Absorbed:
    """Return the same, or what is known up to the first reading that changes how much another one counts.

    start : how many readings have been looked at
    """
    for count, surprise in enumerate(known.innovations[start:], start + 1):
        if not _worth_a_look(count, float(np.sqrt(surprise.chi_square))):
            continue
        found = weighed(known.case, readings[:count], implausible)
        if found.fates != known.verdict.fates:
            return absorbed(Absorbed.nothing(known.case, found), readings[:count], implausible)
    return known
