"""Many readings taken into case and knowledge at once, in blocks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from axiscal.estimation.case import Case
from axiscal.estimation.knowledge import AT_ONCE, Block, Knowledge, block
from axiscal.measurement.reading import Reading


def blocks(
    case: Case, knowledge: Knowledge, readings: Sequence[Reading], weights: Sequence[float]
) -> Iterator[tuple[Case, Block]]:
    """Yield what readings make of case and knowledge, some hundreds at a time.

    weights : how much each counts; 0 is predicted and not used
    """
    for after, start, stop in _parts(case, readings):
        part = block(knowledge, readings[start:stop], np.array(weights[start:stop]))
        knowledge = part.after
        yield after, part


def _parts(case: Case, readings: Sequence[Reading]) -> Iterator[tuple[Case, int, int]]:
    """Yield parts of the readings through which the case stays the same: the case, and from which to before which.

    It changes where a reading came from a side that its set-up does not allow.
    """
    start = 0
    for index, reading in enumerate(readings):
        after = widened(case, reading)
        if index > start and (after is not case or index - start == AT_ONCE):
            yield case, start, index
            start = index
        case = after
    if start < len(readings):
        yield case, start, len(readings)


def widened(case: Case, reading: Reading) -> Case:
    """Return the case after a reading: it may have come from a side that nobody said its set-up allows."""
    if reading.setup in case.both or case.came_as_allowed(reading):
        return case
    return replace(case, both=case.both | {reading.setup})
