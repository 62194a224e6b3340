"""Readings taken into what is known, many at once, which is the same as one by one."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from axiscal.estimation.belief import Innovations
from axiscal.estimation.case import Case
from axiscal.estimation.inference.intervals import is_odd, sited
from axiscal.estimation.knowledge import AT_ONCE, Block, Knowledge, block
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import Seen
from axiscal.numerics import Array


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Absorbed:
    """case : with the set-ups that were read from other sides than they say; left_out : readings that do not count

    innovations : of each reading, those left out as well
    """

    case: Case
    left_out: frozenset[int]
    knowledge: Knowledge
    innovations: tuple[Innovations, ...]

    def precisions(self, numbers: Seen) -> Array:
        """Return one over the variance of each number of the readings, 0 of those that are left out, (m,)."""
        precisions: Array = ~np.isin(numbers.reading, [*self.left_out]) / numbers.variances
        return precisions


def absorbed(case: Case, readings: Sequence[Reading], left_out: Iterable[int] = ()) -> Absorbed:
    """Return what is known after readings.  left_out : indices of those that do not count"""
    apart, knowledge, innovations = frozenset(left_out), case.knowledge, list[Innovations]()
    for after, part in blocks(case, knowledge, readings, apart):
        case, knowledge = after, part.after
        innovations += part.innovations
    return Absorbed(case, apart, knowledge, tuple(innovations))


def blocks(
    case: Case, knowledge: Knowledge, readings: Sequence[Reading], left_out: Collection[int] = ()
) -> Iterator[tuple[Case, Block]]:
    """Yield what readings make of case and knowledge, some hundreds at a time.

    left_out : indices of those that are predicted and not used
    """
    for after, start, stop in _parts(case, readings):
        counts = np.array([index not in left_out for index in range(start, stop)])
        part = block(knowledge, readings[start:stop], counts)
        knowledge = part.after
        yield after, part


def _parts(case: Case, readings: Sequence[Reading]) -> Iterator[tuple[Case, int, int]]:
    """Yield parts of the readings through which the case stays the same: the case, and from which to before which.

    It changes where a reading came from a side that its set-up does not allow.
    """
    start = 0
    for index, reading in enumerate(readings):
        after = _widened(case, reading)
        if index > start and (after is not case or index - start == AT_ONCE):
            yield case, start, index
            start = index
        case = after
    if start < len(readings):
        yield case, start, len(readings)


def _widened(case: Case, reading: Reading) -> Case:
    """Return the case after a reading: it may have come from a side that nobody said its set-up allows."""
    if reading.setup in case.both or case.came_as_allowed(reading):
        return case
    return replace(case, both=case.both | {reading.setup})


def displayed(known: Absorbed, readings: Sequence[Reading]) -> Absorbed:
    """Return what is known with such readings instead of normal ones, and the surprises as they were.

    known : after all readings, each as the value that was shown
    """
    taken = taken_as_normal(known, readings)
    if taken is readings:
        return known
    fresh = absorbed(known.case, taken, known.left_out)
    return replace(fresh, innovations=known.innovations)


def taken_as_normal(known: Absorbed, readings: Sequence[Reading]) -> Sequence[Reading]:
    """Return the readings with normal ones in the place of those that are far from normal; themselves if none is."""
    observation = known.case.observation
    if not any(is_odd(setup) for setup in observation.setups):
        return readings
    kept = [index for index in range(len(readings)) if index not in known.left_out]
    instead = dict(zip(kept, sited(observation, [readings[i] for i in kept], known.case.inherited), strict=True))
    return [instead.get(index, reading) for index, reading in enumerate(readings)]
