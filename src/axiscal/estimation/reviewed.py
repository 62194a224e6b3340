"""Fifth stage: the readings since the scales were learnt, and whether one of them shows that another one is bad."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from axiscal.estimation.absorbed import MANY, Absorbed, absorbed
from axiscal.estimation.learnt import weighed
from axiscal.inference.outliers import SURPRISING, Doubt
from axiscal.measurement.reading import Reading

_AHEAD = 64
"""So many readings are taken in before they are searched for one that surprises."""
_SURPRISING = 2.0
"""Standard deviations from which a new reading makes us weigh all again: one in twenty does by chance."""
_EACH, _GROWTH = 200, 10
"""Of more readings than these, all are weighed again when they have grown by a tenth: it costs more, and one says less.
One that may itself be doubted is looked at as it comes."""


def reviewed(before: Absorbed, readings: Sequence[Reading], implausible: Mapping[int, Doubt]) -> Absorbed:
    """Return what is known after readings; where one surprises, how much each counts is found anew.

    readings : all; the first of them are in what was known before
    """
    known, count = before, len(readings)
    while (start := len(known.innovations)) < count:
        stop = start + (_AHEAD if count - start >= MANY else 1)
        known = _looked_at(absorbed(known, readings[:stop], implausible), start, readings, implausible)
    return known


def _worth_a_look(count: int, sizes: Sequence[float]) -> bool:
    """Return whether the last of so many readings makes us weigh all again.  sizes : of surprises, the last ones"""
    if count <= _EACH or sizes[-1] >= SURPRISING:
        return sizes[-1] >= _SURPRISING
    since = count - _due_before(count)
    return _due_before(count + 1) == count and max(sizes[-since:]) >= _SURPRISING


def _due_before(count: int) -> int:
    """Return the last number of readings before a count after which all are weighed again if one surprised."""
    due, following = 0, _EACH
    while following < count:
        due, following = following, following + following // _GROWTH
    return due


def _looked_at(known: Absorbed, start: int, readings: Sequence[Reading], implausible: Mapping[int, Doubt]) -> Absorbed:
    """Return the same, or what is known up to the first reading that changes how much another one counts.

    start : how many readings have been looked at
    """
    sizes = [float(np.sqrt(each.chi_square)) for each in known.innovations[_due_before(start + 1) :]]
    for count in range(start + 1, len(known.innovations) + 1):
        if not _worth_a_look(count, sizes[: count - _due_before(start + 1)]):
            continue
        found = weighed(known.case, readings[:count], implausible)
        if found.fates != known.verdict.fates:
            return absorbed(Absorbed.nothing(known.case, found), readings[:count], implausible)
    return known
