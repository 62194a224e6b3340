"""What a plan rests on beside where readings were taken: whether it has to be made anew."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

from axiscal.estimation.case import Case
from axiscal.estimation.judged import Doubt
from axiscal.measurement.reading import Reading
from axiscal.planning.promise import EVERY

_FIRST, _GROWTH = 5, 1.34
"""Readings after which a plan first takes sizes that readings told, and by what share more each time after."""
_AS_STATED = 1.2
"""By this factor a reading's own std may differ from its set-up's noise before it tells more or less than planned."""


def plan_basis(case: Case, readings: Sequence[Reading], doubts: Sequence[Doubt]) -> str:
    """Return what a plan made now rests on beside where readings were taken, in words; empty for nothing.

    Where a zero drifts it rests on the clock as well: markers are due by it.
    doubts : readings that are not believed
    """
    noise = {setup.name: setup.noise for setup in case.description.setups}
    said = [f"sizes of {count} readings"] if len(case.sizes) and (count := _learnt_from(len(readings))) else []
    said += [f"{doubt.reading + 1} rejected" for doubt in doubts]
    passed = int(max((reading.time or 0.0 for reading in readings), default=0.0) // EVERY)
    if passed and any(setup.drift > 0 for setup in case.description.setups):
        said.append(f"{passed} times {EVERY / 60:.0f} min")
    stds = ((n, r.std / noise[r.setup]) for n, r in enumerate(readings, 1) if r.std is not None)
    other = [n for n, times in stds if not 1 / _AS_STATED < times < _AS_STATED]
    return ", ".join([*said, *(f"noise of {number}" for number in other)])


def rejected(basis: str) -> frozenset[int]:
    """Return the indices of the readings that are not believed.  basis : of `plan_basis`"""
    return frozenset(int(number) - 1 for number in re.findall(r"(\d+) rejected", basis))


def _learnt_from(count: int) -> int:
    """Return the last number of readings, by a third more each time, after which sizes make a plan anew."""
    due, following = 0, _FIRST
    while following <= count:
        due, following = following, math.ceil(following * _GROWTH)
    return due
