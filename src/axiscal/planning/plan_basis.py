"""Whether a plan still stands: what it rests on, and the places where no reading can be had."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.case import Case
from axiscal.estimation.judged import Doubt
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.planning.other_readings import EVERY
from axiscal.record.events import Asked, Gap

_NEAR = 0.01
"""Places within this share of each axis' travel are one place."""
_FIRST, _GROWTH = 5, 1.34
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
    passed = int((readings[-1].time or 0.0) // EVERY) if readings else 0
    if passed and any(setup.drift > 0 for setup in case.description.setups):
        said.append(f"{passed} times {EVERY / 60:.0f} min")
    other = [n for n, r in enumerate(readings, 1) if r.std is not None and not _alike(r.std, noise[r.setup])]
    return ", ".join([*said, *(f"noise of {number}" for number in other)])


def _learnt_from(count: int) -> int:
    """Return the last number of readings, by a third more each time, after which sizes make a plan anew."""
    due, following = 0, _FIRST
    while following <= count:
        due, following = following, math.ceil(following * _GROWTH)
    return due


def twice_rejected(case: Case, readings: Sequence[Reading], doubts: Sequence[Doubt]) -> tuple[Gap, ...]:
    """Return the places at which a second reading was rejected as well: asking for a third would be no use."""
    rejected = [readings[index] for index in sorted(doubt.reading for doubt in doubts)]
    places = [reading.place for reading in rejected]
    found = []
    for number, place in enumerate(places):
        gap = Gap(Asked(0, place), "two readings were rejected here")
        if any(in_gap(case, earlier, [gap]) for earlier in places[:number]):
            found.append(gap)
    return tuple(found)


def in_gap(case: Case, place: Place, gaps: Sequence[Gap]) -> bool:
    """Return whether a place is where a reading could not be taken."""
    return bool(at_gap(case, case.index(place.setup), np.array([place.pose]), gaps)[0])


def at_gap(case: Case, setup: int, poses: Array, gaps: Sequence[Gap]) -> NDArray[np.bool_]:
    """Return which poses (m, q) of a set-up are where a reading could not be taken."""
    lengths = np.array([axis.length for axis in case.description.machine.axes])
    result = np.zeros(len(poses), dtype=bool)
    for gap in gaps:
        if case.index(gap.place.setup) == setup:
            result |= gap.whole | np.all(np.abs(poses - np.array(gap.place.pose)) < _NEAR * lengths, axis=1)
    return result


def _alike(std: float, noise: float) -> bool:
    return 1 / _AS_STATED < std / noise < _AS_STATED
